"""`quadgraph polygrid`: the polygrid paper's Table III and Figure 15 again, on comparable shapes (docs/polygrid.md)."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from quadgraph.base import atomic_file, outputs
from quadgraph.base.errors import InputError
from quadgraph_validation.base.study_folders import add_meshes_argument


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
    add_meshes_argument(parser)
    parser.add_argument(
        "--device", default="", metavar="NAME", help="cpu, or part of a Vulkan device's name; default: a GPU, else cpu"
    )


def run(args: argparse.Namespace) -> int:
    """Measure or read, print, draw; 0 on success."""
    from quadgraph_validation.tables import polygrid_table

    outputs.check_outputs([args.json], [])
    if args.chart:
        from quadgraph_validation.base.pyplot import load_pyplot

        load_pyplot("bench")
    rows = _read(args.record) if args.record else _measured(args)
    print(polygrid_table.document(rows), end="")
    if args.json:
        atomic_file.write_json(args.json, rows)
    if args.chart:
        polygrid_table.draw(args.chart, rows, load_pyplot)
    return 0


def _read(path: Path) -> dict:
    try:
        return json.loads(path.read_text())
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: {error}") from error


def _measured(args: argparse.Namespace) -> dict:
    from rich.console import Console

    from quadgraph.base.cache_folder import cache_folder
    from quadgraph_validation.tables import polygrid_bodies, polygrid_table

    folder = args.bodies or cache_folder() / "polygrid"
    chosen = polygrid_bodies.chosen(args.body, args.meshes)
    errors = Console(stderr=True, highlight=False)
    rows = {}
    for body in chosen:
        with errors.status(body.name):
            path = polygrid_bodies.baked(body, args.meshes, folder)
            rows[body.paper] = {"body": body.name} | polygrid_table.measure(path, args.device)
    return rows
