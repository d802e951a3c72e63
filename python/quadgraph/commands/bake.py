"""`quadgraph bake`: a mesh file into a .qgraph file, or several; or the bodies of a scene into one."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console
from rich.table import Table

from quadgraph.baking.budget import record
from quadgraph.base.arguments import add_strict_argument, positive_float, positive_int, share, up_to
from quadgraph.base.child_process import MOST_MEMORY_BYTES, MOST_TIME_S
from quadgraph.base.errors import InputError
from quadgraph.base.units import UPS
from quadgraph.commands import bake_bodies, bake_many, own_mesh
from quadgraph.work.schedulers import add_scheduler_argument, check_several

if TYPE_CHECKING:
    from quadgraph.baking.report import BakeReport


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser("bake", help="a mesh into a .qgraph file", description=__doc__)
    parser.add_argument(
        "mesh",
        metavar="MESH",
        nargs="+",
        type=Path,
        help="OBJ, PLY, STL, OFF, glTF or GLB, or a folder of them, several allowed; or a scene .json of meshes, whose "
        "bodies go into one file (docs/bodies.md)",
    )
    parser.add_argument(
        "--join",
        action="store_true",
        help="several meshes as the bodies of one file, named as their files are, where they lie in coordinates that "
        "they share; the size is that of all together. One that lies wholly within another shares its surface with it",
    )
    parser.add_argument(
        "--parts",
        action="store_true",
        help="the named parts of a mesh file, objects of OBJ or nodes of glTF, as the bodies of one file",
    )
    parser.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        type=Path,
        help="the .qgraph to write (default: the mesh's name in the present folder, where there is none of it yet); of "
        "several meshes the folder for them, but with --join the file",
    )
    add_scheduler_argument(parser, "the bakes of several meshes")
    own_mesh.add_size_arguments(parser)
    parser.add_argument(
        "--up",
        choices=UPS,
        default="y",
        help="axis of the mesh's coordinates that points up: of the body it is y (default: %(default)s)",
    )
    _add_mesh_options(parser)
    _add_size_options(parser)
    parser.add_argument(
        "--time-limit",
        type=up_to(MOST_TIME_S),
        metavar="S",
        help="CPU seconds for each run of the mesher; its wall time may be four times as long (default: 300)",
    )
    parser.add_argument(
        "--memory-limit",
        type=up_to(MOST_MEMORY_BYTES / 1e9),
        metavar="GB",
        help="memory for each run of the mesher (default: 4.3)",
    )
    parser.add_argument("--json", action="store_true", help="print the report as JSON on standard output")
    parser.add_argument(
        "--surface-only",
        action="store_true",
        help="no levels and no repair, done at once: for --method shortest-path, which takes any mesh",
    )
    _add_error_options(parser.add_argument_group("no more than an error needs"))


def _add_error_options(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--error",
        type=share,
        metavar="E",
        help="choose surface vertices, levels, model, cycles and sweeps by measuring: as few as keep the relative RMS "
        "error of the exitance against transport below E, e.g. 2%%, over the whole and over the unlit surface; a "
        "warning if the mesh cannot",
    )
    add_strict_argument(group)
    group.add_argument("--material", metavar="M", help="material that the error is for, as in `render`")
    group.add_argument(
        "--light",
        action="append",
        metavar="L",
        help="lights that the error is for, as in `render`; several allowed (default: three usual sets of lights, "
        "under all of which it is kept)",
    )
    group.add_argument(
        "--device", default="", metavar="NAME", help="cpu, or part of a Vulkan device's name; default: a GPU, else cpu"
    )


def _add_mesh_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--levels", type=positive_int, metavar="N", help="levels of detail (default: automatic)")
    parser.add_argument(
        "--surface-vertices",
        type=positive_int,
        metavar="N",
        help="simplify the simulation surface to about N vertices first; the displayed surface keeps all of its own",
    )
    parser.add_argument(
        "--mesher",
        choices=("tetgen", "cgal", "polygrid"),
        default="tetgen",
        help="polygrid: a grid of regular connectivity in the shape of the body, which --method polygrid needs "
        "(default: %(default)s)",
    )
    parser.add_argument(
        "--cubes", type=positive_int, metavar="N", help="cubes of a polygrid along the longest side (default: about 8)"
    )
    parser.add_argument(
        "--cells",
        type=positive_int,
        metavar="N",
        help="cells of a polygrid along a cube's side on the finest level, a power of 2 (default: 4)",
    )
    parser.add_argument(
        "--grading", type=positive_float, metavar="K", help="growth of cgal's tets with depth (default: 1)"
    )
    parser.add_argument(
        "--relax-nodes", type=steps, metavar="N", help="steps that spread the inner nodes evenly (default: 16; 0: none)"
    )
    parser.add_argument(
        "--visibility-rays",
        type=steps,
        metavar="N",
        help="rays from each face of one level that find which parts of the body see each other, so that light that "
        "leaves one enters another (default: 256; 0: none)",
    )
    parser.add_argument(
        "--normals",
        choices=("file", "angle"),
        default="file",
        help="of the displayed surface: those of the mesh file (vn of OBJ, nx ny nz of PLY, NORMAL of glTF) where it "
        "gives some on the right side of their triangles, with the normal texture of glTF, and smooth ones up to edges "
        "of 40 degrees elsewhere; angle: the latter everywhere (default: %(default)s)",
    )
    parser.add_argument(
        "--front",
        type=float,
        metavar="DEG",
        help="azimuth about y of the default view (default: 0, from +z, unless another of "
        "eight shows plainly more of its relief)",
    )
    parser.add_argument(
        "--order",
        choices=("blocks", "random"),
        default="blocks",
        help="order of nodes in memory (default: %(default)s)",
    )


def _add_size_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--refine",
        type=steps,
        metavar="N",
        help="cut every triangle of the simulation surface into four, N times, curved where the body is smooth; the "
        "displayed surface stays as it is (default: 0)",
    )
    parser.add_argument(
        "--interior",
        type=interior,
        metavar="SIZE",
        help="how large tets are deep inside: an edge length in mm, auto (a tenth of the mean chord, or what 1.4 times "
        "the tets of the surface alone allow) or surface (as the surface makes them); of coarser levels twice that, "
        "four times, ... (default: auto; with --mesher cgal surface)",
    )
    parser.add_argument(
        "--for-material",
        action="append",
        metavar="M",
        help="size the tets inside for the light in this material instead, and for how it changes from place to "
        "place; triangles in which it changes are cut, on the simulation surface curved as by --refine, on the "
        "displayed one straight, down to edges of half a mean free path; several allowed: coefficients, like "
        "sigma_s_prime=2.0,sigma_a=0.01/0.02/0.05, or any text or .npz as in `render`",
    )


def steps(text: str) -> int:
    """Argument type: an integer of at least zero."""
    value = int(text)
    if value < 0:
        raise argparse.ArgumentTypeError(f"{text}: must be 0 or more")
    return value


def interior(text: str) -> str | float:
    """Argument type: auto, surface, or a number above zero."""
    return text if text in ("auto", "surface") else positive_float(text)


def run(args: argparse.Namespace) -> int:
    """Bake, telling the progress on standard error; 3 with --strict if --error is not kept, else 0."""
    if bake_bodies.is_asked(args):
        report = bake_bodies.run(args, _options(args))
        print(json.dumps(report.as_dict(), indent=1)) if args.json else _print_report(report)
        return 0
    several = bake_many.is_several(args.mesh)
    check_several(args, several, "several meshes are wanted, or a folder of them")
    if several:
        return _run_several(args)
    (args.mesh,) = args.mesh
    if args.output is None:
        args.output = _own_name(args.mesh)
    if args.surface_only:
        return _write_surface(args)
    _check_error_options(args)
    errors = Console(stderr=True, highlight=False)
    with errors.status(f"baking {args.mesh.name}"):
        report = _bake(args, lambda text: errors.print(text, markup=False, soft_wrap=True))
    if args.json:
        print(json.dumps(report.as_dict(), indent=1))
    else:
        _print_report(report)
    return 3 if args.strict and report.budget and not report.budget["reached"] else 0


def _run_several(args: argparse.Namespace) -> int:
    if args.surface_only:
        raise InputError("--surface-only: found with several meshes; it takes no time, one after the other")
    _check_error_options(args)
    return bake_many.run(args, _options(args))


def _own_name(mesh: Path) -> Path:
    """The name of a bake that nobody gave one. Raises InputError where there is such a file."""
    path = Path(f"{mesh.stem}.qgraph")
    if path.exists() or path.is_symlink():
        raise InputError(f"{path}: is there already, and no --output is given; -o {path} replaces it")
    return path


def _write_surface(args: argparse.Namespace) -> int:
    """Write a file without levels."""
    from quadgraph.baking import bare

    left_alone = {
        *("mesh", "output", "unit", "height", "longest", "up", "front"),
        *("surface_only", "normals", "mesher", "order", "device", "scheduler", "no_config"),
    }
    for name in sorted(args.given - left_alone):
        if getattr(args, name):
            raise InputError(f"--{name.replace('_', '-')}: found with --surface-only, which makes no levels")
    source = bare.write(
        args.mesh, args.output, **own_mesh.sizes(args), front_degrees=args.front, up=args.up, normals=args.normals
    )
    console = Console(highlight=False)
    if source.size_note:
        console.print(source.size_note, markup=False, soft_wrap=True)
    console.print(
        f"{args.output}: the surface alone, {source.triangles:,} triangles; --method shortest-path shows it",
        soft_wrap=True,
    )
    return 0


def _check_error_options(args: argparse.Namespace) -> None:
    if args.error is not None:
        if args.mesher == "polygrid":
            raise InputError("--error: found with --mesher polygrid, which is not coarsened for an error")
        if args.material is None:
            raise InputError("--error: --material is missing; how fine a mesh must be depends on what it is made of")
        return
    for name in ("material", "light"):
        if getattr(args, name) is not None:
            raise InputError(f"--{name}: found without --error; without one a file is baked for every {name}")


def _bake(args: argparse.Namespace, tell: Callable[[str], None]) -> BakeReport:
    if args.error is None:
        from quadgraph.baking.pipeline import bake

        return bake(args.mesh, args.output, _options(args), tell)
    from quadgraph.baking.budget.plan import bake_for

    return bake_for(
        args.mesh, args.output, _options(args), args.error, args.material, args.light or (), args.device, tell
    )


def _options(args: argparse.Namespace):
    from quadgraph.baking.pipeline import BakeOptions

    given = {
        "up": args.up,
        "levels": args.levels,
        "mesher": args.mesher,
        "grading": args.grading,
        "cubes": args.cubes,
        "cells": args.cells,
        "relax_nodes": args.relax_nodes,
        "order": args.order,
        "surface_vertices": args.surface_vertices,
        "normals": args.normals,
        "refine": args.refine,
        "interior": args.interior,
        "for_materials": tuple(args.for_material) if args.for_material else None,
        "visibility_rays": args.visibility_rays,
        "front": args.front,
        "time_limit_s": args.time_limit,
        "memory_limit_bytes": int(args.memory_limit * 1e9) if args.memory_limit else None,
    }
    return BakeOptions(**own_mesh.sizes(args), **{name: value for name, value in given.items() if value is not None})


def _print_report(report: BakeReport) -> None:
    console = Console(highlight=False)
    console.print(level_table(report.levels))
    for entry in report.repairs:
        console.print(f"repaired: {entry['what']}: {entry['count']:,}", markup=False)
    for note in report.notes:
        console.print(note, markup=False, soft_wrap=True)
    if report.normals:
        from quadgraph.mesh.looks import file_normals

        console.print(file_normals.sentence(report.normals), markup=False, soft_wrap=True)
    if report.polygrid:
        from quadgraph.tets.polygrid.grid_report import sentences

        for sentence in sentences(report.polygrid):
            console.print(sentence, markup=False, soft_wrap=True)
    if report.budget:
        for sentence in record.sentences(report.budget, report.output):
            console.print(sentence, markup=False, soft_wrap=True)
    variation = report.levels[0]["link_length_variation"]
    console.print(
        f"link lengths vary by {100 * variation['before']['local']:.1f}% of their local mean, "
        f"{100 * variation['after']['local']:.1f}% after relaxing"
    )
    if report.interior:
        from quadgraph.baking import inside

        console.print(inside.sentence(report.interior), markup=False, soft_wrap=True)
    console.print(exchange_line(report.exchange))
    console.print("time: " + ", ".join(f"{stage} {seconds:.1f} s" for stage, seconds in report.seconds.items()))
    memory = report.peak_memory
    console.print(f"memory: {memory['self'] / 1e6:.0f} MB, largest child {memory['largest_child'] / 1e6:.0f} MB")
    console.print(f"wrote {report.output}: {report.byte_size / 1e6:.1f} MB", markup=False)


def exchange_line(summary: dict | None) -> str:
    """One line about which parts see each other: `exchange.summary`, None where that was left out."""
    if summary is None:
        return "exchange: none, light that leaves the body does not enter it again"
    return (
        f"exchange: the body sees itself in {100 * summary['share']:.1f}% of all directions, "
        f"by {summary['rays']:,} rays a face on level {summary['level']}, {summary['bytes'] / 1e6:.2f} MB"
    )


def level_table(levels: list[dict]) -> Table:
    """Return one row per level of the metadata's `levels`."""
    table = Table("level", "vertices", "on surface", "tets", "faces", "volume, mm3", "area, mm2")
    for number, level in enumerate(levels):
        counts = (level[key] for key in ("vertices", "surface_vertices", "tets", "faces"))
        table.add_row(
            str(number), *(f"{n:,}" for n in counts), f"{level['volume_mm3']:,.1f}", f"{level['area_mm2']:,.1f}"
        )
    return table
