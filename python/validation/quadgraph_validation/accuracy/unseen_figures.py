"""Printed against true error of unseen cases, as a scatter plot."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from quadgraph.base import atomic_file
from quadgraph_validation.accuracy.unseen_tables import FACTOR
from quadgraph_validation.base.pyplot import load_pyplot

_COLOURS = ("#1f77b4", "#c44e52", "#e6953a", "#55a868", "#8172b3")  # of solves, in their order
_MARKERS = {"directional": "o", "point": "^", "rectangle": "s", "spot": "D", "environment": "*"}
_LEAST = 1e-3  # an error below it is drawn here
_TICKS = [digit * 10.0**power for power in (-3, -2, -1) for digit in (1, 2, 5)]


def write(path: Path, record: dict[str, Any]) -> None:
    """Draw a panel for the whole and one for the unlit part. Raises InputError without matplotlib."""
    pyplot = load_pyplot("walks")
    figure = pyplot.figure(figsize=(11, 6.2), layout="constrained")
    for axis, part in zip(figure.subplots(1, 2), ("whole", "unlit"), strict=True):
        _panel(axis, record["rows"], part)
    _legend(figure, record["rows"])
    path.parent.mkdir(parents=True, exist_ok=True)
    with atomic_file.replacing(path) as stream:
        figure.savefig(stream, format="png", dpi=90)
    pyplot.close(figure)


def _panel(axis: Any, rows: list[dict[str, Any]], part: str) -> None:
    shown = [0.01]
    for row in rows:
        for number, solve in enumerate(row["solves"]):
            if part not in solve["true"] or part not in solve["printed"]:
                continue
            true, printed = (max(solve[which][part], _LEAST) for which in ("true", "printed"))
            shown += [true, printed]
            told = row["noise"][part] < true
            look = {"marker": _MARKERS[_kind(row)], "s": 34, "linewidths": 1, "zorder": 3}
            colour = _COLOURS[number % len(_COLOURS)]
            axis.scatter(true, printed, edgecolors=colour, facecolors=colour if told else "none", **look)
    ends = [min(shown) / 1.3, max(shown) * 1.3]
    axis.plot(ends, ends, color="#222222", linewidth=1)
    axis.fill_between(ends, [e / FACTOR for e in ends], [e * FACTOR for e in ends], color="#000000", alpha=0.07)
    axis.set(xscale="log", yscale="log", xlim=ends, ylim=ends, aspect="equal", title=part)
    axis.set(xlabel="true error", ylabel="printed error")
    for one in (axis.xaxis, axis.yaxis):
        one.set_ticks(_TICKS, minor=False)
        one.set_ticks([], minor=True)
        one.set_major_formatter(lambda error, _: f"{100 * error:g}%")
    axis.set(xlim=ends, ylim=ends)
    axis.grid(alpha=0.22)
    for side in ("top", "right"):
        axis.spines[side].set_visible(False)


def _kind(row: dict[str, Any]) -> str:
    return row["light"].partition(":")[0]


def _legend(figure: Any, rows: list[dict[str, Any]]) -> None:
    from matplotlib.lines import Line2D

    def handle(words: str, **look: Any) -> Line2D:
        return Line2D([], [], linestyle="", label=words, markersize=7, **look)

    asked = [solve["sweeps"] for solve in rows[0]["solves"]]
    names = ["the default solve" if sweeps is None else f"{sweeps} sweeps" for sweeps in asked]
    handles = [handle(name, marker="o", color=_COLOURS[k % len(_COLOURS)]) for k, name in enumerate(names)]
    used = {_kind(row) for row in rows}
    handles += [handle(kind, marker=_MARKERS[kind], color="#444444") for kind in _MARKERS if kind in used]
    handles.append(handle("hollow: below the truth's noise", marker="o", color="#444444", fillstyle="none"))
    figure.legend(handles=handles, loc="outside lower center", ncols=5, fontsize=9, frameon=False)
