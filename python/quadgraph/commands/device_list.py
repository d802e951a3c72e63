"""`quadgraph devices`: every device that is found, what it lacks, and which one is taken and why.

The exit code is 0 where a picture can be made on the one that is taken, else 1.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict

from rich.console import Console

from quadgraph.commands import doctor


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser("devices", help="what can be computed on, and what is taken", description=__doc__)
    parser.add_argument("--json", action="store_true", help="print it as JSON on standard output")


def run(args: argparse.Namespace) -> int:
    """Look at the devices, and make a picture on the one that is taken; 1 if none can be made."""
    from quadgraph.commands import doctor_checks

    found = list(doctor_checks.devices())
    works = all(check.ok or not check.needed for check in found)
    if args.json:
        made = doctor_checks.tried("picture")
        taken = {name: made.get(name) for name in ("device", "driver")}
        vulkan = doctor_checks.tried("devices")
        print(json.dumps({"works": works} | taken | vulkan | {"checks": [asdict(each) for each in found]}, indent=1))
        return 0 if works else 1
    console = Console(highlight=False, soft_wrap=True)
    for check in found:
        doctor.show(console, check)
    return 0 if works else 1
