"""Pictures of 8-bit sRGB as files, by Pillow: whole or not at all."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from quadgraph.base.atomic_file import replacing
from quadgraph.base.errors import InputError

JPEG_SUFFIXES = (".jpg", ".jpeg")
SUFFIXES = (".png", *JPEG_SUFFIXES)
_QUALITY = 95  # of JPEG, without less resolution in colours
_MOST_COMMENT = 65_000  # bytes, of a JPEG


def is_jpeg(path: Path) -> bool:
    """Whether a file is to be a JPEG, by its name."""
    return path.suffix.lower() in JPEG_SUFFIXES


def check(path: Path) -> None:
    """Raise InputError unless the name of a file ends as one of SUFFIXES."""
    if path.suffix.lower() not in SUFFIXES:
        raise InputError(f"{path}: output must end in {', '.join(SUFFIXES[:-1])} or {SUFFIXES[-1]}")


def check_transparent(path: Path) -> None:
    """Raise InputError for the name of a kind of file that has no transparency."""
    if path.suffix.lower() not in (".png", ".exr"):
        raise InputError(
            f"{path}: background 'transparent' found, allowed are colours: only .png (and .exr, always) keeps what is "
            "transparent"
        )


def write(path: Path, srgb: npt.NDArray[np.uint8], metadata: Sequence[tuple[str, str]] = ()) -> None:
    """Write a picture, (h, w, 3), with its metadata: texts of a PNG, the comment of a JPEG.

    Raises InputError for another ending, or if it cannot be written.
    """
    from PIL import Image, PngImagePlugin

    check(path)
    picture = Image.fromarray(np.ascontiguousarray(srgb))
    encoded = io.BytesIO()  # into a file Pillow writes by itself, and does not see that there is no room
    if is_jpeg(path):
        comment = "\n".join(f"{name}: {value}" for name, value in metadata).encode()[:_MOST_COMMENT]
        picture.save(encoded, "JPEG", quality=_QUALITY, subsampling=0, comment=comment)
    else:
        texts = PngImagePlugin.PngInfo()
        for name, value in metadata:
            texts.add_text(name, value)
        picture.save(encoded, "PNG", pnginfo=texts)
    with replacing(path) as stream:
        stream.write(encoded.getbuffer())
