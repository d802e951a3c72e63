"""The chart as one HTML page that needs nothing else: hover tells a point, the legend hides families."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from quadgraph.base import atomic_file
from quadgraph_validation.base import extra_module
from quadgraph_validation.chart import chart_record as records
from quadgraph_validation.chart.chart_record import KINDS, Panel

_HEIGHT = 430  # pixels of a panel
_SIZE = 13.0  # pixels, of the finest level's markers
_COARSER = 0.78  # of that per level
_TICKS = [step * 10.0**decade for decade in range(-6, 7) for step in (1, 2, 5)]


def load_plotly() -> Any:
    """Import plotly. Raises InputError if it is absent."""
    return extra_module.load("plotly.graph_objects", "chart")


def write(path: Path, record: dict[str, Any]) -> Path:
    """Write the page. The same record gives the same bytes. Raises InputError without plotly."""
    plotly = load_plotly()
    parts = [_HEADER]
    for number, scene in enumerate(record["scenes"]):
        figure = _figure(plotly, record, scene)
        parts.append(f"<h2>{scene['name']}</h2>\n<p>{_scene_text(scene)}</p>\n<p>{records.run_text(scene)}</p>")
        inline = {"include_plotlyjs": number == 0, "full_html": False, "div_id": f"chart-{scene['name']}"}
        parts.append(figure.to_html(config=_CONFIG, **inline))
        parts += [f"<p class='failed'>{p['name']}: {p['failed']}</p>" for p in scene["points"] if p.get("failed")]
    with atomic_file.replacing(path) as stream:
        stream.write(_PAGE.replace("BODY", "\n".join(parts)).encode())
    return path


_CONFIG = {"displaylogo": False, "responsive": True, "showTips": False}
_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>QuadGraph: speed against accuracy</title>
<link rel="icon" href="data:,">
<style>body{font:15px/1.45 sans-serif;max-width:1280px;margin:2em auto;padding:0 1em;color:#222}
h1{font-size:1.5em}h2{font-size:1.2em;margin:1.6em 0 .2em}p{margin:.3em 0}.failed{color:#a33}</style></head>
<body>
BODY
</body></html>
"""


_HEADER = (
    "<h1>Speed against accuracy</h1>\n<p>Milliseconds a frame (the light has moved a step: irradiance, source walk, "
    "warm solve, exitance, a picture; median) against the relative RMS error. The black steps join what nothing beats "
    "in both; grey: closer than the truth knows itself. Hover tells a point; a click on the legend hides a family, a "
    "double click all others. Times compare within a scene, which is measured in one run.</p>"
)


def _scene_text(scene: dict[str, Any]) -> str:
    sizes = " / ".join(f"{level['surface_vertices']:,}" for level in scene["levels"])
    others = [f"{_bake_name(bake)} {bake['levels'][0]['surface_vertices']:,}" for bake in scene["bakes"]]
    baked = f"; baked in other ways: {', '.join(others)}" if others else ""
    return (
        f"{scene['height_mm']:g} mm, η = {scene['eta']:g}, {scene['light']}; surface vertices by level: {sizes}{baked}"
    )


def _bake_name(bake: dict[str, Any]) -> str:
    return f"K = {bake['K']:g}" if bake["K"] is not None else {"default": "by default"}.get(bake["bake"], bake["bake"])


def _figure(plotly: Any, record: dict[str, Any], scene: dict[str, Any]) -> Any:
    from plotly.subplots import make_subplots

    panels = records.panels(scene)
    rows, columns = max(1, (len(panels) + 1) // 2), min(2, max(1, len(panels)))
    figure = make_subplots(
        rows, columns, subplot_titles=[panel.title for panel in panels], vertical_spacing=0.24 / rows
    )
    colours = records.colours(records.families(record))
    named: set[str] = set()
    for index, panel in enumerate(panels):
        where = {"row": index // 2 + 1, "col": index % 2 + 1}
        grey = {"fillcolor": "#000000", "opacity": 0.06, "line_width": 0, "layer": "below"}
        figure.add_hrect(y0=_TICKS[0], y1=panel.noise or _TICKS[0], **grey, **where)
        figure.add_trace(_front(plotly, panel, index == 0), **where)
        for family in dict.fromkeys(point["family"] for point in panel.points):
            figure.add_trace(_family(plotly, panel, family, colours[family], family not in named), **where)
            named.add(family)
        figure.update_xaxes(title_text=panel.time_words, **where)
    lines = {"type": "log", "showline": True, "linecolor": "#888"}
    figure.update_xaxes(tickvals=_TICKS, ticktext=[f"{t:g}" for t in _TICKS], **lines)
    figure.update_yaxes(tickvals=_TICKS, ticktext=[f"{100 * t:g}%" for t in _TICKS], **lines)
    margins = {"l": 60, "r": 20, "t": 40, "b": 40}
    return figure.update_layout(
        height=_HEIGHT * rows + 60, template="plotly_white", margin=margins, hovermode="closest"
    )


def _family(plotly: Any, panel: Panel, family: str, colour: str, in_legend: bool) -> Any:
    chosen = [i for i, point in enumerate(panel.points) if point["family"] == family]
    points = [panel.points[i] for i in chosen]
    beyond = [panel.stated[i] - panel.errors[i] for i in chosen]
    return plotly.Scatter(
        x=[panel.times[i] for i in chosen],
        y=[panel.errors[i] for i in chosen],
        error_y={"array": [max(b, 0.0) for b in beyond], "arrayminus": [max(-b, 0.0) for b in beyond], "width": 3}
        if any(beyond)
        else None,
        mode="markers",
        name=family,
        legendgroup=family,
        showlegend=in_legend,
        marker={
            "color": colour,
            "size": [_SIZE * _COARSER ** records.coarseness(point) for point in points],
            "symbol": [KINDS[records.kind(point)][1] for point in points],
            "line": {"width": [1.6 if i in panel.front else 0.5 for i in chosen], "color": "#222222"},
            "opacity": 0.9,
        },
        hovertext=[_hover(point, i in panel.front) for i, point in zip(chosen, points, strict=True)],
        hoverinfo="text",
    )


def _front(plotly: Any, panel: Panel, in_legend: bool) -> Any:
    return plotly.Scatter(
        x=[panel.times[i] for i in panel.front],
        y=[panel.errors[i] for i in panel.front],
        mode="lines",
        line={"color": "#222222", "width": 1.4, "shape": "hv"},
        name="Pareto front",
        legendgroup="front",
        showlegend=in_legend,
        hoverinfo="skip",
    )


def _hover(point: dict[str, Any], best: bool) -> str:
    low, high = point["ms_range"]
    lines = [f"<b>{point['name']}</b>", f"{point['ms']:.4g} ms ({low:.4g} to {high:.4g})"]
    lines.append(", ".join(f"{stage} {ms:.3g}" for stage, ms in point["stages"].items() if ms))
    for truth, words in (("pde", "PDE truth"), ("transport", "path tracing"), ("walks", "random walks")):
        if errors := records.errors_of(point, truth):
            lines.append(f"{words}: " + ", ".join(f"{name} {100 * error:.3g}%" for name, error in errors.items()))
    if (stated := records.stated(point)) is not None:
        views = point["stated"]["views"].items()
        solves = ", ".join(f"{view}: {told['solves']} solves of {told['sweeps']} sweeps" for view, told in views)
        lines.append(f"states {100 * stated:.3g}% of its pictures itself ({solves})")
    if flicker := records.flicker_text(point):
        lines.append(f"in motion: flicker {flicker}, frames behind light / camera {records.lag_text(point)}")
    lines.append(f"runs on: {point['settings']['runs_on']}")
    return "<br>".join(lines + (["best at its time"] if best else []))
