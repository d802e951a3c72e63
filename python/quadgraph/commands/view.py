"""`quadgraph view`: a baked object or a scene in a window."""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from itertools import pairwise
from pathlib import Path

from quadgraph.base.errors import InputError
from quadgraph.commands import own_mesh, scene_file
from quadgraph.mesh import mesh_names

PROGRAM = "quadgraph-engine"


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser(
        "view",
        help="a baked object or a scene in a window",
        description=__doc__,
        epilog="A mesh is shown at once, as a preview of its surface, while it is baked; the window then changes over "
        "to the body, which is kept for the next time (quadgraph cache). F1 in the window lists the keyboard "
        f"shortcuts. Options after FILE are those of {PROGRAM} --help: --material, --light, --view, --method and so "
        "on, as in `quadgraph render`.",
    )
    parser.add_argument("file", metavar="FILE", type=Path, help="a baked .qgraph, a scene .json, or a mesh")
    own_mesh.add_size_arguments(parser)
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
    """Open the window; the program's exit status once it is closed, 1 where a mesh could not be baked."""
    program = find_program()
    _take_sizes(args)
    if _bakes(args.file, args.options):
        from quadgraph.baking import kept
        from quadgraph.baking.pipeline import BakeOptions
        from quadgraph.commands import preview

        if kept.find(args.file, BakeOptions(**own_mesh.sizes(args))) is None:
            return preview.show(program, args.file, args, args.options)
    if scene_file.is_scene(args.file):
        return _show_scene(program, args)
    with own_mesh.body(args.file, args, surface_only=_by_shortest_path(args.options)) as path:
        # A scene that is saved must not name a file of the cache, or a temporary one.
        keeping = [] if path == args.file or "--headless" in args.options else ["--copy-body"]
        return subprocess.run([program, path, *keeping, *args.options], check=False).returncode


def _show_scene(program: str, args: argparse.Namespace) -> int:
    """Open the window on a scene, whose bodies are baked first where they are meshes."""
    if own_mesh.sizes(args):
        raise InputError(f"{args.file}: --unit, --height, --longest and --wrap are for meshes; a scene says its own")
    document = scene_file.content(args.file)
    if not (isinstance(document, dict) and "bodies" in document):
        return subprocess.run([program, args.file, *args.options], check=False).returncode
    with scene_file.opened(args.file) as (file, _), tempfile.TemporaryDirectory(prefix="quadgraph-") as folder:
        baked = Path(folder) / args.file.name
        file.save(baked)
        keeping = [] if "--headless" in args.options else ["--copy-body"]
        return subprocess.run([program, baked, *keeping, *args.options], check=False).returncode


def _take_sizes(args: argparse.Namespace) -> None:
    """Take what is said of a mesh after FILE from the options of the program."""
    parser = argparse.ArgumentParser(prog="quadgraph view", add_help=False, allow_abbrev=False)
    own_mesh.add_size_arguments(parser)
    args.options = parser.parse_known_args(args.options, args)[1]


def _bakes(file: Path, options: list[str]) -> bool:
    """Whether a window is asked for, of a mesh and by a method that solves in a baked body."""
    return mesh_names.is_mesh(file) and not _by_shortest_path(options) and "--headless" not in options


def _by_shortest_path(options: list[str]) -> bool:
    """Whether the program is asked for the method that takes a mesh as it is."""
    given = [text.removeprefix("--method=") for text in options if text.startswith("--method=")]
    given += [value for name, value in pairwise(options) if name == "--method"]
    return given[-1:] == ["shortest-path"]
