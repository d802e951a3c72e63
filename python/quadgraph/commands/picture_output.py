"""Files of pictures, by their names: .png, .jpg and .exr."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from quadgraph.base import image_file
from quadgraph.base.errors import InputError

if TYPE_CHECKING:
    from quadgraph.api.colour_config import ColourConfig
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


def colour_config(args: argparse.Namespace) -> ColourConfig | None:
    """The OpenColorIO config that the arguments name, or None. Raises InputError as that does."""
    if not args.ocio:
        for name in ("ocio_display", "ocio_view"):
            if getattr(args, name):
                raise InputError(f"--{name.replace('_', '-')}: only with --ocio CONFIG")
        return None
    if "tone" in args.given:
        raise InputError("--tone: found with --ocio, whose view takes its place")
    from quadgraph.api.colour_config import ColourConfig

    return ColourConfig(args.ocio, display=args.ocio_display, view=args.ocio_view)


def by_config(shown: Shown, config: ColourConfig, how: str) -> Shown:
    """The same, but as a config shows light, with the exposure and background of `how`, which is as of `tone`."""

    def rows(picture: Picture) -> np.ndarray:
        return config.shown(picture, how)

    return replace(
        shown, srgb=rows, write_png=lambda picture, path: image_file.write(path, rows(picture), shown.metadata())
    )


def add_colour_arguments(parser: argparse.ArgumentParser) -> None:
    """Add --ocio and what belongs to it."""
    group = parser.add_argument_group("colour management")
    group.add_argument(
        "--ocio",
        metavar="CONFIG",
        help="show pictures by a view of this OpenColorIO config in place of --tone: a file, or a built-in one, e.g. "
        "ocio://default (extra `colour`)",
    )
    group.add_argument("--ocio-display", default="", metavar="NAME", help="of the config; default: its own")
    group.add_argument("--ocio-view", default="", metavar="NAME", help="of that display; default: its own")


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
