"""Charts of error against work and against time, from a record of convergence.py."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from quadgraph.base import atomic_file
from quadgraph_validation.base.pyplot import load_pyplot

_COLOURS = {
    "fmg-pcg": "#1f77b4",
    "vcycle": "#17a2a2",
    "dpcg": "#8c6bb1",
    "cascade": "#e6953a",
    "jacobi": "#8a8a8a",
    "published": "#c44e52",
}
# What lies along x: key of a point, words under the axis.
_AXES = {
    "error-work.png": ("work", "work: applications of the finest operator"),
    "error-time.png": ("time_ms", "time of the solve on {device}, ms"),
}
_LOWEST = 3e-4  # of the axis of errors; errors below are not drawn


def write(folder: Path, record: dict[str, Any]) -> list[Path]:
    """Draw error-work.png and error-time.png into a folder, made if need be. Raises InputError without matplotlib."""
    pyplot = load_pyplot("bench")
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for name, (key, words) in _AXES.items():
        figure = pyplot.figure(figsize=(11, 4.4), layout="constrained")
        panels = figure.subplots(1, len(record["solvers"]), sharey=True, squeeze=False)[0]
        for panel, scene in zip(panels, record["solvers"], strict=True):
            _panel(panel, scene, key)
            panel.set_xlabel(words.format(device=_short(record["device"])))
        panels[0].set_ylabel("error of the unlit side")
        figure.legend(*panels[0].get_legend_handles_labels(), loc="outside right center", frameon=False)
        with atomic_file.replacing(folder / name) as stream:
            figure.savefig(stream, format="png", dpi=110)
        pyplot.close(figure)
        written.append(folder / name)
    return written


def _short(device: str) -> str:
    return device.split(" (")[0]


def _panel(axis: Any, scene: dict[str, Any], key: str) -> None:
    """One line per way."""
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_ylim(_LOWEST, 1)
    for target in (entry["unlit"] for entry in scene["ways"][0]["targets"]):
        axis.axhline(target, color="#444444", linewidth=0.7, linestyle=(0, (4, 4)))
    for way in scene["ways"]:
        points = [point for point in way["points"] if point["unlit"] >= _LOWEST] or way["points"][:1]
        x, y = [point[key] for point in points], [point["unlit"] for point in points]
        ours = way["name"] == scene["ways"][0]["name"]
        colour = _COLOURS.get(way["name"], "#222222")
        axis.plot(
            x,
            y,
            color=colour,
            linewidth=2.6 if ours else 1.4,
            marker="o",
            markersize=4 if ours else 2.5,
            label=way["name"],
        )
    axis.set_title(f"{scene['name']}, {scene['material']}", fontsize=10)
    axis.grid(alpha=0.25, which="major")
    axis.yaxis.set_major_formatter(lambda error, _: f"{100 * error:g}%")
    axis.xaxis.set_major_formatter(lambda x, _: f"{x:g}")
    for side in ("top", "right"):
        axis.spines[side].set_visible(False)
