"""`quadgraph accuracy`: the engine against closed forms, exact transport and random walks (docs/accuracy.md)."""

from __future__ import annotations

import argparse
import importlib
from pathlib import Path

from rich.console import Console

from quadgraph import atomic_file
from quadgraph.commands import scene
from quadgraph.commands.bench import commit

# Study to its module of quadgraph.reference.studies.
STUDIES = {
    "slab": "slab",
    "sphere": "sphere",
    "half-space": "half_space",
    "orders": "orders",
    "coarse": "coarse",
    "radiance": "radiance",
}


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser("accuracy", help="measure the error against independent truth", description=__doc__)
    parser.add_argument("study", choices=STUDIES, metavar="STUDY", help=", ".join(STUDIES))
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the record here")
    parser.add_argument(
        "--reference", action="store_true", help="solve with the CPU reference in double precision instead of the GPU"
    )
    parser.add_argument("--device", default="", metavar="NAME", help="part of the Vulkan device's name")


def run(args: argparse.Namespace) -> int:
    """Run one study; 0 on success."""
    from quadgraph.reference import bodies

    scene.load_core()
    study = importlib.import_module(f"quadgraph.reference.studies.{STUDIES[args.study]}")
    body_of = bodies.on_reference if args.reference else bodies.on_engine(args.device)
    with Console(stderr=True).status(f"study: {args.study}"):
        record = study.run(body_of)
    console = Console(highlight=False)
    for table in study.tables(record):
        console.print(table)
    if args.json:
        atomic_file.write_json(args.json, {"study": args.study, "commit": commit()} | record)
    return 0
