"""`quadgraph compare`: two pictures side by side, and how they differ.

A and B are pictures of one size (two .exr or .hdr, linear; or two .png, whose sRGB is decoded), or bodies or scenes,
which are rendered with the same options. B is held against A.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from rich.console import Console

from quadgraph.base import image_file, outputs
from quadgraph.base.arguments import positive_float
from quadgraph.base.errors import InputError
from quadgraph.commands import contact_sheet, difference, picture_output, scene_file, scene_options, scene_overrides
from quadgraph.core import load_core

if TYPE_CHECKING:
    from quadgraph.core import Picture

_LINEAR, _DISPLAYED = (".exr", ".hdr"), (".png",)
_SHOWN = {"exposure", "background", "tone", "white_balance"}
_OF_PICTURES = {"output", "scale", "json", "device", "validation", "no_config"} | _SHOWN
_LEAST_WIDTH = 240  # pixels of a picture on the sheet: smaller ones are shown larger


@dataclass(frozen=True)
class Side:
    """A picture to compare: linear values (h, w, 3), the picture of radiance, if it is one, and reports of solves."""

    name: str
    linear: np.ndarray
    picture: Picture | None
    reports: list[dict]

    @property
    def radiance(self) -> bool:
        """Whether the values are radiance."""
        return self.picture is not None


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser("compare", help="two pictures, and how they differ", description=__doc__)
    parser.declare = add_arguments


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add all arguments, those of a render among them."""
    what = "a picture (.exr, .hdr, .png), a scene .json, a baked .qgraph or a mesh"
    parser.add_argument("a", metavar="A", type=Path, help=what)
    parser.add_argument("b", metavar="B", type=Path, help="as A")
    parser.add_argument("-o", "--output", type=Path, metavar="OUT", help="A, B and B - A side by side, .png or .jpg")
    parser.add_argument(
        "--scale",
        type=positive_float,
        metavar="S",
        help="luminance that the ends of the colours of B - A stand for (default: 99.5%% of what differs is within)",
    )
    parser.add_argument("--json", action="store_true", help="print the numbers as JSON on standard output")
    scene_options.add_run_arguments(parser, scene_options.RENDER_GROUPS)


def run(args: argparse.Namespace) -> int:
    """Compare, print and draw; 3 as `scene_options.exit_status` says of what was rendered."""
    if args.output:
        image_file.check(args.output)
    outputs.check_outputs([args.output], [args.a, args.b, *scene_options.inputs(args)])
    a, b = sides(args)
    if a.radiance != b.radiance:
        raise InputError(f"{args.a} and {args.b}: one is radiance, the other tone mapped; two of a kind are wanted")
    if a.linear.shape != b.linear.shape:
        sizes = [f"{side.linear.shape[1]}x{side.linear.shape[0]}" for side in (a, b)]
        raise InputError(f"{args.a} and {args.b}: {sizes[0]} and {sizes[1]} pixels, the same size is wanted")
    check_room(args, a.linear.shape)
    found = difference.measure(a.linear, b.linear)
    scale = args.scale or found.usual_scale
    if args.output:
        image_file.write(args.output, sheet(args, a, b, found, scale))
    tell(args, a, found, scale)
    return scene_options.exit_status([*a.reports, *b.reports], args.strict)


def sides(args: argparse.Namespace) -> tuple[Side, Side]:
    """Read or render both; bodies with the lights and the view of the first."""
    paths = (args.a, args.b)
    pictures = [path.suffix.lower() in (*_LINEAR, *_DISPLAYED) for path in paths]
    typed = sorted(args.given - _OF_PICTURES)
    if all(pictures) and typed:
        raise InputError(f"--{typed[0].replace('_', '-')}: found with two pictures, is for what is rendered")
    return read(args.a, args), read(args.b, args)


def read(path: Path, args: argparse.Namespace) -> Side:
    """One side. Raises InputError."""
    core = load_core()
    suffix = path.suffix.lower()
    if suffix in (*_LINEAR, *_DISPLAYED):
        return read_picture(path)
    if scene_file.is_scene(path):
        stage = core.Stage(device=args.device, validation=args.validation)
        with scene_file.opened(path) as (file, document):
            scene_overrides.apply(file, document, args)
            stage.show(file.at(0))
        report, picture = stage.solve(), stage.render()
        scene_options.check_validation(stage.engine)
        return Side(path.name, radiance(picture), picture, [report])
    engine = scene_options.shown_engine(path, args)
    if not (args.view or args.eye):
        front = engine.graph.front if args.up == "y" else 0
        args.view = f"{front:.9g},10"  # the second is seen from where the first is
    engine.set_lights(scene_options.lights(engine, args))
    picture, report = scene_options.picture(engine, args)
    return Side(path.name, radiance(picture), picture, [report])


def read_picture(path: Path) -> Side:
    """A side from a picture's file; an .exr with the alpha and the transmittance that it has. Raises InputError."""
    core = load_core()
    linear = core.read_image(path)
    suffix = path.suffix.lower()
    if suffix in _DISPLAYED:
        return Side(path.name, linear, None, [])
    alpha = behind = None
    if suffix == ".exr":
        alpha = core.read_channels(path, ["A"])
        behind = core.read_channels(path, [f"transmittance.{channel}" for channel in "RGB"])
    return Side(path.name, linear, core.Picture(linear, alpha, behind), [])


def radiance(picture) -> np.ndarray:
    """What is seen of the body, (h, w, 3), W/(mm^2 sr): the sum of the layers."""
    return np.maximum(picture.scattered, 0) + picture.specular + picture.unscattered


def check_room(args: argparse.Namespace, shape: tuple[int, ...]) -> None:
    """Raise InputError if a sheet is asked for that is too large."""
    if args.output and 3 * shape[0] * shape[1] > contact_sheet.MOST_PIXELS:
        raise InputError(
            f"{args.output}: three pictures of {shape[1]}x{shape[0]} pixels, a sheet has room for "
            f"{contact_sheet.MOST_PIXELS} in all; leave --output out for the numbers alone"
        )


def sheet(args: argparse.Namespace, a: Side, b: Side, found: difference.Difference, scale: float) -> np.ndarray:
    """A, B and their difference with words, (h, w, 3) uint8."""
    times = max(1, -(-_LEAST_WIDTH // a.linear.shape[1]))
    colours = difference.coloured(found.signed, scale)
    shown = [np.kron(each, np.ones((times, times, 1), np.uint8)) for each in (*displayed(args, a, b), colours)]
    width = shown[0].shape[1]
    unit = "W/(mm^2 sr)" if a.radiance else "linear, white is 1"
    numbers = [f"relative RMS {percent(found.whole)}", f"dimmest third {percent(found.dimmest)}"]
    apart = contact_sheet.tile(shown[2], ["B - A", f"luminance, {unit}"])
    tiles = [
        contact_sheet.tile(shown[0], [a.name, "", ""]),
        contact_sheet.tile(shown[1], [b.name, *numbers]),
        np.vstack([apart, difference.bar(width, scale)]),
    ]
    return contact_sheet.grid(tiles, 3)


def displayed(args: argparse.Namespace, a: Side, b: Side) -> list[np.ndarray]:
    """Both as they are shown, with one exposure, (h, w, 3) uint8."""
    if a.picture is None or b.picture is None:
        return [encoded(side.linear) for side in (a, b)]
    background = "black" if args.background == "transparent" else args.background
    usual = picture_output.tone(args, background=background)
    stops = str(a.picture.auto_exposure(usual) if args.exposure == "auto" else args.exposure)
    how = picture_output.tone(args, background=background, exposure=stops)
    return [picture.srgb(how) for picture in (a.picture, b.picture)]


def encoded(linear: np.ndarray) -> np.ndarray:
    """The sRGB that was decoded, uint8 (IEC 61966-2-1)."""
    curve = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)
    return np.rint(255 * np.clip(curve, 0, 1)).astype(np.uint8)


def percent(share: float) -> str:
    """A share in percent, to two digits or the whole."""
    if not np.isfinite(share):
        return "of black"
    return f"{100 * share:.0f}%" if share >= 0.1 else f"{100 * share:.2g}%"


def tell(args: argparse.Namespace, a: Side, found: difference.Difference, scale: float) -> None:
    """Print the numbers."""
    if args.json:
        height, width = a.linear.shape[:2]
        rms = {"whole": found.whole, "dimmest": found.dimmest if np.isfinite(found.dimmest) else None}
        facts = {"a": str(args.a), "b": str(args.b), "size": [width, height], "radiance": a.radiance}
        facts |= {"lit": found.lit, "relative_rms": rms, "most": found.most, "where": found.where, "scale": scale}
        print(json.dumps(facts, indent=1))
        return
    console = Console(highlight=False, soft_wrap=True)
    column, row = found.where
    console.print(
        f"relative RMS: {percent(found.whole)} whole, {percent(found.dimmest)} dimmest third of the "
        f"{percent(found.lit)} of pixels that are lit; at most {percent(found.most)} of the RMS of A, in column "
        f"{column}, row {row}",
        markup=False,
    )
    if args.output:
        console.print(f"comparison: {args.output}", markup=False)
