"""`quadgraph bench`: passes, solvers, other people's solvers, and growth with size, on fixed scenes.

The last line printed is JSON: schema, commit, device, and the figures of all parts by flat names.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from quadgraph.base import atomic_file, outputs
from quadgraph.base.arguments import add_device_arguments, positive_int
from quadgraph.base.errors import InputError
from quadgraph.core import load_core
from quadgraph_validation.base.machine import machine

if TYPE_CHECKING:
    from quadgraph.base.progress import ProgressCallback
    from quadgraph_validation.benchmark.forecast import FrameForecast

_TABLE_WIDTH = 140  # characters; narrower, the tables cannot be read
_SLOWER = 3  # exit status
_MEASURING = (
    *("file", "passes", "solvers", "live", "rivals", "scaling", "growth"),
    *("sizes", "side", "forecast", "random_order", "bodies", "chart", "json", "device", "validation"),
)
_RULE = (
    "A figure is the median of its runs. It is slower, or faster, if it changed by more than 2% and by more than the "
    "noise of the runs: Student's t of their pooled standard deviation, at a level where one table in a hundred names "
    "a figure although none changed. Work and cycles are counts without noise. What changes between the two runs but "
    "not within them (other load, a warmer machine) is not seen. Exit status: 0 if nothing is slower, 3 if something "
    "is, 1 if the runs cannot be compared or the new one lacks figures."
)


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser("bench", help="time, bytes, work and error of the solvers", description=__doc__)
    parser.add_argument(
        "file",
        metavar="FILE",
        type=Path,
        nargs="?",
        help="a baked .qgraph (default: pymeshlab's bunny, baked for the occasion in three sizes)",
    )
    _add_what(parser)
    parser.add_argument(
        "--random-order",
        type=Path,
        metavar="FILE",
        help="the same object baked with --order random: every pass is measured in both in turn",
    )
    parser.add_argument(
        "--bodies",
        type=Path,
        metavar="FOLDER",
        help="keep what is baked there, and take from there what is (default: bake for the occasion)",
    )
    parser.add_argument(
        "--repeats",
        type=positive_int,
        default=5,
        metavar="N",
        help="runs of a figure, after one that is left out; with 2 or more they have a spread (default: %(default)s)",
    )
    parser.add_argument("--material", default="marble", metavar="M", help="default: %(default)s")
    parser.add_argument("--chart", type=Path, metavar="FOLDER", help="draw error-work.png and error-time.png there")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the record here")
    add_device_arguments(parser)
    parser.add_argument_group("what got slower", _RULE).add_argument(
        "--compare",
        nargs=2,
        type=Path,
        metavar=("OLD", "NEW"),
        help="measure nothing; hold two runs against each other: files of what was printed, or of --json",
    )


def _add_what(parser: argparse.ArgumentParser) -> None:
    what = parser.add_argument_group("what is measured (default: --passes and --solvers)")
    what.add_argument("--passes", action="store_true", help="ms, bytes, GB/s and share of copying of every pass")
    what.add_argument("--solvers", action="store_true", help="error against work and time, all solvers")
    what.add_argument("--live", action="store_true", help="a frame while light, material and shape change, by pass")
    what.add_argument("--side", type=positive_int, metavar="N", help="pixels a side of --live (default: 512)")
    what.add_argument(
        "--forecast",
        type=_forecast,
        metavar="GB/S,US[,M]",
        help="what the frames of --live take at least on a device of such a bandwidth, microseconds a dispatch, and "
        "million tets that rays cross a second",
    )
    what.add_argument("--rivals", action="store_true", help="SciPy's CG and PyAMG on the identical system")
    what.add_argument("--scaling", action="store_true", help="cycles and time from 3 thousand to 2 million tets")
    what.add_argument(
        "--sizes",
        type=_sizes,
        metavar="N,N,...",
        help="surface vertices of the bodies of --scaling (default: 500 to 330 thousand)",
    )
    what.add_argument(
        "--growth", action="store_true", help="bakes and acquisitions by size, lights and workers (docs/scaling.md)"
    )


def _forecast(text: str) -> FrameForecast:
    from quadgraph_validation.benchmark import forecast

    return forecast.parse(text)


def _sizes(text: str) -> tuple[int, ...]:
    return tuple(positive_int(part) for part in text.split(","))


def run(args: argparse.Namespace) -> int:
    """Measure, print, record, or compare; 0 on success, _SLOWER if the comparison found something slower."""
    if args.compare:
        return _compare(args)
    outputs.check_outputs([args.json], [])
    if not (args.passes or args.solvers or args.live or args.rivals or args.scaling or args.growth):
        args.passes = args.solvers = True
    _check(args)
    from rich.console import Console

    from quadgraph_validation.benchmark import bench_tables, figures, growth

    core, console = load_core(), Console(highlight=False)
    console.width = max(console.width, _TABLE_WIDTH)
    with tempfile.TemporaryDirectory(prefix="quadgraph-bench-") as folder:
        bodies = args.bodies or Path(folder)
        bodies.mkdir(parents=True, exist_ok=True)
        with Console(stderr=True).status("copy bandwidth") as status:
            copied = core.copy_bandwidth(args.device)
            record = {"schema": figures.SCHEMA} | machine(copied) | {"repeats": args.repeats}
            record |= _measure(args, bodies, copied, status.update)
        if args.growth:
            record["growth"] = growth.run(bodies)
    record["figures"] = figures.of(record)
    console.print(", ".join(f"{key}: {record[key]}" for key in ("device", "driver", "cores", "load", "commit")))
    console.print(bench_tables.copy_text(record["copy"]))
    forecasts = [args.forecast.table(kind) for kind in record["live"]["kinds"]] if args.forecast else []
    for table in [*bench_tables.all_of(record), *forecasts]:
        console.print(table)
    _write(args, record)
    print(figures.line(record))
    return 0


def _compare(args: argparse.Namespace) -> int:
    if any(getattr(args, name) for name in _MEASURING):
        raise InputError("--compare measures nothing: it takes OLD and NEW alone")
    from rich.console import Console

    from quadgraph_validation.benchmark import comparison

    found = comparison.compare(*map(comparison.read, args.compare))
    console = Console(highlight=False, markup=False, emoji=False)
    console.width = max(console.width, _TABLE_WIDTH)
    console.print(comparison.table(found))
    print("\n".join(comparison.summary(found)))
    comparison.check_complete(found)
    return _SLOWER if found.names("slower") else 0


def _measure(args: argparse.Namespace, folder: Path, copied: dict[str, Any], tell: ProgressCallback) -> dict[str, Any]:
    from quadgraph_validation.benchmark.bench_parts import Parts
    from quadgraph_validation.benchmark.bench_scene import Device
    from quadgraph_validation.benchmark.live_frames import SIDE
    from quadgraph_validation.benchmark.scaling import SURFACE_VERTICES

    device = Device(args.device, args.validation)
    parts = Parts(args.file, args.random_order, args.material, args.repeats, device, folder, copied, tell)
    record: dict[str, Any] = {}
    for name in ("passes", "solvers", "rivals"):
        if getattr(args, name):
            record[name] = getattr(parts, name)()
    if args.live:
        record["live"] = parts.live(args.side or SIDE)
        if args.forecast:
            for kind in record["live"]["kinds"]:
                kind["forecast"] = args.forecast.of(kind)
    if args.scaling:
        record["scaling"] = parts.scaling(args.sizes or SURFACE_VERTICES)
    return record


def _check(args: argparse.Namespace) -> None:
    """Refuse before the work what would fail after it."""
    for path in filter(None, (args.file, args.random_order)):
        if not path.is_file():
            raise InputError(f"{path}: no such file")
    if args.random_order and not (args.file and args.passes):
        raise InputError("--random-order needs --passes and the FILE to compare with")
    if args.side and not args.live:
        raise InputError("--side belongs to --live, which is absent")
    if args.forecast and not args.live:
        raise InputError("--forecast belongs to --live, which is absent")
    if args.sizes and not args.scaling:
        raise InputError("--sizes belongs to --scaling, which is absent")
    if args.chart:
        from quadgraph_validation.base.pyplot import load_pyplot

        if not args.solvers:
            raise InputError("--chart draws what --solvers measures, which is absent")
        load_pyplot("bench")
    if args.rivals:
        from quadgraph_validation.benchmark.rivals import load_pyamg

        load_pyamg()


def _write(args: argparse.Namespace, record: dict[str, Any]) -> None:
    if args.chart:
        from quadgraph_validation.benchmark import bench_charts

        for path in bench_charts.write(args.chart, record):
            print(f"wrote {path}")
    if args.json:
        atomic_file.write_json(args.json, record)
