"""The chart as PNG and SVG, from a record alone: one figure per scene, a panel per truth and part."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

from quadgraph.base import atomic_file
from quadgraph_validation.base.pyplot import load_pyplot
from quadgraph_validation.chart import chart_record as records
from quadgraph_validation.chart.chart_record import KINDS, Panel
from quadgraph_validation.chart.labels import place

_DPI = 110
_SIZE = 70.0  # points^2 of the finest level's markers
_COARSER = 0.55  # of that per level
_DECADES = (2000.0, 50_000.0)  # times as much at the end of an axis: more ticks would run together
_ROOM = 0.65  # of the width of all points, on the left
_MOST_LABELS = 9  # in a panel; of a longer front those are named that fall most below the one before
_ALONG = ("level", "K", "samples", "converge", "seconds")  # settings of which a line joins the values
_WORTH = 1.05  # times lower than the one before is what is named


def write(folder: Path, record: dict[str, Any]) -> list[Path]:
    """Draw chart-SCENE.png and chart-SCENE.svg of every scene into a folder. Raises InputError without matplotlib.

    The same record gives the same bytes.
    """
    pyplot = load_pyplot("chart")
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    with pyplot.rc_context({"svg.hashsalt": "quadgraph", "font.size": 10}):
        for scene in record["scenes"]:
            figure = _figure(pyplot, record, scene)
            for form, options in (("png", {"dpi": _DPI}), ("svg", {"metadata": {"Date": None}})):
                written.append(folder / f"chart-{scene['name']}.{form}")
                with atomic_file.replacing(written[-1]) as stream:
                    figure.savefig(stream, format=form, **options)
            pyplot.close(figure)
    return written


def _figure(pyplot: Any, record: dict[str, Any], scene: dict[str, Any]) -> Any:
    shown = records.panels(scene)
    rows = max(1, (len(shown) + 1) // 2)
    figure = pyplot.figure(figsize=(12.5, 4.2 * rows + 1.5), layout="constrained")
    axes = figure.subplots(rows, 2 if len(shown) > 1 else 1, squeeze=False).ravel()
    colours = records.colours(records.families(record))
    level = scene["levels"][0]
    size = f"{level['surface_vertices']:,} vertices on the finest of {len(scene['levels'])} levels"
    figure.suptitle(f"{scene['name']}: {size}; {records.device_text(scene)}", fontsize=11)
    for axis, panel in zip(axes, shown, strict=False):
        _panel(axis, panel, colours)
        axis.set_xlabel(panel.time_words)
    for axis in axes[len(shown) :]:
        axis.set_axis_off()
    _legend(figure, scene, colours)
    figure.canvas.draw()
    figure.set_layout_engine(None)  # labels are placed for this layout, and it takes most of the time of a drawing
    for axis, panel in zip(axes, shown, strict=False):
        place(axis, [_label(panel, index, colours) for index in _named(panel)])
    return figure


def _label(panel: Panel, index: int, colours: dict[str, str]) -> tuple[float, float, str, str]:
    point = panel.points[index]
    return panel.times[index], panel.errors[index], records.short(point), colours[point["family"]]


def _panel(axis: Any, panel: Panel, colours: dict[str, str]) -> None:
    axis.set_xscale("log")
    axis.set_yscale("log")
    for series in _series(panel):
        x, y = zip(*((panel.times[i], panel.errors[i]) for i in series), strict=True)
        axis.plot(x, y, color=colours[panel.points[series[0]]["family"]], linewidth=0.8, alpha=0.45, zorder=1)
    for index, (point, error) in enumerate(zip(panel.points, panel.errors, strict=True)):
        size = _SIZE * _COARSER ** records.coarseness(point)
        marker = KINDS[records.kind(point)][0]
        look = {"color": colours[point["family"]], "marker": marker, "linewidths": 1 if index in panel.front else 0.5}
        look["edgecolors"] = "#222222" if index in panel.front else "w"
        axis.scatter(panel.times[index], error, size, zorder=3, **look)
    _stated(axis, panel, colours)
    _front(axis, panel)
    if panel.noise > 0:
        axis.axhspan(axis.get_ylim()[0], panel.noise, color="#000000", alpha=0.06, linewidth=0, zorder=0)
    axis.set_title(panel.title, fontsize=10.5)
    axis.grid(alpha=0.22, which="major")
    _plain(axis.yaxis, lambda error, _: f"{100 * error:g}%")
    _plain(axis.xaxis, lambda x, _: f"{x:g}")
    for side in ("top", "right"):
        axis.spines[side].set_visible(False)


def _stated(axis: Any, panel: Panel, colours: dict[str, str]) -> None:
    """Bars from true errors to those that points state themselves."""
    for point, x, error, stated in zip(panel.points, panel.times, panel.errors, panel.stated, strict=True):
        if stated != error:
            look = {"color": colours[point["family"]], "linewidth": 1.0, "marker": "_", "markevery": [1], "zorder": 2}
            axis.plot([x, x], [error, stated], **look)


def _front(axis: Any, panel: Panel) -> None:
    """What is reached at each time, as steps to the edges of the panel, which has room for labels."""
    times, errors = panel.times, panel.errors
    room = max(3.5, (max(times) / min(times)) ** _ROOM)
    axis.set_xlim(min(times) / room, max(times) * 1.5)
    shown = [*errors, *panel.stated]
    axis.set_ylim(min([*shown, panel.noise or errors[0]]) / 1.8, max(shown) * 2)
    x, y = zip(*((times[i], errors[i]) for i in panel.front), strict=True)
    x, y = (x[0], *x, axis.get_xlim()[1]), (axis.get_ylim()[1], *y, y[-1])
    axis.plot(x, y, color="#222222", linewidth=1.4, drawstyle="steps-post", zorder=2)


def _series(panel: Panel) -> list[list[int]]:
    """Points that differ in one of _ALONG alone, at least two."""
    found: dict[tuple, list[int]] = {}
    for index, point in enumerate(panel.points):
        settings = point["settings"].items()
        key = tuple((name, value) for name, value in sorted(settings) if name not in _ALONG)
        found.setdefault((point["family"], *key), []).append(index)
    ordered = (sorted(series, key=lambda i: records.coarseness(panel.points[i])) for series in found.values())
    return [series for series in ordered if len(series) > 1]


def _named(panel: Panel) -> list[int]:
    """Points of the Pareto front that get a label."""
    drops = {panel.front[0]: float("inf")}
    for before, index in pairwise(panel.front):
        drops[index] = panel.errors[before] / panel.errors[index]
    worth = sorted((i for i in panel.front if drops[i] > _WORTH), key=lambda i: -drops[i])
    return sorted(worth[:_MOST_LABELS])


def _legend(figure: Any, scene: dict[str, Any], colours: dict[str, str]) -> None:
    from matplotlib.lines import Line2D

    def handle(colour: str, marker: str, words: str) -> Line2D:
        return Line2D([], [], color=colour, marker=marker, linestyle="", label=words, markersize=7)

    drawn = [point for point in scene["points"] if not point.get("failed")]
    handles = [handle(colours[name], "o", name) for name in dict.fromkeys(point["family"] for point in drawn)]
    used = {records.kind(point) for point in drawn}
    handles += [handle("#444444", marker, words) for kind, (marker, _, words) in KINDS.items() if kind in used]
    handles.append(Line2D([], [], color="#222222", linewidth=1.4, label="best at its time (Pareto front)"))
    handles.append(Line2D([], [], color="#000000", alpha=0.12, linewidth=7, label="below the truth's own noise"))
    figure.legend(handles=handles, loc="outside lower center", ncols=4, fontsize=9, frameon=False)


def _plain(axis: Any, text: Callable) -> None:
    """1, 2, 5 of every decade, of many 1 and 3, of more 1 alone, in plain numbers."""
    from matplotlib.ticker import LogLocator, NullFormatter

    low, high = axis.get_view_interval()
    subs = ((1, 2, 5), (1, 3), (1,))[sum(high >= decades * low for decades in _DECADES)]
    axis.set_major_locator(LogLocator(subs=subs, numticks=12))
    axis.set_major_formatter(text)
    axis.set_minor_formatter(NullFormatter())
