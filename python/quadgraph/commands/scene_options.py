"""What `render`, `solve` and `bench` share: options that describe a scene, and the engine set up from them."""

from __future__ import annotations

import argparse
import contextlib
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from quadgraph.bake.budget import record
from quadgraph.base.arguments import add_device_arguments, length_mm, positive_int, share
from quadgraph.base.errors import InputError
from quadgraph.base.units import UNITS_MM
from quadgraph.core import load_core

if TYPE_CHECKING:
    from quadgraph.core import Engine


METHODS = ("fem", "quadgraph-fv", "quadgraph-fdm", "polygrid", "polygrid-divergence", "shortest-path")
DEFAULT_MATERIAL = "marble"
VARIED_MATERIAL = "marble-veins"


# What each is: docs/engine.md, "Solvers".
SOLVERS = ("fmg-pcg", "vcycle", "dpcg", "cascade", "jacobi", "auto")


def add_scene_arguments(parser: argparse.ArgumentParser, file_help: str = "a baked .qgraph") -> None:
    """Add FILE, material, lights, method, solver and device options."""
    parser.add_argument("file", metavar="FILE", type=Path, help=file_help)
    add_device_arguments(parser)
    parser.add_argument(
        "--material",
        default=DEFAULT_MATERIAL,
        metavar="M",
        help="a name (marble, skin1, wholemilk, ..., marble-veins, jade, agate, wax, wood, checker, layered-skin), or "
        "sigma_s_prime=S,sigma_a=A,eta=E in 1/mm, or reflectance=C,mean_free_path=L,eta=E: the colour that a thick "
        "body shows, below 1, and a length in mm; one value or R/G/B each; and pattern=P,period=D,sharpness=K with a "
        "second set, second_sigma_a and so on; or a file .npz of sigma_s_prime and sigma_a on a grid (z, y, x) with "
        "its spacing in mm (default: %(default)s)",
    )
    parser.add_argument(
        "--light",
        action="append",
        metavar="L",
        help="directional:DX,DY,DZ:IRRADIANCE (the way the light travels; W/mm^2), point:X,Y,Z:POWER (mm; W), "
        "ambient:IRRADIANCE, spot:X,Y,Z:DX,DY,DZ:ANGLE[,EDGE]:POWER (degrees from axis to edge of the light, the "
        "share over which it fades), rectangle:X,Y,Z:UX,UY,UZ:VX,VY,VZ:POWER (centre and edges), "
        "projector:X,Y,Z:DX,DY,DZ:ANGLE[,UX,UY,UZ]:FILE:POWER (an image, degrees high), "
        "environment:FILE:TURN[,UP]:RADIANCE (a picture of all that is around); the last one number or "
        "R/G/B; docs/lights.md tells more; several allowed (default: warm from behind the view, cool from the side, a "
        "little from all around)",
    )
    parser.add_argument(
        "--method",
        choices=METHODS,
        default="fem",
        help="polygrid needs a file baked with --mesher polygrid (default: %(default)s)",
    )
    parser.add_argument(
        "--solver",
        choices=SOLVERS,
        default="fmg-pcg",
        help="fmg-pcg: full multigrid, then conjugate gradients with V-cycles; vcycle: without conjugate gradients; "
        "dpcg: conjugate gradients with the diagonal; cascade: relaxation from coarse to fine, as published; jacobi: "
        "on the finest level alone; auto: fmg-pcg or dpcg, whichever is quicker here (default: %(default)s)",
    )
    parser.add_argument(
        "--source",
        choices=("buried", "diffuse"),
        default="buried",
        help="buried: light scatters along refracted rays inside; diffuse: it enters at the surface, as published "
        "(default: %(default)s)",
    )
    parser.add_argument(
        "--model",
        choices=("diffusion", "sp3", "auto"),
        default="auto",
        help="auto: diffusion where it is within 1%% of sp3, and for the published baseline (default: %(default)s)",
    )
    parser.add_argument(
        "--tolerance",
        type=share,
        default=1e-3,
        metavar="T",
        help="stop when the exitance is estimated to be solved to this relative RMS error, over the whole surface and "
        "over its unlit part (default: %(default)s)",
    )
    parser.add_argument(
        "--error",
        type=share,
        default=0.0,
        metavar="E",
        help="stop when that error and the mesh's together are estimated to be below E, e.g. 1%%, on a level of the "
        "file as coarse as that allows; exit 3 if no level does (default: no target, the finest level)",
    )
    parser.add_argument(
        "--cycles",
        type=positive_int,
        default=0,
        metavar="N",
        help="exactly N iterations on the finest level (default: as many as the tolerance takes)",
    )
    parser.add_argument(
        "--max-iterations", type=positive_int, default=5000, metavar="N", help="per level (default: %(default)s)"
    )
    parser.add_argument(
        "--no-inter-reflection",
        action="store_true",
        help="leave out light that leaves one part of the object and enters another",
    )
    parser.add_argument(
        "--active-layers",
        type=positive_int,
        default=0,
        metavar="N",
        help="of a polygrid that are solved for on all levels but the coarsest, the rest being taken from the coarser "
        "level, as published (default: all)",
    )
    parser.add_argument(
        "--bounces",
        type=positive_int,
        default=0,
        metavar="N",
        help="of that light (default: until they change nothing)",
    )
    add_path_arguments(parser.add_argument_group("of --method shortest-path"))


def add_path_arguments(group: argparse._ArgumentGroup) -> None:
    """Add what only the shortest-path method asks (docs/shortest-path.md)."""
    group.add_argument(
        "--path-cost",
        choices=("transport", "extinction"),
        default="transport",
        help="of a mm of path: the effective transport coefficient, or the extinction coefficient as published "
        "(default: %(default)s)",
    )
    group.add_argument(
        "--path-solver",
        choices=("eikonal", "lattice"),
        default="eikonal",
        help="any path, or steps between the 26 neighbours of a voxel as published (default: %(default)s)",
    )
    group.add_argument(
        "--path-cells",
        type=positive_int,
        default=64,
        metavar="N",
        help="voxels along the longest side, 8 to 150 (default: %(default)s)",
    )
    size = group.add_mutually_exclusive_group()
    size.add_argument("--unit", choices=tuple(UNITS_MM), help="of the coordinates, where FILE is a mesh without bake")
    size.add_argument(
        "--height",
        type=length_mm,
        metavar="L",
        help="of such a mesh along y, like 100mm or 1.8m (default: 100mm)",
    )


@contextlib.contextmanager
def baked_or_bare(file: Path, unit: str | None, height_mm: float | None) -> Iterator[Path]:
    """The file, or if it is a mesh, one without levels made of it, which is there as long as the block runs."""
    from quadgraph.bake import bare

    if not bare.is_mesh(file):
        if unit is not None or height_mm is not None:
            raise InputError(f"{file}: --unit and --height are for meshes; a baked file knows its size")
        yield file
        return
    if unit is None and height_mm is None:
        height_mm = bare.HEIGHT_MM
    with tempfile.TemporaryDirectory(prefix="quadgraph-") as folder:
        path = Path(folder) / f"{file.stem}.qgraph"
        bare.write(file, path, unit, height_mm)
        yield path


def make_engine(args: argparse.Namespace) -> Engine:
    """Load `args.file` and set material and lights. Raises FormatError, InputError, VulkanError."""
    core = load_core()
    with baked_or_bare(args.file, getattr(args, "unit", None), getattr(args, "height", None)) as path:
        engine = core.Engine(path, device=args.device, validation=args.validation)
    engine.set_material(args.material)
    seen_from = {"view": getattr(args, "view", ""), "up": getattr(args, "up", "y"), "front": engine.graph.front}
    engine.set_lights(args.light or core.default_lights(**seen_from))
    return engine


def solve(engine: Engine, args: argparse.Namespace) -> dict:
    """Solve as the options say; the report of `Engine.solve`, and in `budget` what the bake has to say of the error."""
    taken = record.taken(engine.graph.metadata, args)
    options = {
        "method": args.method,
        "solver": args.solver,
        "source": args.source,
        "model": args.model,
        "tolerance": args.tolerance,
        "error": args.error,
        "cycles": args.cycles,
        "max_iterations": args.max_iterations,
        "inter_reflection": not args.no_inter_reflection,
        "bounces": args.bounces,
        "active_layers": args.active_layers,
        "path_cost": args.path_cost,
        "path_solver": args.path_solver,
        "path_cells": args.path_cells,
    }
    if taken and taken.options:
        options |= taken.options
    return engine.solve(**options) | {"cycles": options["cycles"], "budget": taken.sentence if taken else ""}


def check_validation(engine: Engine) -> None:
    """Raise InputError if the validation layer had anything to say."""
    messages = engine.validation_messages
    if messages:
        raise InputError("Vulkan validation: " + " | ".join(messages))


def unmet(report: dict) -> list[str]:
    """One sentence per level that stopped before the tolerance was met, unless so asked, and one for the error."""
    missed = [report["missed"]] if report["missed"] else []
    if report["cycles"] > 0:
        return missed
    return missed + [
        f"not converged: level {level['level']} stopped after {level['iterations']} iterations "
        f"at residual {level['residual']:.2e}"
        for level in report["levels"]
        if not level["converged"]
    ]
