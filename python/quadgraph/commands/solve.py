"""`quadgraph solve`: fluence and exitance on the surface, as numbers."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from quadgraph.base import atomic_file, outputs, pass_report
from quadgraph.base.errors import InputError
from quadgraph.commands import scene_options
from quadgraph.commands import solve_report as text


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser("solve", help="fluence and exitance as numbers", description=__doc__)
    parser.declare = add_arguments


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add all arguments, which follow from the engine's options of a scene."""
    scene_options.add_scene_arguments(parser)
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the report here")
    parser.add_argument(
        "--field",
        type=Path,
        metavar="FILE.npz",
        help="write, per surface sample of the finest level: position (n,3) mm, normal (n,3), area (n,) mm^2, and "
        "q, phi, exitance (n,3) W/mm^2",
    )


def run(args: argparse.Namespace) -> int:
    """Solve and report; 3 as `scene_options.exit_status` says."""
    if args.field and args.field.suffix != ".npz":
        raise InputError(f"{args.field}: --field must end in .npz")
    outputs.check_outputs([args.json, args.field], scene_options.inputs(args))
    engine = scene_options.make_engine(args)
    report = scene_options.solve(engine, args)
    scene_options.check_validation(engine)
    report |= {"passes": engine.passes, "device": engine.device_name, "driver": engine.driver}
    if args.field:
        with atomic_file.replacing(args.field) as stream:
            fields: dict[str, Any] = engine.surface_field()
            np.savez(stream, **fields)
    if args.json:
        atomic_file.write_json(args.json, report)
    console = Console(highlight=False)
    if not report["path"]:
        console.print(text.solve_table(report))
        console.print(text.energy_table(report))
        console.print(text.inter_reflection_text(report, args.inter_reflection))
    console.print(pass_report.pass_table(report["passes"]))
    console.print(text.error_text(report))
    for sentence in text.solver_texts(report):
        console.print(sentence)
    return scene_options.exit_status([report], args.strict)
