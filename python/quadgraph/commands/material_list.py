"""`quadgraph materials`: the materials that have a name, as numbers and as a sheet of swatches.

Coefficients are 1/mm and have one value or R/G/B; the mean free path, mm, is 1 / (sigma_s' + sigma_a).
"""

from __future__ import annotations

import argparse
import itertools
import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.table import Table

from quadgraph.base import image_file, outputs
from quadgraph.base.arguments import length_mm
from quadgraph.base.errors import InputError
from quadgraph.commands import contact_sheet, own_mesh, picture_output, reference_body, scene_options
from quadgraph.commands.progress_bar import progress_bar
from quadgraph.core import load_core
from quadgraph.mesh import mesh_names

if TYPE_CHECKING:
    import numpy as np

    from quadgraph.core import Engine

_SIDE = 160  # pixels of a swatch


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser("materials", help="materials by name, and swatches of them", description=__doc__)
    parser.declare = add_arguments


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add all arguments, those of a swatch among them."""
    parser.add_argument(
        "names",
        metavar="NAME",
        nargs="*",
        help="those to show, or texts as --material takes them, such as reflectance=.2/.6/.4,mean_free_path=1.5 "
        "(default: all that have a name)",
    )
    parser.add_argument("-o", "--output", type=Path, metavar="OUT", help="a sheet of swatches, .png or .jpg")
    parser.add_argument(
        "--body",
        type=Path,
        action="append",
        metavar="FILE",
        help="a mesh or a baked .qgraph that swatches show; given again: another one, on which all are shown too "
        "(default: a ball with seven ribs, of 20 mm)",
    )
    parser.add_argument(
        "--sizes",
        type=lengths_mm,
        metavar="L,L,...",
        help="a swatch of each material for each of these sizes, longest sides like 30mm,80mm,300mm: the body, or the "
        "mesh of --body, is baked in all of them",
    )
    parser.add_argument("--json", action="store_true", help="print the materials as JSON on standard output")
    scene_options.add_run_arguments(parser, scene_options.RENDER_GROUPS, without=("material", "material-of", "map"))
    parser.set_defaults(size=f"{_SIDE}x{_SIDE}")


def lengths_mm(text: str) -> list[float]:
    """Argument type: lengths joined by commas, mm."""
    return [length_mm(part) for part in text.split(",")]


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
    """The numbers of a material by its name or its text. Raises InputError, which says what may have been meant."""
    core = load_core()
    members = json.loads(core.material_json(name))
    source = core.material_source(name) if name in core.material_names() else "own: as it was written"
    found = {"name": name, "source": source, "pattern": members["pattern"], "eta": members["eta"]}
    found["roughness"] = members.get("roughness")
    for prefix in ("", "second_") if found["pattern"] != "none" else ("",):
        scattering, absorption = (rgb(members[f"{prefix}{key}"]) for key in ("sigma_s_prime", "sigma_a"))
        found[f"{prefix}sigma_s_prime"], found[f"{prefix}sigma_a"] = scattering, absorption
        sums = [s + a for s, a in zip(scattering, absorption, strict=True)]
        found[f"{prefix}mean_free_path"] = [1 / each if each > 0 else None for each in sums]
    return found


def rgb(value: float | Sequence[float]) -> list[float]:
    """Three numbers of one or three."""
    return [float(value)] * 3 if isinstance(value, int | float) else [float(each) for each in value]


def table(listed: Sequence[dict[str, Any]]) -> Table:
    """A row for each material, and one more for what a pattern mixes in."""
    heads = ("material", "sigma_s', 1/mm", "sigma_a, 1/mm", "eta", "roughness", "mean free path, mm", "source")
    result = Table(*heads, box=None)
    for each in listed:
        for prefix in ("", "second_"):
            if f"{prefix}sigma_a" not in each:
                continue
            texts = [numbers(each[prefix + key]) for key in ("sigma_s_prime", "sigma_a", "mean_free_path")]
            first = each["name"] if not prefix else f"  {each['pattern']}"
            whole = (f"{each['eta']:g}", surface_text(each), str(each["source"]).partition(":")[0])
            eta, roughness, source = whole if not prefix else ("", "", "")
            result.add_row(first, texts[0], texts[1], eta, roughness, texts[2], source)
    return result


def surface_text(facts: dict[str, Any]) -> str:
    """The roughness that a material brings along, or nothing."""
    return "" if facts["roughness"] is None else f"{facts['roughness']:g}"


def numbers(values: Sequence[float | None]) -> str:
    """One number, or three joined by slashes, to three digits; without end where there is none."""
    texts = ["inf" if value is None else f"{value:.3g}" for value in values]
    return texts[0] if len(set(texts)) == 1 else "/".join(texts)


def draw(args: argparse.Namespace, listed: Sequence[dict[str, Any]]) -> int:
    """Write the sheet of swatches; 3 as `scene_options.exit_status` says."""
    bodies, sizes = args.body or [None], args.sizes or [None]
    image_file.check(args.output)
    outputs.check_outputs([args.output], [*bodies, *scene_options.inputs(args)])
    check_sides(args, len(listed) * len(bodies) * len(sizes))
    check_bodies(args)
    if args.body is None and not (args.view or args.eye):
        args.view = reference_body.VIEW
    args.light = args.light or ["lamps"]  # swatches are to be compared with those of any time
    columns, reports, metadata = [], [], []
    with progress_bar() as progress:
        task = progress.add_task("swatches", total=len(listed) * len(bodies) * len(sizes))
        for body, size in itertools.product(bodies, sizes):
            engine = load_body(args, body, size)
            engine.set_lights(scene_options.lights(engine, args))
            column = []
            for each in listed:
                engine.set_material(each["name"])
                picture, report = scene_options.picture(engine, args)
                words = [each["name"], beneath(each, body if len(bodies) > 1 else None, size)]
                column.append(contact_sheet.tile(picture.srgb(picture_output.tone(args)), words))
                reports.append(report)
                progress.advance(task)
            columns.append(column)
            metadata = engine.metadata
    image_file.write(args.output, contact_sheet.grid(*in_rows(columns)), metadata)
    return scene_options.exit_status(reports, args.strict)


def beneath(facts: dict[str, Any], body: Path | None, size: float | None) -> str:
    """What a swatch says beside its material: the body and the size of several, else the mean free path."""
    words = [body.stem] if body else []
    words += [f"{size:g} mm"] if size is not None else []
    return ", ".join(words) or f"{numbers(facts['mean_free_path'])} mm"


def in_rows(columns: Sequence[Sequence[np.ndarray]]) -> tuple[list[np.ndarray], int]:
    """The tiles of a sheet, all bodies of a material side by side, and how many stand in a row."""
    tiles = [tile for of_material in zip(*columns, strict=True) for tile in of_material]
    materials = max(1, round(contact_sheet.columns_of(len(tiles)) / len(columns)))
    return tiles, materials * len(columns)


def check_bodies(args: argparse.Namespace) -> None:
    """Raise InputError for sizes that the bodies of swatches cannot have."""
    if args.body is None and own_mesh.sizes(args):
        raise InputError("--unit, --height, --longest and --wrap: found without --body, whose size they are")
    if not args.sizes:
        return
    if args.unit or args.height or args.longest:
        raise InputError("--sizes: found beside --unit, --height or --longest, which are sizes too")
    for body in args.body or ():
        if not mesh_names.is_mesh(body):
            raise InputError(f"--sizes: found with {body}; a baked file knows its size, a mesh is wanted")


def load_body(args: argparse.Namespace, body: Path | None, size: float | None) -> Engine:
    """Load a body of swatches, so many mm long, or as the arguments say where that is None. Raises InputError."""
    if body is not None:
        sized = argparse.Namespace(**{**vars(args), "longest": size or args.longest})
        return scene_options.load_engine(body, sized)
    with reference_body.body(size or reference_body.LONGEST_MM) as ribs:
        return scene_options.load_engine(ribs, args)


def check_sides(args: argparse.Namespace, count: int) -> None:
    """Raise InputError if so many pictures of a size make a sheet that is too large."""
    width, height = scene_options.size_of(args)
    if count * width * height > contact_sheet.MOST_PIXELS:
        raise InputError(
            f"--size: found {args.size} for {count} pictures, allowed are {contact_sheet.MOST_PIXELS} pixels in all"
        )
