"""`quadgraph materials`: the materials that have a name, as numbers and as a sheet of swatches.

Coefficients are 1/mm and have one value or R/G/B; the mean free path, mm, is 1 / (sigma_s' + sigma_a).
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from quadgraph.base import image_file, outputs
from quadgraph.base.errors import InputError
from quadgraph.commands import contact_sheet, own_mesh, picture_output, reference_body, scene_options
from quadgraph.commands.progress_bar import progress_bar
from quadgraph.core import load_core

_SIDE = 160  # pixels of a swatch


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser("materials", help="materials by name, and swatches of them", description=__doc__)
    parser.declare = add_arguments


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add all arguments, those of a swatch among them."""
    parser.add_argument("names", metavar="NAME", nargs="*", help="those to show (default: all)")
    parser.add_argument("-o", "--output", type=Path, metavar="OUT", help="a sheet of swatches, .png or .jpg")
    parser.add_argument(
        "--body",
        type=Path,
        metavar="FILE",
        help="a mesh or a baked .qgraph that swatches show (default: a ball with seven ribs, of 20 mm)",
    )
    parser.add_argument("--json", action="store_true", help="print the materials as JSON on standard output")
    scene_options.add_run_arguments(parser, scene_options.RENDER_GROUPS, without=("material", "map"))
    parser.set_defaults(size=f"{_SIDE}x{_SIDE}")


def run(args: argparse.Namespace) -> int:
    """Print, and draw the sheet; 3 as `scene_options.exit_status` says."""
    names = args.names or load_core().material_names()
    listed = [facts(name) for name in names]
    status = draw(args, listed) if args.output else 0
    if args.json:
        print(json.dumps(listed, indent=1))
        return status
    shown = table(listed)
    console = Console(highlight=False)
    console.width = max(console.width, Console(width=1000).measure(shown).maximum)  # numbers are not cut off
    console.print(shown)
    for source in dict.fromkeys(str(each["source"]) for each in listed):
        console.print(source, markup=False)
    if args.output:
        console.print(f"swatches: {args.output}", markup=False, soft_wrap=True)
    return status


def facts(name: str) -> dict[str, Any]:
    """The numbers of a material by its name. Raises InputError, which says what may have been meant."""
    core = load_core()
    source = core.material_source(name)
    members = json.loads(core.material_json(name))
    found = {"name": name, "source": source, "pattern": members.get("pattern", "none"), "eta": members["eta"]}
    for prefix in ("", "second_") if found["pattern"] != "none" else ("",):
        scattering, absorption = (rgb(members[f"{prefix}{key}"]) for key in ("sigma_s_prime", "sigma_a"))
        found[f"{prefix}sigma_s_prime"], found[f"{prefix}sigma_a"] = scattering, absorption
        found[f"{prefix}mean_free_path"] = [1 / (s + a) for s, a in zip(scattering, absorption, strict=True)]
    return found


def rgb(value: float | Sequence[float]) -> list[float]:
    """Three numbers of one or three."""
    return [float(value)] * 3 if isinstance(value, int | float) else [float(each) for each in value]


def table(listed: Sequence[dict[str, Any]]) -> Table:
    """A row for each material, and one more for what a pattern mixes in."""
    result = Table("material", "sigma_s', 1/mm", "sigma_a, 1/mm", "eta", "mean free path, mm", "source", box=None)
    for each in listed:
        for prefix in ("", "second_"):
            if f"{prefix}sigma_a" not in each:
                continue
            texts = [numbers(each[prefix + key]) for key in ("sigma_s_prime", "sigma_a", "mean_free_path")]
            first = each["name"] if not prefix else f"  {each['pattern']}"
            eta, source = (f"{each['eta']:g}", str(each["source"]).partition(":")[0]) if not prefix else ("", "")
            result.add_row(first, texts[0], texts[1], eta, texts[2], source)
    return result


def numbers(values: Sequence[float]) -> str:
    """One number, or three joined by slashes, to three digits."""
    texts = [f"{value:.3g}" for value in values]
    return texts[0] if len(set(texts)) == 1 else "/".join(texts)


def draw(args: argparse.Namespace, listed: Sequence[dict[str, Any]]) -> int:
    """Write the sheet of swatches; 3 as `scene_options.exit_status` says."""
    image_file.check(args.output)
    outputs.check_outputs([args.output], [args.body, *scene_options.inputs(args)])
    check_sides(args, len(listed))
    if args.body is None and own_mesh.sizes(args):
        raise InputError("--unit, --height, --longest and --wrap: found without --body, whose size they are")
    if args.body is None and not (args.view or args.eye):
        args.view = reference_body.VIEW
    tiles, reports = [], []
    with reference_body.body() if args.body is None else nullcontext(args.body) as body:
        engine = scene_options.load_engine(body, args)
    engine.set_lights(scene_options.lights(engine, args))
    with progress_bar() as progress:
        for each in progress.track(listed, description="swatches"):
            engine.set_material(each["name"])
            picture, report = scene_options.picture(engine, args)
            words = [each["name"], f"{numbers(each['mean_free_path'])} mm"]
            tiles.append(contact_sheet.tile(picture.srgb(picture_output.tone(args)), words))
            reports.append(report)
    image_file.write(args.output, contact_sheet.grid(tiles, contact_sheet.columns_of(len(tiles))), engine.metadata)
    return scene_options.exit_status(reports, args.strict)


def check_sides(args: argparse.Namespace, count: int) -> None:
    """Raise InputError if so many pictures of a size make a sheet that is too large."""
    width, height = scene_options.size_of(args)
    if count * width * height > contact_sheet.MOST_PIXELS:
        raise InputError(
            f"--size: found {args.size} for {count} pictures, allowed are {contact_sheet.MOST_PIXELS} pixels in all"
        )
