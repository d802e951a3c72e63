"""Errors of coefficients and of relighting over time, of `quadgraph acquire` and of Mitsuba, in one chart."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from quadgraph.base import atomic_file
from quadgraph_validation.base.pyplot import load_pyplot

_LOOKS = (("#1f77b4", "s"), ("#c44e52", "o"), ("#e6953a", "^"), ("#55a868", "D"))  # of rows, in their order
_PANELS = (("sigma_a", "absorption"), ("sigma_s_prime", "reduced scattering"), ("relighting", "under another light"))
_TICKS = (0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0)
_TIMES = (1, 2, 5, 10, 20, 50, 100, 200, 500)


def write(path: Path, record: dict[str, Any]) -> None:
    """Draw a panel for each error. Raises InputError without matplotlib."""
    pyplot = load_pyplot("walks")
    figure = pyplot.figure(figsize=(12, 4.6), layout="constrained")
    for axis, (name, title) in zip(figure.subplots(1, 3), _PANELS, strict=True):
        _panel(axis, record["rows"], name)
        axis.set_title(title)
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels), frameon=False)
    path.parent.mkdir(parents=True, exist_ok=True)
    with atomic_file.replacing(path) as stream:
        figure.savefig(stream, format="png", dpi=90)
    pyplot.close(figure)


def _panel(axis: Any, rows: list[dict[str, Any]], name: str) -> None:
    for row, (colour, marker) in zip(rows, _LOOKS, strict=False):
        trace = row["trace"]
        times, errors = [each["processor_s"] for each in trace], [each[name] for each in trace]
        axis.plot(times, errors, color=colour, marker=marker, markersize=5, linewidth=1.3, label=row["name"])
    axis.set(xscale="log", yscale="log", xlabel="processor seconds", ylabel="off by, RMS")
    axis.set_yticks(_TICKS, [f"{100 * tick:g}%" for tick in _TICKS])
    axis.set_yticks([], minor=True)
    axis.set_xticks(_TIMES, [f"{time:g}" for time in _TIMES])
    axis.set_xticks([], minor=True)
    axis.grid(alpha=0.22)
    for side in ("top", "right"):
        axis.spines[side].set_visible(False)
