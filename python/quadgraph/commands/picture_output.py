"""Files of pictures, by their names: .png, .jpg and .exr."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from quadgraph.base import image_file
from quadgraph.base.errors import InputError

if TYPE_CHECKING:
    from quadgraph.core import Engine, Picture

SUFFIXES = (*image_file.SUFFIXES, ".exr")


@dataclass(frozen=True)
class Shown:
    """What becomes of a picture, shown in one way: rows of sRGB, files, and what made it."""

    srgb: Callable[[Picture], np.ndarray]
    write_png: Callable[[Picture, Path], None]
    write_exr: Callable[[Picture, Path], None]
    metadata: Callable[[], Sequence[tuple[str, str]]]


def tone(args: argparse.Namespace, **instead: str) -> str:
    """What the arguments say of how radiance is shown, as JSON; with other values in place of some."""
    names = ("exposure", "background", "tone", "white_balance")
    return json.dumps({"picture": {name: getattr(args, name) for name in names} | instead})


def shown(engine: Engine, how: str) -> Shown:
    """What becomes of an engine's pictures that are shown so, as `tone` says it."""
    return Shown(
        lambda picture: picture.srgb(how),
        lambda picture, path: picture.write_png(path, engine.metadata, how),
        lambda picture, path: picture.write_exr(path, engine.metadata, how),
        lambda: engine.metadata,
    )


def add_arguments(parser: argparse.ArgumentParser, files: str, report: str) -> None:
    """Add --output, which takes such files, several if asked, and --json for such a report."""
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        action="append",
        required=True,
        metavar="OUT",
        help=f"{files}; several allowed",
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help=f"write {report} here")


def check(path: Path, background: str) -> None:
    """Raise InputError unless a picture with such a background can be written to a file of that name."""
    if path.suffix.lower() not in SUFFIXES:
        raise InputError(f"{path}: output must end in {', '.join(SUFFIXES[:-1])} or {SUFFIXES[-1]}")
    if background == "transparent":
        image_file.check_transparent(path)


def write(picture: Picture, path: Path, how: Shown) -> None:
    """Write a picture by the name of the file. Raises InputError if it cannot be written."""
    if image_file.is_jpeg(path):
        image_file.write(path, how.srgb(picture), how.metadata())
    elif path.suffix.lower() == ".png":
        how.write_png(picture, path)
    else:
        how.write_exr(picture, path)
