"""`quadgraph accuracy`: the engine against closed forms, exact transport and random walks (docs/accuracy.md)."""

from __future__ import annotations

import argparse
import importlib
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any

from rich.console import Console

from quadgraph.base import atomic_file, outputs
from quadgraph.base.arguments import positive_float, positive_int
from quadgraph.base.cache_folder import cache_folder
from quadgraph.base.errors import InputError
from quadgraph.core import load_core
from quadgraph.work.schedulers import add_scheduler_argument
from quadgraph_validation.accuracy import kept_rows
from quadgraph_validation.base.machine import commit
from quadgraph_validation.base.study_folders import COMMITTED_TRUTH, add_meshes_argument

# Study to its module of quadgraph_validation.accuracy, less "_study".
STUDIES = {
    "slab": "slab",
    "sphere": "sphere",
    "half-space": "half_space",
    "similarity": "similarity",
    "forward": "forward",
    "cutoff": "cutoff",
    "orders": "orders",
    "coarse": "coarse",
    "dense": "dense",
    "radiance": "radiance",
    "scenes": "scenes",
    "estimate": "estimate",
    "target": "target",
    "budget": "budget",
    "unseen": "unseen",
    "light": "light",
    "pictures": "pictures",
    "converging": "converging",
    "certificate": "certificate",
    "acquire": "acquire",
    "volume": "volume",
    "veined": "veined",
    "wide-field": "wide_field",
    "inverse": "inverse",
}

_WIDE = (
    *("dense", "similarity", "forward", "cutoff", "unseen", "pictures"),
    *("converging", "certificate", "acquire", "volume", "veined", "wide-field", "inverse"),
)
_TABLE_WIDTH = 190  # characters, than which the tables of these cannot be read narrower

# Studies of real bodies, which the CPU reference cannot stand in for, because only the engine does what they judge.
ON_ENGINE = {
    "dense": "makes its exitance even",
    "forward": "is corrected by sweeps",
    "scenes": "makes pictures",
    "estimate": "estimates its error",
    "target": "stops at an error",
    "budget": "is baked for",
    "unseen": "prints an error",
    "light": "prints an error",
    "pictures": "makes pictures",
    "converging": "makes pictures",
    "certificate": "is certified",
    "acquire": "is what photographs are held against",
    "volume": "is what photographs are held against",
    "veined": "is what photographs are held against",
    "wide-field": "is held beside other programs",
    "inverse": "is held beside other programs",
}

# Studies whose cases have names.
_BY_ROWS = ("acquire", "certificate", "converging", "dense", "light", "pictures", "veined", "volume")
_BY_BODIES = ("estimate", "target", "budget")  # whose bodies have names
_BY_WALKS = ("similarity", "cutoff")  # which solve nothing
_BESIDE_OTHERS = ("wide-field", "inverse")  # which time other programs

_UNSEEN_WALKS, _ACQUIRE_WALKS, _VEINED_WALKS, _PICTURE_WALKS = 2_000_000, 8192, 20_000, 2000
_WIDE_FIELD_WALKS = 10_000_000
_CERTIFICATE_S, _CONVERGING_S = 15.0, 120.0


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser("accuracy", help="measure the error against independent truth", description=__doc__)
    parser.add_argument("study", choices=STUDIES, metavar="STUDY", help=", ".join(STUDIES))
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the record here")
    parser.add_argument(
        "--resume",
        action="store_true",
        help=f"{', '.join(_BY_ROWS)}: go on with the record of --json, body by body",
    )
    parser.add_argument(
        "--reference", action="store_true", help="solve with the CPU reference in double precision instead of the GPU"
    )
    parser.add_argument(
        "--device", default="", metavar="NAME", help="cpu, or part of a Vulkan device's name; default: a GPU, else cpu"
    )
    add_scheduler_argument(parser, "the cases of a study")
    of_names = f"scenes, {', '.join(_BY_BODIES)}; {', '.join(_BY_ROWS)} take --scene"
    _add_bodies_options(parser.add_argument_group(of_names))
    _add_scenes_options(parser.add_argument_group("scenes, unseen"))
    _add_unseen_options(
        parser.add_argument_group(
            "unseen; light, pictures, converging, certificate, volume, acquire, veined take --seed, --count, some more"
        )
    )


def _add_bodies_options(group: argparse._ArgumentGroup) -> None:
    group.add_argument("--scene", action="append", default=[], metavar="NAME", help="only this one; several allowed")
    add_meshes_argument(group)


def _add_scenes_options(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--truth",
        type=Path,
        metavar="FOLDER",
        help=f"of the path-traced pictures (default: {COMMITTED_TRUTH}), or of random walks (~/.cache/quadgraph)",
    )
    group.add_argument("--images", type=Path, metavar="FOLDER", help="draw figures there, with matplotlib")


def _add_unseen_options(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--seed", type=positive_int, default=1, metavar="S", help="of the first body (default: %(default)s)"
    )
    group.add_argument("--count", type=positive_int, default=4, metavar="N", help="bodies (default: %(default)s)")
    group.add_argument(
        "--lights",
        choices=("beams", "sky"),
        default="beams",
        help="one beam, point, spot or rectangle, or a smooth sky",
    )
    group.add_argument(
        "--mean-free-paths",
        type=positive_float,
        nargs=2,
        metavar=("LEAST", "MOST"),
        help="across a body's longest side, of unseen (default: 2 40)",
    )
    group.add_argument(
        "--no-inter-reflection",
        dest="inter_reflection",
        action="store_false",
        help="leave out light that enters again, in the engine and in the truth",
    )
    _add_motion_options(group)
    group.add_argument(
        "--seconds",
        type=positive_float,
        metavar="S",
        help=f"of a certificate (default: {_CERTIFICATE_S:g}), or that a picture may converge for (default: "
        f"{_CONVERGING_S:g})",
    )
    group.add_argument(
        "--converge", type=positive_float, default=0.01, metavar="E", help="of converging (default: %(default)s)"
    )
    group.add_argument("--for-material", action="store_true", help="bake each body for its own material")
    group.add_argument(
        "--walks",
        type=positive_int,
        metavar="N",
        help=f"of each truth (default: {_UNSEEN_WALKS}, of wide-field {_WIDE_FIELD_WALKS}), or of a pixel of acquire "
        f"(default: {_ACQUIRE_WALKS}), veined (default: {_VEINED_WALKS}), converging and pictures (default: "
        f"{_PICTURE_WALKS})",
    )
    group.add_argument(
        "--sweeps",
        type=int,
        action="append",
        metavar="N",
        help="of the transport correction; several allowed (default: the engine's own choice)",
    )


def _add_motion_options(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--motion",
        action="store_true",
        help="also 30 frames in which the light turns by 3 degrees each and the material is edited",
    )
    group.add_argument(
        "--carry",
        type=positive_int,
        metavar="N",
        default=1,
        help="with --motion: every Nth frame alone has sweeps, and others carry on what the last one with sweeps was "
        "corrected by; more than 90 for none (default: %(default)s)",
    )


def run(args: argparse.Namespace) -> int:
    """Run one study; 0 on success."""
    load_core()
    outputs.check_outputs([args.json], [])
    study = importlib.import_module(f"quadgraph_validation.accuracy.{STUDIES[args.study]}_study")
    if args.study in ON_ENGINE:
        if args.reference:
            raise InputError(f"{args.study}: --reference found, but only the engine {ON_ENGINE[args.study]}")
        record = _run_on_engine(study, args)
    else:
        record = _run_on_either(study, args)
    console = Console(highlight=False)
    console.width = max(console.width, _TABLE_WIDTH if args.study in _WIDE else 0)
    for table in study.tables(record):
        console.print(table)
    if args.json:
        _write(args, record)
    return 0


def _write(args: argparse.Namespace, record: dict) -> None:
    atomic_file.write_json(args.json, {"study": args.study, "commit": commit()} | record)


def _run_on_either(study: ModuleType, args: argparse.Namespace) -> dict:
    """Run a study that the engine or its reference solves, or that takes neither."""
    from threadpoolctl import threadpool_limits

    from quadgraph_validation.accuracy import case_tasks
    from quadgraph_validation.truth import schemes

    if args.scheduler and args.study in _BY_WALKS:
        return case_tasks.of_cases(args.study, args.scheduler)
    if args.scheduler:
        return case_tasks.of_solved_cases(args.study, args.device, args.reference, args.scheduler)
    # Sums of linear algebra depend on how many threads it has; in tasks it has one, too.
    with threadpool_limits(1, "blas"), Console(stderr=True).status(f"study: {args.study}"):
        return study.run(schemes.chosen(args.device, args.reference))


def _run_on_engine(study: ModuleType, args: argparse.Namespace) -> dict:
    if args.study == "scenes":
        return _run_scenes(study, args)
    if args.study in _BY_ROWS:
        wanted, same = _wanted(study, args)
        return _run_by_rows(study, args, wanted, same)
    if args.study in _BESIDE_OTHERS:
        return _run_beside_others(study, args)
    if args.study == "unseen":
        from quadgraph_validation.accuracy import row_tasks

        truths, sweeps = args.truth or cache_folder(), args.sweeps or (None,)
        wanted = study.UnseenRun(
            args.seed,
            args.count,
            args.walks or _UNSEEN_WALKS,
            truths,
            sweeps,
            args.device,
            args.lights,
            args.inter_reflection,
            args.motion,
            args.carry,
            args.for_material,
            *([tuple(args.mean_free_paths)] if args.mean_free_paths else []),
        )
        record = row_tasks.unseen(wanted, args.scheduler) if args.scheduler else study.run(wanted)
        if args.images:
            from quadgraph_validation.accuracy import unseen_figures

            unseen_figures.write(args.images / "unseen.png", record)
        return record
    if args.scheduler:
        from quadgraph_validation.accuracy import case_tasks

        if args.study == "forward":
            return case_tasks.of_cases(args.study, args.scheduler, device=args.device)
        return case_tasks.of_bodies(args.study, args.device, args.meshes, args.scene, args.scheduler)
    with Console(stderr=True).status(f"study: {args.study}"):
        return study.run(args.device, args.meshes, args.scene)


def _run_beside_others(study: ModuleType, args: argparse.Namespace) -> dict:
    """Run a study in which other programs are timed as well."""
    if args.scheduler:
        raise InputError(f"{args.study}: --scheduler found, but programs are timed one after the other on one machine")
    with Console(stderr=True).status(f"study: {args.study}") as status:
        walks = args.walks or _WIDE_FIELD_WALKS
        of_study = {"wide-field": lambda: study.WideFieldRun(walks, args.device)}
        wanted = of_study.get(args.study, lambda: study.InverseRun(args.device))()
        record = study.run(wanted, lambda what: status.update(f"study: {args.study}, {what}"))
    if args.images and args.study == "inverse":
        from quadgraph_validation.accuracy import inverse_figures

        inverse_figures.write(args.images / "inverse.png", record)
    return record


def _run_scenes(study: ModuleType, args: argparse.Namespace) -> dict:
    asked = (args.device, args.meshes, args.truth or COMMITTED_TRUTH, args.scene, args.images)
    if args.scheduler:
        from quadgraph_validation.accuracy import case_tasks

        return case_tasks.of_scenes(*asked, args.scheduler)
    return study.run(*asked)


def _wanted(study: ModuleType, args: argparse.Namespace) -> tuple[Any, tuple[str, ...]]:
    """What is wanted of a study by rows, and which members of its record are the same where that is gone on with."""
    first, device = (args.seed, args.count), args.device
    if args.study == "acquire":
        return study.AcquireRun(*first, args.walks or _ACQUIRE_WALKS, device), ("seed", "walks")
    if args.study == "veined":
        return study.VeinedRun(*first, args.walks or _VEINED_WALKS, device), ("seed", "walks")
    if args.study == "pictures":
        return study.PicturesRun(*first, args.walks or _PICTURE_WALKS, device), ("seed", "walks")
    if args.study == "certificate":
        seconds, walks = args.seconds or _CERTIFICATE_S, args.walks or _UNSEEN_WALKS
        return study.CertificateRun(*first, seconds, walks, device), ("seed", "seconds", "walks")
    if args.study == "converging":
        walks, seconds = args.walks or _PICTURE_WALKS, args.seconds or _CONVERGING_S
        wanted = study.ConvergingRun(*first, walks, args.converge, seconds, device, args.for_material)
        return wanted, ("seed", "walks", "converge", "for_material")
    if args.study == "volume":
        return study.VolumeRun(*first, device=device), ("seed",)
    if args.study == "light":
        return study.LightRun(*first, device), ("seed",)
    return study.DenseRun(device), ()


def _run_by_rows(study: ModuleType, args: argparse.Namespace, wanted: Any, same: tuple[str, ...]) -> dict:
    """Run a study whose record is written row by row. same: members of a record that are those of what is wanted."""
    if args.resume and not args.json:
        raise InputError("--resume: found without --json, which names the record that is gone on with")

    def write(rows: list[kept_rows.Row]) -> None:
        if args.json:
            _write(args, study.record_of(wanted, rows))

    asked = {name: getattr(wanted, name) for name in same}
    rows = kept_rows.read(args.json, args.study, **asked) if args.resume else []
    if args.scheduler:
        from quadgraph_validation.accuracy import dense_tasks, row_tasks

        by_study = {"dense": dense_tasks.named}.get(args.study, partial(row_tasks.named, STUDIES[args.study]))
        spread = by_study(wanted, args.scheduler)
        return study.run(wanted, kept_rows.KeptRows(args.scene, rows, write, spread=spread))
    with Console(stderr=True).status(f"study: {args.study}") as status:
        kept = kept_rows.KeptRows(args.scene, rows, write, lambda name: status.update(f"study: {args.study}, {name}"))
        return study.run(wanted, kept)
