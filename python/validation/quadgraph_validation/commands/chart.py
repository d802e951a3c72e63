"""`quadgraph chart`: scenes x methods to milliseconds a frame, errors against both truths, and how steady frames are in
motion (docs/chart.md).
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from quadgraph.base import atomic_file, outputs
from quadgraph.base.arguments import positive_int
from quadgraph.base.errors import InputError
from quadgraph.work.schedulers import add_scheduler_argument
from quadgraph_validation.base.study_folders import COMMITTED_TRUTH, add_meshes_argument

TRUTHS = ("pde", "transport", "walks")
_TABLE_WIDTH = 250  # characters; narrower, the tables cannot be read


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser("chart", help="speed against accuracy of all methods", description=__doc__)
    parser.add_argument(
        "--output",
        type=Path,
        metavar="FOLDER",
        help="draw chart-SCENE.png, .svg, pictures-SCENE.png and chart.html there",
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the record here")
    parser.add_argument(
        "--add",
        action="store_true",
        help="keep the other scenes that the file of --json has: times are compared within a scene alone",
    )
    parser.add_argument(
        "--from",
        dest="record",
        type=Path,
        metavar="FILE",
        help="draw the charts of that record again, the same to the byte, instead of measuring; needs no device",
    )
    add_scheduler_argument(parser, "scenes")
    _add_measure_options(parser.add_argument_group("what is measured"))
    _add_truth_options(parser.add_argument_group("truth"))


def _add_measure_options(group: argparse._ArgumentGroup) -> None:
    group.add_argument("--scene", action="append", default=[], metavar="NAME", help="only this one; several allowed")
    group.add_argument(
        "--method",
        action="append",
        default=[],
        metavar="TEXT",
        help="only methods with this text in their names; several allowed",
    )
    group.add_argument("--repeats", type=positive_int, default=3, metavar="N", help="default: %(default)s")
    group.add_argument(
        "--pixels",
        type=positive_int,
        default=256,
        metavar="N",
        help="edge of the picture that a frame draws (default: %(default)s)",
    )
    group.add_argument(
        "--device", default="", metavar="NAME", help="cpu, or part of a Vulkan device's name; default: a GPU, else cpu"
    )


def _add_truth_options(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--against",
        choices=TRUTHS,
        action="append",
        help="only this truth; several allowed (default: all; `reference` makes pde and transport)",
    )
    add_meshes_argument(group)
    group.add_argument(
        "--truth",
        type=Path,
        metavar="FOLDER",
        help=f"where truths are (default: {COMMITTED_TRUTH} for transport, ~/.cache/quadgraph for others)",
    )


def run(args: argparse.Namespace) -> int:
    """Measure or read, print, draw; 0 on success."""
    _check(args)
    from rich.console import Console

    from quadgraph_validation.chart import chart_record as records
    from quadgraph_validation.chart import chart_tables, equal_error

    kept = records.read(args.json) if args.add and args.json.exists() else None
    record = records.read(args.record) if args.record else json.loads(json.dumps(_measured(args)))
    record = records.added(kept, record) if kept else record
    console = Console(highlight=False)
    console.width = max(console.width, _TABLE_WIDTH)
    for table in (*chart_tables.all_of(record), equal_error.table(record)):
        if table is not None:
            console.print(table)
    if args.json and not args.record:
        atomic_file.write_json(args.json, record)
    if args.output:
        from quadgraph_validation.chart import chart_page, static_chart

        for path in (*static_chart.write(args.output, record), chart_page.write(args.output / "chart.html", record)):
            print(f"wrote {path}")
    return 0


def _check(args: argparse.Namespace) -> None:
    """Refuse before the work what would fail after it."""
    outputs.check_outputs([args.json], [])
    if args.add and not args.json:
        raise InputError("--add: needs --json FILE, whose scenes are kept")
    if args.record and (args.json or args.scene or args.method or args.against):
        raise InputError(
            "--from draws a record as it is: --json, --scene, --method and --against cannot be given with it"
        )
    if args.output:
        from quadgraph_validation.base.pyplot import load_pyplot
        from quadgraph_validation.chart.chart_page import load_plotly

        load_pyplot("chart")
        load_plotly()


def _measured(args: argparse.Namespace) -> dict[str, Any]:
    from rich.console import Console

    from quadgraph_validation.bodies import scenes
    from quadgraph_validation.chart import scene_measure
    from quadgraph_validation.chart.chart_record import FORMAT

    wanted = scene_measure.ChartRun(
        str(args.meshes),
        str(args.truth) if args.truth else None,
        args.against or TRUTHS,
        args.method,
        args.device,
        args.pixels,
        args.repeats,
        str(args.output) if args.output else None,
    )
    names = [one.name for one in scenes.chosen(args.scene)]
    if args.scheduler:
        return {"format": FORMAT, "scenes": scene_measure.spread(names, wanted, args.scheduler)}
    with Console(stderr=True).status("truths") as status:
        return {"format": FORMAT, "scenes": scene_measure.measured(names, wanted, status.update)}
