"""`quadgraph reference`: make the truths that methods are held against, or go on with them (docs/truth.md)."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.table import Table

from quadgraph.base.arguments import positive_int
from quadgraph.base.cache_folder import cache_folder
from quadgraph.base.errors import InputError
from quadgraph.core import load_core
from quadgraph.work.schedulers import add_scheduler_argument
from quadgraph_validation.base.study_folders import COMMITTED_TRUTH, add_meshes_argument

if TYPE_CHECKING:
    from quadgraph_validation.bodies.scenes import StudyScene

KINDS = ("transport", "pde", "walk")
MODELS, SOURCES = ("sp3", "diffusion"), ("buried", "diffuse")


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser(
        "reference", help="make the truths that methods are held against", description=__doc__
    )
    parser.add_argument("scene", nargs="*", metavar="SCENE", help="bunny, fertility, spot, sphere, skin (default: all)")
    parser.add_argument(
        "--kind",
        choices=KINDS,
        required=True,
        help="transport: pictures by path tracing with Mitsuba; pde: the exitance of converged linear elements in "
        "double precision; walk: random walks through 'sphere' and 'slab', to check the others by. Ctrl-C keeps what "
        "is there, and the same command goes on",
    )
    add_meshes_argument(parser)
    parser.add_argument(
        "--truth",
        type=Path,
        metavar="FOLDER",
        help=f"where truths are kept (default: {COMMITTED_TRUTH} for transport, else ~/.cache/quadgraph)",
    )
    add_scheduler_argument(parser, "images of transport, equations of pde and walks")
    _add_transport_options(parser.add_argument_group("transport"))
    _add_pde_options(parser.add_argument_group("pde"))
    parser.add_argument_group("walk").add_argument(
        "--walks", type=positive_int, default=1_000_000, metavar="N", help="through each (default: %(default)s)"
    )


def _add_transport_options(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--samples",
        type=positive_int,
        metavar="N",
        help="bring the pictures to N samples a pixel, those of dark sides to as many times more (required)",
    )


def _add_pde_options(group: argparse._ArgumentGroup) -> None:
    group.add_argument("--model", action="append", choices=MODELS, help="several allowed (default: both)")
    group.add_argument("--source", action="append", choices=SOURCES, help="several allowed (default: buried)")


def run(args: argparse.Namespace) -> int:
    """Make the truths; 0 on success."""
    table = {"transport": _transport, "pde": _pde, "walk": _walk}[args.kind](args)
    Console(highlight=False).print(table)
    return 0


def _transport(args: argparse.Namespace) -> Table:
    from quadgraph_validation.bodies import scene_meshes, scenes
    from quadgraph_validation.truth import truth_run
    from quadgraph_validation.truth.path_tracing import BATCH

    if args.samples is None:
        raise InputError("--samples: not given, a number of samples a pixel is needed")
    folder = args.truth or COMMITTED_TRUTH
    chosen = scenes.chosen(args.scene)
    subjects = [truth_run.subject(one, scene_meshes.file(one, args.meshes)) for one in chosen]
    if args.scheduler:
        from quadgraph_validation.truth import truth_tasks

        truth_tasks.path_traced(subjects, folder, args.samples, args.scheduler)
    else:
        truth_run.render(subjects, folder, args.samples, Console(stderr=True))
    table = Table("scene", "image", "samples a pixel", "lit: noise of a block", "all")
    for found in subjects:
        for name in found.scene.images:
            image = truth_run.stored(found, folder, name)
            noise = (f"{value:.2%}" for value in truth_run.noise(image))
            table.add_row(found.scene.name, name, f"{image.batches * BATCH:,}", *noise)
    return table


def _pde(args: argparse.Namespace) -> Table:
    from quadgraph_validation.bodies import scenes

    load_core()
    parts = ("whole", "unlit")
    names = ("first step", "second step", "noise")
    table = Table("scene", "model", "source", *(f"{name}: {part}" for name in names for part in parts))
    chosen = scenes.chosen(args.scene)
    wanted = [
        (one, model, source)
        for one in chosen
        for source in args.source or SOURCES[:1]
        for model in args.model or MODELS
    ]
    for (one, model, source), found in zip(wanted, _of_equations(args, wanted), strict=True):
        numbers = [errors.get(part) for errors in (*found["steps"], found["noise"]) for part in parts]
        cells = ("" if number is None else f"{number:.2%}" for number in numbers)
        table.add_row(one.name, model, source, *cells)
    return table


def _of_equations(args: argparse.Namespace, wanted: list[tuple[StudyScene, str, str]]) -> list[dict[str, Any]]:
    from quadgraph_validation.truth import truth_tasks

    folder = args.truth or cache_folder()
    if args.scheduler:
        return truth_tasks.of_equations(wanted, args.meshes, folder, args.scheduler)
    return [
        truth_tasks.equations(one.name, model, source, str(args.meshes), str(folder)) for one, model, source in wanted
    ]


def _walk(args: argparse.Namespace) -> Table:
    from quadgraph_validation.truth import cross_checks

    for name in args.scene:
        if name not in cross_checks.BODIES:
            raise InputError(f"scene '{name}': allowed with --kind walk are {', '.join(cross_checks.BODIES)}")
    chosen, console = args.scene or cross_checks.BODIES, Console(stderr=True)
    missing = cross_checks.why_no_pmmc()
    if missing:
        console.print(f"left out: {missing}", highlight=False, markup=False, soft_wrap=True)
    folder, pictures = args.truth or cache_folder(), args.truth or COMMITTED_TRUTH
    if args.scheduler:
        from quadgraph_validation.truth import check_tasks

        rows = check_tasks.rows(chosen, args.walks, folder, pictures, not missing, args.scheduler)
    else:
        rows = cross_checks.rows(chosen, args.walks, folder, pictures, not missing, console)
    table = Table("quantity", "our walks", "by others", "standard errors apart")
    for row in rows:
        others = (f"{name} {_with_error(*value)}" for name, value in row.others.items())
        apart = (f"{value:+.1f}" for value in row.deviations().values())
        table.add_row(row.quantity, _with_error(*row.ours), "\n".join(others), "\n".join(apart))
    return table


def _with_error(mean: float, error: float) -> str:
    return f"{mean:.5g} ± {error:.1g}" if error else f"{mean:.5g}"
