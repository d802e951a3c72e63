"""`quadgraph view`: a baked object or a scene in a window."""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
from pathlib import Path

from quadgraph.base.arguments import length_mm
from quadgraph.base.errors import InputError
from quadgraph.base.units import UNITS_MM
from quadgraph.commands.scene_options import baked_or_bare

PROGRAM = "quadgraph-engine"


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser(
        "view",
        help="a baked object or a scene in a window",
        description=__doc__,
        epilog=f"F1 in the window lists the keyboard shortcuts. Options after FILE are those of {PROGRAM} --help: "
        "--material, --light, --view, --method and so on, as in `quadgraph render`.",
    )
    parser.add_argument("file", metavar="FILE", type=Path, help="a baked .qgraph, a scene .json, or a mesh")
    parser.add_argument("--unit", choices=tuple(UNITS_MM), help="unit of a mesh; stands before FILE")
    parser.add_argument(
        "--height", type=length_mm, metavar="L", help="height of a mesh along y (default: 100mm); stands before FILE"
    )
    parser.add_argument("options", nargs=argparse.REMAINDER, metavar="OPTION", help=f"options of {PROGRAM}")


def find_program() -> str:
    """Return the path of the engine's program: beside the interpreter, in the build, on the PATH. Raises InputError."""
    build = Path(__file__).resolve().parents[3] / "build" / "engine" / "app"
    folders = [Path(sys.executable).parent, build, *os.get_exec_path()]
    found = shutil.which(PROGRAM, path=os.pathsep.join(map(str, folders)))
    if found is None:
        raise InputError(f"the program {PROGRAM} is not there; tools/setup builds it")
    return found


def run(args: argparse.Namespace) -> int:
    """Open the window; the program's exit status once it is closed."""
    from quadgraph.baking import bare

    if not bare.is_mesh(args.file):
        return subprocess.run([find_program(), args.file, *args.options], check=False).returncode
    method = [] if "--method" in args.options else ["--method", "shortest-path"]
    with baked_or_bare(args.file, args.unit, args.height) as path:
        return subprocess.run([find_program(), path, *method, *args.options], check=False).returncode
