"""`quadgraph polygrid`: the polygrid paper's Table III and Figure 15 again, on comparable shapes (docs/polygrid.md)."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from quadgraph import atomic_file
from quadgraph.commands import scene
from quadgraph.errors import InputError


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser("polygrid", help="the polygrid paper's table and figure again", description=__doc__)
    parser.add_argument("--body", action="append", default=[], metavar="NAME", help="only this row; several allowed")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write what was measured there")
    parser.add_argument("--from", dest="record", type=Path, metavar="FILE", help="print and draw that again instead")
    parser.add_argument("--chart", type=Path, metavar="FILE", help="draw the curves there, PNG, with matplotlib")
    parser.add_argument(
        "--bodies", type=Path, metavar="FOLDER", help="of baked bodies, kept (default: ~/.cache/quadgraph/polygrid)"
    )
    scene.add_meshes_argument(parser)
    parser.add_argument("--device", default="", metavar="NAME", help="part of the Vulkan device's name")


def run(args: argparse.Namespace) -> int:
    """Measure or read, print, draw; 0 on success."""
    from quadgraph.polygrid import tables

    if args.chart:
        from quadgraph.reference.figures import load_pyplot

        load_pyplot("bench")
    rows = _read(args.record) if args.record else _measured(args)
    print(tables.document(rows), end="")
    if args.json:
        atomic_file.write_json(args.json, rows)
    if args.chart:
        tables.draw(args.chart, rows, load_pyplot)
    return 0


def _read(path: Path) -> dict:
    try:
        return json.loads(path.read_text())
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: {error}") from error


def _measured(args: argparse.Namespace) -> dict:
    from rich.console import Console

    from quadgraph.polygrid import bodies, tables
    from quadgraph.reference.scene_meshes import default_folder

    folder = args.bodies or default_folder() / "polygrid"
    chosen = bodies.chosen(args.body, args.meshes)
    errors = Console(stderr=True, highlight=False)
    rows = {}
    for body in chosen:
        with errors.status(body.name):
            path = bodies.baked(body, args.meshes, folder)
            rows[body.paper] = {"body": body.name} | tables.measure(path, args.device)
    return rows
