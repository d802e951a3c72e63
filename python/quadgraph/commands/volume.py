"""`quadgraph volume`: an OpenVDB file as a material's .npz, or such an .npz as an OpenVDB file, or carried into a body.

Deviations and resolution lengths, as `quadgraph acquire` leaves them, are grids named like these with `_deviation` or
`_resolution` behind. For .vdb its Python module must be there: apt install python3-openvdb.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from quadgraph.base.certainty import CERTAINTY
from quadgraph.base.errors import InputError
from quadgraph.base.units import DEFAULT_ETA, UNITS_MM

if TYPE_CHECKING:
    from quadgraph.file.openvdb import Field


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    help_line = "coefficients from OpenVDB, or onto another shape"
    parser = subparsers.add_parser("volume", help=help_line, description=__doc__)
    parser.add_argument("file", metavar="FILE", type=Path, help="a .vdb, or an .npz as --material takes it")
    for option, grid in (("--sigma-s-prime", "sigma_s_prime"), ("--sigma-a", "sigma_a")):
        parser.add_argument(
            option,
            metavar="GRID[*NUMBER]",
            type=_field,
            default=grid,
            help=f"{grid} (1/mm): a grid, times one number or R/G/B, or a number alone (default: %(default)s)",
        )
    parser.add_argument(
        "--unit", choices=tuple(UNITS_MM), default="mm", help="unit of lengths in the .vdb (default: %(default)s)"
    )
    parser.add_argument("--eta", type=_eta, help=f"refractive index (default: that in the file, or {DEFAULT_ETA})")
    group = parser.add_argument_group("from .npz to .npz: carried into another body")
    group.add_argument(
        "--map",
        metavar="KIND[,NAME=VALUE]",
        help="shell, box or volume, and what goes with it, as `render` takes it (docs/acquisition.md)",
    )
    group.add_argument("--body", metavar="BODY", type=Path, help="the baked .qgraph that it is carried into")
    parser.add_argument("-o", "--output", metavar="FILE", type=Path, required=True, help="the .npz, or .vdb, to write")


def run(args: argparse.Namespace) -> int:
    """Read, combine, write; 0 on success."""
    from quadgraph.file import openvdb

    suffixes = args.file.suffix.lower(), args.output.suffix.lower()
    if args.map is not None or args.body is not None:
        return _carry(args, suffixes)
    if suffixes == (".npz", ".vdb"):
        grids = openvdb.write(args.file, args.output)
        print(f"{args.output}: grids {', '.join(grids[:-1])} and {grids[-1]} in mm")
        return 0
    if suffixes != (".vdb", ".npz"):
        raise InputError(
            f"from '{args.file}' to '{args.output}': from .vdb to .npz, or back, is wanted; from .npz to .npz with "
            "--map and --body"
        )
    volume = openvdb.read(args.file, args.sigma_s_prime, args.sigma_a, unit_mm=UNITS_MM[args.unit], eta=args.eta)
    volume.write(args.output)
    cells, spacing = volume.sigma_s_prime.shape[2::-1], volume.spacing
    spread = [name for name in CERTAINTY if name in volume.members()]
    print(
        f"{args.output}: {' x '.join(map(str, cells))} cells of {' x '.join(f'{s:.4g}' for s in spacing)} mm, "
        f"sigma_s_prime up to {volume.sigma_s_prime.max():.4g}, sigma_a up to {volume.sigma_a.max():.4g} 1/mm, "
        f"eta {volume.eta:g}" + "".join(f", with {name}" for name in spread)
    )
    return 0


def _carry(args: argparse.Namespace, suffixes: tuple[str, str]) -> int:
    """Write what a volume is in another body; 0 on success."""
    from quadgraph.api.materials import VolumeMaterial
    from quadgraph.base import outputs

    if args.map is None or args.body is None:
        raise InputError("--map and --body: one found without the other, both are wanted")
    if suffixes != (".npz", ".npz"):
        raise InputError(f"from '{args.file}' to '{args.output}': with --map, from .npz to .npz is wanted")
    outputs.check_outputs([args.output], [args.file, args.body])
    made, report = VolumeMaterial.load(args.file).mapped(args.body, args.map)
    made.save(args.output)
    print(f"{args.output}: {made!r}")
    print(report.text)
    return 0


def _eta(text: str) -> float:
    value = float(text)
    if not 1 <= value <= 3:
        raise argparse.ArgumentTypeError(f"{text}: must be 1 to 3")
    return value


def _field(text: str) -> Field:
    """Argument type: GRID, GRID*NUMBER, GRID*R/G/B, NUMBER or R/G/B."""
    import numpy as np

    from quadgraph.file.openvdb import Field

    grid, _, factor = text.rpartition("*")
    if not grid:
        try:
            return Field(None, _numbers(text))
        except ValueError:
            return Field(text, np.ones(3))
    try:
        return Field(grid, _numbers(factor))
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"'{factor}': one number from 0 on, or three joined by '/'") from error


def _numbers(text: str):
    import numpy as np

    values = np.array([float(part) for part in text.split("/")])
    if len(values) not in (1, 3) or not np.all((values >= 0) & np.isfinite(values)):
        raise ValueError(text)
    return np.broadcast_to(values, 3)
