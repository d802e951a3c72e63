"""`quadgraph doctor`: what is installed, which device is taken, and what to do about what is missing.

The exit code is 0 where a mesh can be baked and rendered, else 1.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from typing import TYPE_CHECKING

from rich.console import Console
from rich.markup import escape

if TYPE_CHECKING:
    from quadgraph.commands.doctor_checks import Check


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser("doctor", help="what is installed and what is missing", description=__doc__)
    parser.add_argument("--json", action="store_true", help="print it as JSON on standard output")


def run(args: argparse.Namespace) -> int:
    """Look at everything and print it; 1 if what is needed is missing."""
    from quadgraph.commands import doctor_checks

    found = doctor_checks.checks()
    wanting = [check for check in found if check.needed and not check.ok]
    if args.json:
        made = doctor_checks.tried("picture")
        device = {name: made.get(name) for name in ("device", "driver")}
        print(json.dumps({"works": not wanting} | device | {"checks": [asdict(check) for check in found]}, indent=1))
        return 1 if wanting else 0
    console = Console(highlight=False, soft_wrap=True)
    for check in found:
        show(console, check)
    names = ", ".join(dict.fromkeys(check.name for check in wanting))
    console.print(f"baking and rendering do not work: {names}" if wanting else "baking and rendering work")
    return 1 if wanting else 0


def show(console: Console, check: Check) -> None:
    """Print a line, and one more if there is a cure."""
    state = "[green]ok[/]      " if check.ok else "[red]missing[/] " if check.needed else "[yellow]missing[/] "
    optional = "" if check.ok or check.needed else " (optional)"
    console.print(f"{state} {check.name:<16} {escape(check.found)}{optional}")
    if check.cure:
        console.print(f"{'':<26}cure: {escape(check.cure)}")
