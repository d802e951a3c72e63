"""`quadgraph sheet`: bodies and materials in a table of pictures.

A row for each body, a column for each material; a single body has its materials in several rows.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from rich.console import Console

from quadgraph.base import atomic_file, image_file, outputs
from quadgraph.base.errors import InputError
from quadgraph.commands import contact_sheet, material_list, picture_output, scene_file, scene_options
from quadgraph.commands.progress_bar import progress_bar
from quadgraph.core import load_core

_SIDE = 192  # pixels of a picture


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser("sheet", help="bodies in several materials, on one sheet", description=__doc__)
    parser.declare = add_arguments


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add all arguments, those of a render among them."""
    parser.add_argument("bodies", metavar="BODY", type=Path, nargs="+", help="meshes, or baked .qgraph files")
    parser.add_argument(
        "--materials",
        action="append",
        metavar="A,B,...",
        help="materials as in `render`, joined by commas: a part with '=' belongs to the name before it; several "
        "allowed, each beginning with a new material (default: marble)",
    )
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="OUT", help="the sheet, .png or .jpg")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write a report of each picture here")
    scene_options.add_run_arguments(parser, scene_options.RENDER_GROUPS, without=("material", "material-of", "map"))
    parser.set_defaults(size=f"{_SIDE}x{_SIDE}")


def run(args: argparse.Namespace) -> int:
    """Render all and write the sheet; 3 as `scene_options.exit_status` says."""
    materials = split(args.materials or [scene_options.default_of("material")])
    image_file.check(args.output)
    outputs.check_outputs([args.output, args.json], [*args.bodies, *materials, *scene_options.inputs(args)])
    material_list.check_sides(args, len(args.bodies) * len(materials))
    for body in args.bodies:
        if scene_file.is_scene(body):
            raise InputError(f"{body}: a scene names its own material; meshes and baked .qgraph files are wanted")
    for text in materials:
        if load_core().volume_name(text) is None:
            load_core().material_json(text)
    tiles, reports = render(args, materials)
    columns = contact_sheet.columns_of(len(tiles)) if len(args.bodies) == 1 else len(materials)
    image_file.write(args.output, contact_sheet.grid(tiles, columns), [("materials", "; ".join(materials))])
    if args.json:
        atomic_file.write_json(args.json, reports)
    console = Console(highlight=False, soft_wrap=True)
    console.print(f"sheet: {args.output}, {len(args.bodies)} x {len(materials)} pictures", markup=False)
    for report in reports:
        if report["stopped"]:
            console.print(f"failed: {report['body']} of {report['material']}: {report['stopped']}", markup=False)
    return scene_options.exit_status(reports, args.strict)


def split(texts: list[str]) -> list[str]:
    """Materials of texts in which they are joined by commas. Raises InputError for one that is empty."""
    found: list[str] = []
    for text in texts:
        first = True
        for part in text.split(","):
            if not part:
                raise InputError(f"--materials {text}: an empty name found, materials joined by commas are wanted")
            if "=" in part and not first:
                found[-1] += f",{part}"
            else:
                found.append(part)
            first = False
    return found


def render(args: argparse.Namespace, materials: list[str]) -> tuple[list[np.ndarray], list[dict]]:
    """A tile with its words, and a report, for each body and material, row after row."""
    tiles, reports = [], []
    with progress_bar() as progress:
        task = progress.add_task("pictures", total=len(args.bodies) * len(materials))
        for body in args.bodies:
            engine = scene_options.load_engine(body, args)
            engine.set_lights(scene_options.lights(engine, args))
            for material in materials:
                engine.set_material(material)
                picture, report = scene_options.picture(engine, args)
                words = [body.stem, material]
                tiles.append(contact_sheet.tile(picture.srgb(picture_output.tone(args)), words))
                reports.append(report | {"body": str(body), "material": material})
                progress.advance(task)
    return tiles, reports
