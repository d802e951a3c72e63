"""Files of one picture, by their names: .png, .jpg and .exr."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from quadgraph.base import image_file
from quadgraph.base.errors import InputError

if TYPE_CHECKING:
    from quadgraph.core import Engine, Picture

SUFFIXES = (*image_file.SUFFIXES, ".exr")


def check(path: Path, background: str) -> None:
    """Raise InputError unless a picture with such a background can be written to a file of that name."""
    if path.suffix.lower() not in SUFFIXES:
        raise InputError(f"{path}: output must end in {', '.join(SUFFIXES[:-1])} or {SUFFIXES[-1]}")
    if background == "transparent":
        check_opaque(path)


def check_opaque(path: Path) -> None:
    """Raise InputError for a kind of file that has no transparency."""
    if path.suffix.lower() not in (".png", ".exr"):
        raise InputError(
            f"{path}: background 'transparent' found, allowed are colours: only .png (and .exr, always) keeps what is "
            "transparent"
        )


def write(picture: Picture, path: Path, engine: Engine, args: argparse.Namespace) -> None:
    """Write a picture with the exposure and background of the arguments. Raises InputError if it cannot be written."""
    if path.suffix.lower() == ".exr":
        picture.write_exr(path, engine.metadata, args.exposure)
    elif image_file.is_jpeg(path):
        image_file.write(path, picture.srgb(args.exposure, args.background), engine.metadata)
    else:
        picture.write_png(path, engine.metadata, args.exposure, args.background)
