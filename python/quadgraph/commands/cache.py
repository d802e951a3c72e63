"""`quadgraph cache`: the bodies that `render`, `solve` and `view` have baked by themselves."""

from __future__ import annotations

import argparse
import time

from rich.console import Console
from rich.table import Table


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser("cache", help="bodies that were baked by themselves", description=__doc__)
    parser.add_argument(
        "what",
        choices=("list", "clear"),
        nargs="?",
        default="list",
        help="list: what is kept, the last used first (default); clear: remove all of it",
    )


def run(args: argparse.Namespace) -> int:
    """List or clear; 0."""
    from quadgraph.baking import kept

    console = Console(highlight=False, soft_wrap=True)
    found = kept.clear() if args.what == "clear" else kept.bodies()
    total = sum(each.size for each in found)
    if args.what == "list" and found:
        table = Table("body", "MB", "used last")
        for each in found:
            used = time.strftime("%Y-%m-%d %H:%M", time.localtime(each.used))
            table.add_row(str(each.path.relative_to(kept.folder())), f"{each.size / 1e6:.1f}", used)
        console.print(table)
    kept_or_gone = "removed from" if args.what == "clear" else f"of at most {kept.MOST_BYTES / 1e9:g} GB in"
    count = f"{len(found)} {'body' if len(found) == 1 else 'bodies'}"
    console.print(f"{count}, {total / 1e6:.1f} MB {kept_or_gone} {kept.folder()}", markup=False)
    return 0
