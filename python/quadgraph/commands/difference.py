"""How two pictures differ, as numbers and in colours."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph.base.relative_error import relative_rms
from quadgraph.commands import contact_sheet

_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # ITU-R BT.709
_DARKER, _SAME, _BRIGHTER = np.array([[80, 160, 255], [18, 18, 20], [255, 110, 50]], float)  # sRGB
_SHARE = 0.995  # of lit pixels that the scale of colours holds


@dataclass(frozen=True)
class Difference:
    """B against A, of the pixels that are lit in either; linear values, all channels together.

    whole, dimmest: relative RMS, over all of them and over the third that is dimmest in A; most: the largest
    difference in a channel over the RMS of A, at `where` (column, row); lit: share of pixels; signed: (h, w) luminance
    of B - A.
    """

    whole: float
    dimmest: float
    most: float
    where: tuple[int, int]
    lit: float
    signed: np.ndarray

    @property
    def usual_scale(self) -> float:
        """The luminance that the ends of the colours stand for, unless one is asked for: most pixels are within."""
        size = np.abs(self.signed[self.signed != 0])
        return float(np.quantile(size, _SHARE)) if size.size else 1.0


def measure(a: np.ndarray, b: np.ndarray) -> Difference:
    """Compare linear pictures (h, w, 3). Raises InputError where A is black."""
    of_a, of_b = (picture.reshape(-1, 3).astype(np.float64) for picture in (a, b))
    lit = (of_a > 0).any(axis=1) | (of_b > 0).any(axis=1)
    if not of_a.any():
        raise InputError("the first picture is black all over: nothing is relative to that")
    apart = of_b - of_a
    bright = of_a @ _LUMINANCE
    dim = lit & (bright <= np.quantile(bright[lit], 1 / 3))
    worst = int(np.abs(apart).max(axis=1).argmax())
    scale = np.sqrt((of_a[lit] ** 2).mean())
    row, column = divmod(worst, a.shape[1])
    return Difference(
        relative_rms(lit.astype(float), apart, of_a),
        relative_rms(dim.astype(float), apart, of_a) if of_a[dim].any() else float("inf"),
        float(np.abs(apart[worst]).max() / scale),
        (column, row),
        float(lit.mean()),
        (apart @ _LUMINANCE).reshape(a.shape[:2]),
    )


def coloured(signed: np.ndarray, scale: float) -> np.ndarray:
    """Colours (..., 3) uint8 of signed values: blue below 0, orange above, the brighter the nearer to `scale`."""
    with np.errstate(over="ignore"):
        share = np.clip(signed / scale, -1, 1)[..., None]
    end = np.where(share < 0, _DARKER, _BRIGHTER)
    return np.rint(_SAME + np.sqrt(np.abs(share)) * (end - _SAME)).astype(np.uint8)


def bar(width: int, scale: float) -> np.ndarray:
    """The colours from -scale to scale with these numbers, (h, width, 3) uint8: a strip as high as a line of words."""
    from PIL import Image, ImageDraw

    height = contact_sheet.letter_height(width)
    strip = Image.fromarray(contact_sheet.line("", width, height))
    letters = contact_sheet.font(height)
    number = f"{scale:.2g}".replace("e-0", "e-")
    room = max(round(0.3 * width), round(letters.getlength(f"+{number}")) + 10)
    strip_of_colours = coloured(np.linspace(-scale, scale, width - 2 * room), scale)
    colours = np.broadcast_to(strip_of_colours, (height, *strip_of_colours.shape))
    strip.paste(Image.fromarray(np.ascontiguousarray(colours)), (room, (strip.height - height) // 2))
    draw = ImageDraw.Draw(strip)
    for text, x, anchor in ((f"-{number}", room - 5, "rm"), (f"+{number}", width - room + 5, "lm")):
        draw.text((x, strip.height / 2), text, fill=contact_sheet.DIM, font=letters, anchor=anchor)
    return np.asarray(strip)
