"""`quadgraph colours`: textures and colours of a mesh file as a material of the body that was baked of it.

A thick body of that material shows the mesh's colours. glTF's KHR_materials_volume, and what goes with it, is taken as
the medium that it states. docs/materials.md, From the mesh file.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from quadgraph.base.arguments import positive_float, positive_int
from quadgraph.base.errors import InputError


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    help_line = "colours of a mesh file as a material"
    parser = subparsers.add_parser("colours", help=help_line, description=__doc__)
    parser.add_argument("mesh", metavar="MESH", type=Path, help="a .glb, .gltf, .obj or .ply that has colours")
    parser.add_argument(
        "--body",
        metavar="BODY",
        type=Path,
        required=True,
        help="the .qgraph that was baked of it, or of another file of the same shape",
    )
    parser.add_argument(
        "--mean-free-path",
        metavar="MM",
        type=path_lengths,
        default=(1.0,),
        help="1 / (sigma_s_prime + sigma_a) of all that states no medium of its own, one number or R/G/B: the longer, "
        "the more translucent (default: 1)",
    )
    parser.add_argument(
        "--base",
        metavar="M",
        help="material below the colours, as in `render` but for volumes (default: the colours go on to the core)",
    )
    parser.add_argument(
        "--depth",
        metavar="MM",
        type=positive_float,
        help="where the base begins; the colour is the surface's down to half of that (default: 4 mean free paths)",
    )
    parser.add_argument(
        "--eta", type=positive_float, help="refractive index, 1 to 3 (default: the file's, else the base's, else 1.3)"
    )
    parser.add_argument(
        "--spacing",
        metavar="MM",
        type=positive_float,
        help="width of the cells (default: that of the texels, but no finer than half a triangle of the body)",
    )
    parser.add_argument(
        "--cells", metavar="N", type=positive_int, default=1_000_000, help="most cells (default: %(default)s)"
    )
    parser.add_argument("-o", "--output", metavar="FILE", type=Path, required=True, help="the .npz to write")


def run(args: argparse.Namespace) -> int:
    """Read, place, write; 0 on success."""
    from quadgraph.baking.colours.colour_options import ColourOptions
    from quadgraph.baking.colours.colour_volume import mesh_colours
    from quadgraph.base import outputs

    if args.output.suffix.lower() != ".npz":
        raise InputError(f"{args.output}: output must end in .npz")
    outputs.check_outputs([args.output], [args.mesh, args.body])
    paths = args.mean_free_path if len(args.mean_free_path) == 3 else args.mean_free_path[0]
    options = ColourOptions(paths, args.base, args.depth, args.eta, args.spacing, args.cells)
    made, report = mesh_colours(args.mesh, args.body, options)
    made.save(args.output)
    print(report.text)
    print(f"wrote {args.output}: --material {args.output} renders with it")
    return 0


def path_lengths(text: str) -> tuple[float, ...]:
    """Argument type: a number above zero, or three joined by '/'."""
    values = tuple(positive_float(part) for part in text.split("/"))
    if len(values) not in (1, 3):
        raise argparse.ArgumentTypeError(f"{text}: must be one number or three, like 1 or 1.2/1/0.8")
    return values
