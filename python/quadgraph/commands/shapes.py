"""`quadgraph shapes`: the frames of a vertex animation as a .qshapes file, which deforms a baked body."""

from __future__ import annotations

import argparse
from pathlib import Path

from quadgraph.base import outputs
from quadgraph.base.arguments import positive_float
from quadgraph.base.errors import InputError


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser("shapes", help="frames of a vertex animation, for a baked body", description=__doc__)
    parser.add_argument("body", metavar="BODY", type=Path, help="a baked .qgraph")
    parser.add_argument(
        "frames",
        metavar="FRAME",
        type=Path,
        nargs="+",
        help="meshes (.obj, .ply, .off) with the vertices and triangles of the rest, in its unit; or a single .glb or "
        ".gltf: the frames of its skinned animation, or its morph targets",
    )
    parser.add_argument(
        "--rest", metavar="MESH", type=Path, help="the frame that matches the baked body (default: the first)"
    )
    parser.add_argument("--animation", metavar="NAME", help="animation of a skinned glTF that has several")
    parser.add_argument(
        "--frames-per-second",
        metavar="N",
        type=positive_float,
        default=24,
        help="frame rate of a skinned glTF (default: %(default)s)",
    )
    parser.add_argument("-o", "--output", metavar="FILE", type=Path, required=True, help="the .qshapes to write")


def run(args: argparse.Namespace) -> int:
    """Read, carry to the tets, write; 0 on success."""
    from quadgraph.file import shapes_file

    outputs.check_outputs([args.output], [args.body, args.rest, *args.frames])
    if len(args.frames) == 1 and args.frames[0].suffix.lower() in (".glb", ".gltf"):
        if args.rest:
            raise InputError("--rest: a glTF file has its own")
        found = shapes_file.from_gltf(args.body, args.frames[0], args.frames_per_second, args.animation)
    else:
        found = shapes_file.from_frames(args.body, args.rest or args.frames[0], args.frames)
    size = found.write(args.output)
    print(f"{args.output}: {len(found.display)} shapes of {len(found.levels)} levels, {size / 1e6:.1f} MB")
    return 0
