"""`quadgraph stability`: where methods fail, and whether they say so (docs/stability.md)."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from quadgraph.base import atomic_file, outputs
from quadgraph.base.arguments import add_device_arguments, positive_int
from quadgraph.base.cache_folder import cache_folder
from quadgraph.base.errors import InputError
from quadgraph.core import load_core
from quadgraph.work.schedulers import add_scheduler_argument

_TABLE_WIDTH = 120  # characters; narrower, the table cannot be read


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser("stability", help="find where methods fail, and draw it", description=__doc__)
    parser.add_argument(
        "--axis",
        action="append",
        default=[],
        metavar="A",
        help="only maps with this axis, or of this name (albedo, mean-free-path, thickness, frequency, kappa-jump, "
        "sigma-a-jump, dihedral, deformation, genus, tolerance, fp16, transport, ...); several allowed",
    )
    parser.add_argument(
        "--method",
        action="append",
        default=[],
        metavar="M",
        help="only this one (fem, 'fem diffusion', quadgraph-fv, quadgraph-fdm; 'fem vcycle', 'fem dpcg', "
        "'fem cascade', 'fem jacobi' where iterations end); several allowed",
    )
    parser.add_argument("--thin", type=_several, metavar="N", help="at most N values of every axis (default: all)")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the record here")
    parser.add_argument("--from", dest="source", type=Path, metavar="FILE", help="solve nothing: show this record")
    parser.add_argument("--images", type=Path, metavar="FOLDER", help="draw stability-MAP.png there, with matplotlib")
    parser.add_argument(
        "--truth",
        type=Path,
        default=cache_folder(),
        metavar="FOLDER",
        help="true solutions are kept there, a few MB (default: %(default)s)",
    )
    add_scheduler_argument(parser, "the panels, a map and a method each,")
    add_device_arguments(parser)


def _several(text: str) -> int:
    value = positive_int(text)
    if value < 2:
        raise argparse.ArgumentTypeError(f"{text}: both ends of an axis are kept, at least 2 is wanted")
    return value


def run(args: argparse.Namespace) -> int:
    """Solve or read, print, record, draw; 3 if a point of the default method is wrong silently, else 0."""
    from rich.console import Console

    from quadgraph_validation.stability import map_tables, stability_methods, stability_suite

    outputs.check_outputs([args.json], [])
    stability_methods.check(args.method)
    names = [each.name for each in stability_suite.maps_with(args.axis)]
    if args.images:
        from quadgraph_validation.base.pyplot import load_pyplot

        load_pyplot("bench")
    record = stability_suite.read(args.source, names, args.method) if args.source else _solved(args)
    console = Console(highlight=False)
    console.width = max(console.width, _TABLE_WIDTH)
    for table in map_tables.all_of(record):
        console.print(table)
    if args.json:
        atomic_file.write_json(args.json, record, dense=True)
    if args.images:
        from quadgraph_validation.stability import map_figures

        for path in map_figures.write(args.images, record):
            print(f"wrote {path}")
    silent = stability_suite.silent_of_default(record)
    for text in silent:
        print(f"wrong silently: {text}")
    return 3 if silent else 0


def _solved(args: argparse.Namespace) -> dict[str, Any]:
    from rich.console import Console

    from quadgraph_validation.base.machine import machine
    from quadgraph_validation.stability import stability_suite
    from quadgraph_validation.stability.stability_maps import StabilitySetting

    copied = load_core().copy_bandwidth(args.device)
    maps = stability_suite.maps_with(args.axis)
    if args.thin:
        maps = [each.thinned(args.thin) for each in maps]
    if not any(stability_suite.chosen(each.methods, args.method) for each in maps):
        raise InputError(f"--method {args.method}: no map of {args.axis} has it")
    setting = StabilitySetting(args.device, args.truth)
    if args.scheduler:
        from quadgraph_validation.stability import panel_tasks

        return machine(copied) | panel_tasks.run(maps, args.thin, args.method, setting, args.scheduler)
    with Console(stderr=True).status("stability") as status:
        return machine(copied) | stability_suite.run(maps, args.method, setting, status.update)
