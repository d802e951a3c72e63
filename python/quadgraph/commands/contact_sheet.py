"""Pictures side by side with words beneath them, drawn by Pillow."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from PIL import ImageFont

GROUND = (24, 24, 27)  # sRGB, between pictures
INK, DIM = (235, 235, 235), (165, 165, 170)
GAP = 6  # pixels between pictures
MOST_PIXELS = 1 << 26  # of a sheet


def font(height: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    """Pillow's own letters, so high in pixels."""
    from PIL import ImageFont

    return ImageFont.load_default(size=height)


def letter_height(width: int) -> int:
    """Pixels of letters beneath a picture so wide."""
    return int(np.clip(width // 13, 9, 18))


def fitted(text: str, width: int, height: int) -> str:
    """A text as far as it has room in a width, with three dots where its middle is left out."""
    letters = font(height)
    shown, kept = text, len(text)
    while kept > 2 and letters.getlength(shown) > width:
        kept -= 1
        shown = f"{text[: (kept + 1) // 2]}...{text[len(text) - kept // 2 :]}"
    return shown


def line(text: str, width: int, height: int, ink: tuple[int, int, int] = INK) -> np.ndarray:
    """A line of words in the middle of a strip, (1.5 height, width, 3) uint8."""
    from PIL import Image, ImageDraw

    strip = Image.new("RGB", (width, round(1.5 * height)), GROUND)
    place = (width / 2, strip.height / 2)
    ImageDraw.Draw(strip).text(place, fitted(text, width, height), fill=ink, font=font(height), anchor="mm")
    return np.asarray(strip)


def tile(picture: np.ndarray, words: Sequence[str]) -> np.ndarray:
    """A picture, (h, w, 3) uint8, over lines of words, the first of them brighter."""
    width = picture.shape[1]
    height = letter_height(width)
    inks = (INK, *(DIM for _ in words[1:]))
    return np.vstack([picture, *(line(text, width, height, ink) for text, ink in zip(words, inks, strict=True))])


def grid(tiles: Sequence[np.ndarray], columns: int) -> np.ndarray:
    """Tiles of one size row after row, with gaps between and around."""
    height, width = tiles[0].shape[:2]
    rows = -(-len(tiles) // columns)
    sheet = np.empty((rows * (height + GAP) + GAP, columns * (width + GAP) + GAP, 3), np.uint8)
    sheet[:] = GROUND
    for number, each in enumerate(tiles):
        y, x = divmod(number, columns)
        top, left = GAP + y * (height + GAP), GAP + x * (width + GAP)
        sheet[top : top + height, left : left + width] = each
    return sheet


def columns_of(count: int) -> int:
    """How many columns show so many tiles: about as many as rows, those that leave the fewest places empty."""
    few, many = int(np.ceil(np.sqrt(0.9 * count))), int(np.ceil(np.sqrt(2.2 * count)))
    return min(range(few, many + 1), key=lambda columns: -count % columns)
