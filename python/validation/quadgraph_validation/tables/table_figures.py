"""The figures as PNG, from a record alone; the same record gives the same bytes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from quadgraph.base import atomic_file
from quadgraph_validation.base.pyplot import load_pyplot
from quadgraph_validation.chart import labels
from quadgraph_validation.tables import table_text
from quadgraph_validation.tables.table_ways import NAMES, TARGET

_COLOURS = dict(zip(NAMES, ("#c44e52", "#2ca02c", "#1f77b4", "#0b3c6f"), strict=True))
_PARTS = {"whole": "whole surface", "unlit": "unlit part"}
_LINES = {"published": "#c44e52", "ours": "#1f77b4"}  # of Figure 14
_DPI = 110
_KNOWN = 1e-4  # below, the exact solution that errors are of is not exact


def write(folder: Path, record: dict[str, Any]) -> list[Path]:
    """Draw tables-NAME.png for each table of the record that has something to draw. Raises InputError without
    matplotlib.
    """
    pyplot = load_pyplot("bench")
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for name, draw in {"1": _table_1, "12": _figure_12, "13": _figure_13, "14": _figure_14}.items():
        rows = list(record["tables"].get(name, {}).get("rows", {}).values())
        if not rows:
            continue
        rows = table_text.growth(record) if name == "12" else rows
        figure = draw(pyplot, rows)
        figure.suptitle(table_text.device_text(record, name).split("; ")[0], fontsize=9, color="#555555")
        written.append(folder / f"tables-{name}.png")
        with atomic_file.replacing(written[-1]) as stream:
            figure.savefig(stream, format="png", dpi=_DPI)
        pyplot.close(figure)
    return written


def _table_1(pyplot: Any, rows: list[dict[str, Any]]) -> Any:
    figure, axes = pyplot.subplots(1, 2, figsize=(11.5, 0.42 * len(rows) + 1.7), layout="constrained", sharey=True)
    for index, row in enumerate(rows):
        for way in NAMES:
            entry = table_text.done(row, way)
            if not entry:
                continue
            if entry.get("least"):
                axes[0].scatter(entry["least"]["work"], index, 60, color=_COLOURS[way], zorder=3)
            axes[1].scatter(entry["error"]["unlit"], index, 60, color=_COLOURS[way], zorder=3)
    axes[0].set_yticks(range(len(rows)), [f"{row['paper']} ({row['body']})" for row in rows])
    axes[0].set_ylim(len(rows) - 0.5, -0.5)
    axes[0].set_title(f"work to {100 * TARGET:g}%, applications of the finest operator", fontsize=10)
    axes[1].set_title("error of the unlit part that a frame leaves", fontsize=10)
    for axis in axes:
        axis.set_xscale("log")
        axis.grid(alpha=0.22)
    _plain(axes[0].xaxis, _number)
    _plain(axes[1].xaxis, _percent)
    _legend(
        pyplot,
        figure,
        {"published, with the paper's iterations" if w == NAMES[0] else w: c for w, c in _COLOURS.items()},
    )
    return _bare(figure)


def _figure_12(pyplot: Any, rows: list[dict[str, Any]]) -> Any:
    figure, axes = pyplot.subplots(1, 3, figsize=(14, 4.6), layout="constrained")
    tets = [row["nodes"][0]["inner"] / 1e3 for row in rows]
    panels = (
        (axes[0], NAMES[:1], "published, the paper's iterations: ms", lambda e: table_text.without_picture(e)),
        (axes[1], NAMES, f"ms to {100 * TARGET:g}%", lambda e: (e.get("least") or {}).get("ms")),
        (axes[2], NAMES, f"iterations to {100 * TARGET:g}%", lambda e: (e.get("least") or {}).get("iterations")),
    )
    named = []
    for axis, shown, title, value in panels:
        for way in shown:
            found = [value(entry) if (entry := table_text.done(row, way)) else None for row in rows]
            ends = _series(axis, rows, tets, found, _COLOURS[way])
            if way == NAMES[0]:
                named.append(ends)
        axis.set_title(title, fontsize=10)
        axis.set_xlabel("thousand tetrahedra")
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.margins(0.09)
        for side in (axis.xaxis, axis.yaxis):
            _plain(side, _number)
        axis.grid(alpha=0.22)
    _legend(pyplot, figure, _COLOURS)
    _bare(figure)
    figure.draw_without_rendering()
    for (axis, *_), ends in zip(panels, named, strict=True):
        labels.place(axis, [(*at, body, "#444444") for body, at in ends.items()])
    return figure


def _series(
    axis: Any, rows: list[dict], x: list[float], y: list[float | None], colour: str
) -> dict[str, tuple[float, float]]:
    """Points, those of a body of several sizes joined; the last one of every body."""
    by_body: dict[str, list[tuple[float, float]]] = {}
    for row, a, b in zip(rows, x, y, strict=True):
        if b is not None:
            by_body.setdefault(row["body"], []).append((a, b))
    for points in by_body.values():
        axis.plot(*zip(*points, strict=True), color=colour, linewidth=1.2)
        axis.scatter(*zip(*points, strict=True), color=colour, s=16, zorder=3)
    return {body: points[-1] for body, points in by_body.items()}


def _figure_13(pyplot: Any, rows: list[dict[str, Any]]) -> Any:
    figure, axes = pyplot.subplots(
        2, len(rows), figsize=(3.3 * len(rows) + 0.6, 6), layout="constrained", squeeze=False, sharex=True, sharey="row"
    )
    for column, row in enumerate(rows):
        for line, (part, words) in enumerate(_PARTS.items()):
            axis = axes[line][column]
            for way in NAMES:
                for what, style in (("picture", "-"), ("mesh", (0, (2, 2)))):
                    pairs = [(of["K"], of["errors"][way].get(what, {}).get(part)) for of in row["gradings"]]
                    pairs = [(k, error) for k, error in pairs if error is not None]
                    if pairs:
                        axis.plot(
                            *zip(*pairs, strict=True), color=_COLOURS[way], linestyle=style, marker="o", markersize=3.5
                        )
            axis.set_yscale("log")
            _plain(axis.yaxis, _percent)
            axis.set_title(f"{row['body']}, {words}", fontsize=10)
            axis.grid(alpha=0.22)
        axes[-1][column].set_xlabel("K")
    for axis in axes[:, 0]:
        axis.set_ylabel("relative RMS error")
    styles = {"picture, against path tracing": "-", "mesh: exitance, own equations": (0, (2, 2))}
    _legend(pyplot, figure, _COLOURS, styles)
    return _bare(figure)


def _figure_14(pyplot: Any, rows: list[dict[str, Any]]) -> Any:
    figure, axes = pyplot.subplots(
        2, len(rows), figsize=(5.6 * len(rows), 7), layout="constrained", squeeze=False, sharey=True
    )
    panels = {"work": "work: applications of the finest operator", "ms": "ms of the solve"}
    for line, (key, words) in enumerate(panels.items()):
        for axis, row in zip(axes[line], rows, strict=True):
            for name, curve in row["curves"].items():
                look = {"color": _LINES[name.split(",")[0]], "marker": "o", "markersize": 3}
                look["linestyle"] = "-" if name.endswith("with levels") else (0, (3, 2))
                axis.plot([p[key] for p in curve], [table_text.worst(p) for p in curve], **look)
            axis.set_xscale("log")
            axis.set_yscale("log")
            axis.set_ylim(_KNOWN, 1.5)
            _plain(axis.xaxis, _number)
            _plain(axis.yaxis, _percent)
            axis.set_title(f"{row['body']}, {row['nodes'][0]['inner']:,} tets", fontsize=10)
            axis.set_xlabel(words)
            axis.grid(alpha=0.22)
        axes[line][0].set_ylabel("error left, the larger of whole and unlit")
    colours = {"published": _LINES["published"], "ours, SP₃": _LINES["ours"]}
    _legend(pyplot, figure, colours, {"with levels": "-", "without": (0, (3, 2))})
    return _bare(figure)


def _legend(pyplot: Any, figure: Any, colours: dict[str, str], styles: dict[str, Any] | None = None) -> None:
    handles = [pyplot.Line2D([], [], color=c, marker="o", linestyle="", label=words) for words, c in colours.items()]
    handles += [pyplot.Line2D([], [], color="#444444", linestyle=s, label=words) for words, s in (styles or {}).items()]
    columns = len(handles) if not styles else 3
    figure.legend(handles=handles, loc="outside lower center", ncols=columns, fontsize=9, frameon=False)


def _number(x: float, _: int) -> str:
    return f"{x:g}"


def _percent(x: float, _: int) -> str:
    return f"{100 * x:g}%"


def _plain(axis: Any, words: Callable[[float, int], str]) -> None:
    """1, 2, 5 of every decade, or whole decades where there are many, in plain numbers."""
    from matplotlib.ticker import LogLocator, NullFormatter

    low, high = axis.get_view_interval()
    axis.set_major_locator(LogLocator(subs=(1, 2, 5) if high < 300 * low else (1,), numticks=12))
    axis.set_major_formatter(words)
    axis.set_minor_formatter(NullFormatter())


def _bare(figure: Any) -> Any:
    for axis in figure.axes:
        for side in ("top", "right"):
            axis.spines[side].set_visible(False)
    return figure
