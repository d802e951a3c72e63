"""`quadgraph tables`: the QuadGraph paper's tables and figures again, its method beside ours (docs/tables.md)."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from typing import Any

from quadgraph.base import atomic_file
from quadgraph.base.arguments import positive_float, positive_int
from quadgraph.base.errors import InputError
from quadgraph.core import load_core
from quadgraph_validation.base.study_folders import COMMITTED_TRUTH, add_meshes_argument

TABLES = ("1", "12", "13", "14", "packing")
DEFAULT_SCALE = 0.1


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser("tables", help="the QuadGraph paper's tables and figures again", description=__doc__)
    parser.add_argument(
        "--json",
        type=Path,
        metavar="FILE",
        help="the record: rows are written as they are measured, and a run that was interrupted goes on from there "
        "(default: ~/.cache/quadgraph/tables.json)",
    )
    parser.add_argument("--output", type=Path, metavar="FOLDER", help="draw tables-NAME.png there, with matplotlib")
    parser.add_argument(
        "--document",
        type=Path,
        metavar="FILE",
        help="put each table between the lines <!-- table NAME --> and <!-- end --> of that Markdown file",
    )
    parser.add_argument(
        "--from",
        dest="record",
        type=Path,
        metavar="FILE",
        help="print and draw that record again, the same to the byte, instead of measuring; needs no device",
    )
    _add_measure_options(parser.add_argument_group("what is measured"))


def _add_measure_options(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--table",
        action="append",
        choices=TABLES,
        default=[],
        help="only this one: Table 1, Figure 12, 13 or 14, or the gain of packed order; several allowed",
    )
    group.add_argument("--body", action="append", default=[], metavar="NAME", help="only on this body; several allowed")
    size = group.add_mutually_exclusive_group()
    size.add_argument(
        "--scale",
        type=positive_float,
        default=DEFAULT_SCALE,
        metavar="S",
        help="share of the paper's numbers of surface nodes (default: %(default)s)",
    )
    size.add_argument(
        "--full", action="store_true", help="the paper's own sizes, and pictures of 1024² pixels: hours without a GPU"
    )
    group.add_argument("--repeats", type=positive_int, default=2, metavar="N", help="default: %(default)s")
    group.add_argument(
        "--pixels", type=positive_int, metavar="N", help="edge of a frame's picture (default: 256; --full: 1024)"
    )
    group.add_argument(
        "--bodies", type=Path, metavar="FOLDER", help="where baked bodies are kept (default: ~/.cache/quadgraph/tables)"
    )
    add_meshes_argument(group)
    group.add_argument(
        "--truth",
        type=Path,
        default=COMMITTED_TRUTH,
        metavar="FOLDER",
        help="of path-traced pictures, for Figure 13 (default: %(default)s)",
    )
    group.add_argument(
        "--device", default="", metavar="NAME", help="cpu, or part of a Vulkan device's name; default: a GPU, else cpu"
    )


def run(args: argparse.Namespace) -> int:
    """Measure or read, print, draw; 0 on success."""
    _check(args)
    from quadgraph_validation.tables import table_figures
    from quadgraph_validation.tables import table_record as records
    from quadgraph_validation.tables import table_text as text

    record = records.read(args.record) if args.record else _measured(args)
    try:
        print(text.document(record), end="")
        if args.output:
            for path in table_figures.write(args.output, record):
                print(f"wrote {path}", file=sys.stderr)
    except (KeyError, TypeError, AttributeError, IndexError) as error:
        raise InputError(f"{args.record}: tables: {type(error).__name__} of {error}, which a record has") from error
    if args.document:
        content = _filled(args.document, record)
        with atomic_file.replacing(args.document) as stream:
            stream.write(content.encode())
    return 0


def _check(args: argparse.Namespace) -> None:
    """Refuse before the work what would fail after it."""
    if args.record and (args.json or args.table or args.body):
        raise InputError("--from prints a record as it is: --json, --table and --body cannot be given with it")
    if args.output:
        from quadgraph_validation.base.pyplot import load_pyplot

        load_pyplot("bench")
    if args.document:
        _filled(args.document, {"tables": {}})
    if not args.record:
        from quadgraph_validation.tables import table_plan

        table_plan.check(args.body)


def _filled(path: Path, record: dict[str, Any]) -> str:
    from quadgraph_validation.tables import table_text as text

    try:
        return text.filled(path.read_text(), record)
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: {error}") from error


def _measured(args: argparse.Namespace) -> dict[str, Any]:
    from rich.console import Console

    from quadgraph.base.cache_folder import cache_folder
    from quadgraph_validation.base.machine import machine
    from quadgraph_validation.tables import table_plan
    from quadgraph_validation.tables import table_record as records
    from quadgraph_validation.tables.table_bodies import Store
    from quadgraph_validation.tables.table_row import TableSetting

    scale = 1.0 if args.full else args.scale
    pixels = args.pixels or (1024 if args.full else 256)
    store = Store(args.meshes, args.bodies or cache_folder() / "tables")
    setting = TableSetting(scale, args.repeats, pixels, args.device, store, args.truth)
    start = time.perf_counter()
    chosen = {table: table_plan.rows(table, setting, args.body) for table in args.table or TABLES}
    if not any(chosen.values()):
        raise InputError(f"--body {', '.join(args.body)}: in none of --table {', '.join(args.table)}")
    path = args.json or cache_folder() / "tables.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    record = records.begin(path, setting.key)
    found = machine(load_core().copy_bandwidth(args.device))
    with Console(stderr=True).status("tables") as status:

        def tell(text: str) -> None:
            status.update(f"{text} ({(time.perf_counter() - start) / 60:.0f} min)")

        for table, rows in chosen.items():
            if rows:
                records.fill(path, record, table, rows, found, tell)
    return record
