"""`quadgraph reference`: make the truths that methods are held against, or go on with them (docs/truth.md)."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console
from rich.table import Table

from quadgraph.commands import scene
from quadgraph.errors import InputError

if TYPE_CHECKING:
    from quadgraph.reference.scenes import Scene

KINDS = ("transport", "pde")
MODELS, SOURCES = ("sp3", "diffusion"), ("buried", "diffuse")


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser(
        "reference", help="make the truths that methods are held against", description=__doc__
    )
    parser.add_argument("scene", nargs="*", metavar="SCENE", help="bunny, fertility, spot, sphere, skin (default: all)")
    parser.add_argument(
        "--kind",
        choices=KINDS,
        required=True,
        help="transport: pictures by path tracing with Mitsuba; pde: the exitance of converged linear elements in "
        "double precision. Ctrl-C keeps what is there, and the same command goes on",
    )
    parser.add_argument(
        "--meshes",
        type=Path,
        default=scene.shared_meshes(),
        metavar="FOLDER",
        help="of the mesh files (default: %(default)s)",
    )
    parser.add_argument(
        "--truth",
        type=Path,
        metavar="FOLDER",
        help=f"where truths are kept (default: {scene.COMMITTED_TRUTH} for transport, ~/.cache/quadgraph for pde)",
    )
    _add_transport_options(parser.add_argument_group("transport"))
    _add_pde_options(parser.add_argument_group("pde"))


def _add_transport_options(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--samples",
        type=scene.positive_int,
        metavar="N",
        help="bring the pictures to N samples a pixel, those of dark sides to as many times more (required)",
    )


def _add_pde_options(group: argparse._ArgumentGroup) -> None:
    group.add_argument("--model", action="append", choices=MODELS, help="several allowed (default: both)")
    group.add_argument("--source", action="append", choices=SOURCES, help="several allowed (default: buried)")


def run(args: argparse.Namespace) -> int:
    """Make the truths; 0 on success."""
    from quadgraph.reference import scenes

    chosen = scenes.chosen(args.scene)
    table = _transport(args, chosen) if args.kind == "transport" else _pde(args, chosen)
    Console(highlight=False).print(table)
    return 0


def _transport(args: argparse.Namespace, chosen: list[Scene]) -> Table:
    from quadgraph.reference import scene_meshes, truth_run
    from quadgraph.reference.path_tracing import BATCH

    if args.samples is None:
        raise InputError("--samples: not given, a number of samples a pixel is needed")
    folder = args.truth or scene.COMMITTED_TRUTH
    subjects = [truth_run.subject(one, scene_meshes.file(one, args.meshes)) for one in chosen]
    truth_run.render(subjects, folder, args.samples, Console(stderr=True))
    table = Table("scene", "image", "samples a pixel", "lit: noise of a block", "all")
    for found in subjects:
        for name in found.scene.images:
            image = truth_run.stored(found, folder, name)
            noise = (f"{value:.2%}" for value in truth_run.noise(image))
            table.add_row(found.scene.name, name, f"{image.batches * BATCH:,}", *noise)
    return table


def _pde(args: argparse.Namespace, chosen: list[Scene]) -> Table:
    from quadgraph.reference import pde_truth, scene_meshes

    scene.load_core()
    folder, console = args.truth or scene_meshes.default_folder(), Console(stderr=True)
    parts = ("whole", "unlit")
    names = ("first step", "second step", "noise")
    table = Table("scene", "model", "source", *(f"{name}: {part}" for name in names for part in parts))
    for one in chosen:
        for source in args.source or SOURCES[:1]:
            for model in args.model or MODELS:
                found = pde_truth.make(one, model, args.meshes, folder, console, source)
                numbers = [errors.get(part) for errors in (*found.steps, found.noise) for part in parts]
                cells = ("" if number is None else f"{number:.2%}" for number in numbers)
                table.add_row(one.name, model, source, *cells)
    return table
