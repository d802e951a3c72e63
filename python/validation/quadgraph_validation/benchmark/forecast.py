"""What a frame would take at least on a device of a given bandwidth: what its passes move, and what dispatches cost."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from typing import Any

from rich.table import Table

_GIVEN = "GB/S,US or GB/S,US,M"


@dataclass(frozen=True)
class FrameForecast:
    """gb_per_s: that the device moves; dispatch_us: microseconds of a dispatch with the barrier behind it;
    segments: millions of tets that rays cross a second, None for as many as the bandwidth lets.
    """

    gb_per_s: float
    dispatch_us: float
    segments: float | None = None

    def moving_ms(self, entry: dict[str, Any], crossed: float) -> float:
        """Milliseconds of a pass for what it moves, or for the tets that rays cross, whichever is more."""
        moved = entry["bytes"] / self.gb_per_s * 1e-6
        if self.segments is None or entry["name"] != "source walk":
            return float(moved)
        return float(max(moved, crossed / self.segments * 1e-3))

    def dispatching_ms(self, entry: dict[str, Any]) -> float:
        """Milliseconds of a pass for its dispatches."""
        return float(entry["count"] * self.dispatch_us * 1e-3)

    def of(self, kind: dict[str, Any]) -> dict[str, Any]:
        """Of all passes of a kind of frame, as the record has it."""
        moving = sum(self.moving_ms(entry, kind["walk_segments"]) for entry in kind["passes"])
        dispatching = sum(self.dispatching_ms(entry) for entry in kind["passes"])
        given = {"gb_per_s": self.gb_per_s, "dispatch_us": self.dispatch_us, "segments": self.segments}
        return given | {"moving_ms": moving, "dispatching_ms": dispatching, "ms": moving + dispatching}

    def table(self, kind: dict[str, Any]) -> Table:
        """A row for each pass, the longest first."""
        table = Table("pass", "dispatches", "MB", "moving, ms", "dispatches, ms", "ms")
        table.title = f"{kind['changes']} changing: at least"
        rate = "" if self.segments is None else f", {self.segments:g} million tets crossed a second"
        table.caption = f"at {self.gb_per_s:g} GB/s and {self.dispatch_us:g} µs a dispatch{rate}; nothing else counted"
        crossed = kind["walk_segments"]
        rows = [(entry, self.moving_ms(entry, crossed), self.dispatching_ms(entry)) for entry in kind["passes"]]
        for entry, moving, dispatching in sorted(rows, key=lambda row: -row[1] - row[2]):
            cells = (f"{ms:.3f}" for ms in (moving, dispatching, moving + dispatching))
            table.add_row(entry["name"], str(entry["count"]), f"{entry['bytes'] / 1e6:.1f}", *cells)
        whole = self.of(kind)
        table.add_row(
            "all",
            str(sum(entry["count"] for entry in kind["passes"])),
            f"{sum(entry['bytes'] for entry in kind['passes']) / 1e6:.1f}",
            *(f"{whole[name]:.3f}" for name in ("moving_ms", "dispatching_ms", "ms")),
        )
        return table


def parse(text: str) -> FrameForecast:
    """`GB/S,US[,M]`. Raises ArgumentTypeError."""
    parts = text.split(",")
    try:
        numbers = [float(part) for part in parts]
    except ValueError:
        numbers = []
    if len(numbers) not in (2, 3) or any(not 0 < number < 1e9 for number in numbers):
        raise argparse.ArgumentTypeError(f"{text!r}: allowed is {_GIVEN}, numbers above 0, as 272,3")
    return FrameForecast(*numbers)
