"""Types of command-line arguments, and options that several subcommands have."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable

from quadgraph.base.units import UNITS_MM


def positive_float(text: str) -> float:
    """Argument type: a finite number above zero."""
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text}: must be a positive number")
    return value


def up_to(most: float) -> Callable[[str], float]:
    """Argument type: a number above zero and at most `most`."""

    def bounded(text: str) -> float:
        value = float(text)
        if not 0 < value <= most:
            raise argparse.ArgumentTypeError(f"{text[:40]}: must be above 0 and at most {most:g}")
        return value

    return bounded


def positive_int(text: str) -> int:
    """Argument type: an integer above zero."""
    value = int(text)
    if value <= 0:
        raise argparse.ArgumentTypeError(f"{text}: must be a positive integer")
    return value


def length_mm(text: str) -> float:
    """Argument type: a positive length with its unit, in mm."""
    found = re.fullmatch(r"\s*([0-9.eE+-]+)\s*(mm|cm|m)\s*", text)
    if not found:
        raise argparse.ArgumentTypeError(f"{text}: must be a number and mm, cm or m, like 100mm")
    return positive_float(found.group(1)) * UNITS_MM[found.group(2)]


def share(text: str) -> float:
    """Argument type: a share above 0 and below 1, as a number or in percent."""
    number = text.removesuffix("%")
    value = float(number) / (100 if number != text else 1)
    if not 0 < value < 1:
        raise argparse.ArgumentTypeError(f"{text}: must be above 0 and below 1 (or 100%)")
    return value


def add_strict_argument(parser: argparse.ArgumentParser | argparse._ArgumentGroup) -> None:
    """Add what makes of a missed error a failure."""
    parser.add_argument(
        "--strict", action="store_true", help="exit code 3 where --error is missed (default: a warning)"
    )


def add_device_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the choice of the device and Vulkan's validation layer."""
    parser.add_argument(
        "--device", default="", metavar="NAME", help="cpu, or part of a Vulkan device's name; default: a GPU, else cpu"
    )
    parser.add_argument(
        "--validation", action="store_true", help="load the validation layer of a Vulkan device, fail on any message"
    )
