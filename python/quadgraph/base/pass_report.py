"""What the engine tells of its passes and of its memory, for people."""

from __future__ import annotations

from typing import Any

from rich.table import Table

# What lights and a picture need beyond the solution.
PICTURE_PURPOSES = ("display", "gather", "shadows")


def pass_table(passes: list[dict[str, Any]]) -> Table:
    """Return ms, dispatches, bytes and GB/s per pass, and the share of the copy bandwidth where it is known."""
    shares = all("copy_share" in entry for entry in passes)
    table = Table("pass", "ms", "dispatches", "MB", "GB/s", *(["of copying"] if shares else []), title="passes")
    for entry in passes:
        table.add_row(
            entry["name"],
            f"{entry['time_ms']:.3f}",
            str(entry["count"]),
            f"{entry['bytes'] / 1e6:.2f}",
            f"{bandwidth(entry):.2f}" if entry["bytes"] else "",
            *([f"{100 * entry['copy_share']:.0f}%"] if shares and entry["bytes"] else []),
        )
    table.add_row("all", f"{sum(entry['time_ms'] for entry in passes):.3f}", end_section=True)
    return table


def ms_by_pass(passes: list[dict[str, Any]]) -> dict[str, float]:
    """Milliseconds by pass; passes that a frame has more than once are summed."""
    total: dict[str, float] = {}
    for entry in passes:
        total[entry["name"]] = total.get(entry["name"], 0.0) + entry["time_ms"]
    return total


def bandwidth(entry: dict[str, Any]) -> float:
    """GB/s of a pass; 0 if it took no measurable time."""
    return entry["bytes"] / entry["time_ms"] * 1e-6 if entry["time_ms"] > 0 else 0.0
