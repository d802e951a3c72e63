"""Patterns by which a photograph tells which pixel of a projector lights each of its own: Gray code in stripes.

White, black, then for each bit of the column and of the row, the highest first, the stripes and their opposite.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from quadgraph.acquisition.board.board import opencv
from quadgraph.base.errors import InputError

SIDES, STRIPES = (64, 4096), (1, 64)  # pixels, of a projector, and of its narrowest stripes
_LEAST_CONTRAST = 0.02  # of the brightest place's, below which a pixel tells nothing
_SURE = 0.3  # of the step from black to white, by which stripes and their opposite differ at least


def check(size: tuple[int, int], stripe: int) -> None:
    """Raise InputError for a projector or stripes that are no such."""
    if not all(SIDES[0] <= side <= SIDES[1] for side in size):
        raise InputError(
            f"--size: found {size[0]}x{size[1]}, allowed are {SIDES[0]} to {SIDES[1]} pixels; the projector's own"
        )
    if not STRIPES[0] <= stripe <= STRIPES[1]:
        raise InputError(f"--stripe: found {stripe}, allowed are {STRIPES[0]} to {STRIPES[1]} pixels")


def cells(size: tuple[int, int], stripe: int) -> tuple[int, int]:
    """Columns and rows of stripes."""
    return -(-size[0] // stripe), -(-size[1] // stripe)


def count(size: tuple[int, int], stripe: int) -> int:
    """How many patterns there are, white and black among them."""
    return 2 + 2 * sum(_bits(size, stripe))


def _bits(size: tuple[int, int], stripe: int) -> tuple[int, int]:
    across, down = cells(size, stripe)
    return max((across - 1).bit_length(), 1), max((down - 1).bit_length(), 1)


def patterns(size: tuple[int, int], stripe: int) -> Iterator[np.ndarray]:
    """(h, w) uint8, 0 or 255, of each pattern, in the order in which they are photographed."""
    cv2 = opencv()
    width, height = size
    made = cv2.structured_light.GrayCodePattern.create(*cells(size, stripe)).generate()[1]
    yield np.full((height, width), 255, np.uint8)
    yield np.zeros((height, width), np.uint8)
    for each in made:
        yield np.repeat(np.repeat(each, stripe, axis=0), stripe, axis=1)[:height, :width]


def decode(frames: Iterable[np.ndarray], size: tuple[int, int], stripe: int) -> np.ndarray:
    """(h, w, 2) the projector's pixel that lights each of the photographs', from its upper left corner: the middle of a
    stripe; nan where they do not tell.

    frames: (h, w) linear luminance of the photographs of all patterns in their order, which are taken one by one.
    """
    each = iter(frames)
    white, black = next(each), next(each)
    step = np.asarray(white - black, np.float32)
    sure = step > _LEAST_CONTRAST * float(np.quantile(step, 0.99))
    places = []
    for bits, most in zip(_bits(size, stripe), cells(size, stripe), strict=True):
        code, bit = np.zeros(step.shape, np.int64), np.zeros(step.shape, bool)
        for _ in range(bits):
            off = next(each) - next(each)
            sure &= np.abs(off) > _SURE * step
            bit = bit ^ (off > 0)
            code = 2 * code + bit
        sure &= code < most
        places.append((code + 0.5) * stripe)
    return np.where(sure[..., None], np.stack(places, axis=-1), np.nan)
