"""`quadgraph shapes`: the frames of a vertex animation as a .qshapes file, which deforms a baked body."""

from __future__ import annotations

import argparse
from pathlib import Path


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
        ".gltf: its morph targets",
    )
    parser.add_argument(
        "--rest", metavar="MESH", type=Path, help="the frame that lies where the body does; left out: the first"
    )
    parser.add_argument("-o", "--output", metavar="FILE", type=Path, required=True, help="the .qshapes to write")


def run(args: argparse.Namespace) -> int:
    """Read, carry to the tets, write; 0 on success."""
    from quadgraph import shapes

    found = shapes.from_frames(args.body, args.rest or args.frames[0], args.frames)
    size = found.write(args.output)
    print(f"{args.output}: {len(found.display)} shapes of {len(found.levels)} levels, {size / 1e6:.1f} MB")
    return 0
