"""`quadgraph bake` of several meshes, or of those of a scene, into one file (docs/bodies.md)."""

from __future__ import annotations

import argparse
import contextlib
from typing import TYPE_CHECKING

from rich.console import Console

from quadgraph.base.errors import InputError
from quadgraph.commands import bake_many, own_mesh, scene_file
from quadgraph.work.schedulers import check_several

if TYPE_CHECKING:
    from quadgraph.baking.bodies import BodyMesh
    from quadgraph.baking.pipeline import BakeOptions
    from quadgraph.baking.report import BakeReport

_OF_ONE = ("surface_only", "error", "material", "light")


def is_asked(args: argparse.Namespace) -> bool:
    """Whether the arguments are of several bodies in one file."""
    return args.join or args.parts or (len(args.mesh) == 1 and scene_file.is_scene(args.mesh[0]))


def run(args: argparse.Namespace, options: BakeOptions) -> BakeReport:
    """Bake them, telling the progress on standard error. Raises InputError, ToolError."""
    from quadgraph.baking.bodies import bake_bodies

    check_several(args, False, "several files are wanted, without --join")
    if args.output is None:
        raise InputError("--output: found none with several bodies; -o NAME.qgraph says where they go")
    for name in _OF_ONE:
        if getattr(args, name):
            raise InputError(f"--{name.replace('_', '-')}: found with several bodies, which it cannot be said of")
    placed = _of_meshes(args, options) if args.join or args.parts else _of_scene(args)
    errors = Console(stderr=True, highlight=False)
    named = contextlib.nullcontext() if args.join or args.parts else scene_file.naming(args.mesh[0])
    with named, errors.status(f"baking {len(placed)} bodies"):
        return bake_bodies(placed, args.output, options, lambda text: errors.print(text, markup=False, soft_wrap=True))


def _of_meshes(args: argparse.Namespace, options: BakeOptions) -> list[BodyMesh]:
    from quadgraph.baking.bodies import meshes_as_they_lie, parts_as_bodies

    if args.parts:
        if args.join or len(args.mesh) > 1:
            raise InputError("--parts: found with several files, one whose parts are bodies is wanted; or --join")
        return parts_as_bodies(args.mesh[0], options)
    return meshes_as_they_lie(bake_many.files_in(args.mesh), options)


def _of_scene(args: argparse.Namespace) -> list[BodyMesh]:
    said = [name for name in (*own_mesh.NAMES, "up", "normals") if name in args.given]
    if said:
        raise InputError(f"--{said[0]}: found with a scene, whose bodies say it themselves (docs/bodies.md)")
    return scene_file.meshes_of(args.mesh[0])
