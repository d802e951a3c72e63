"""Heat maps of the suite: a panel per method, a cell per point, coloured by class, with the true error in it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from quadgraph.base import atomic_file
from quadgraph_validation.base.pyplot import load_pyplot
from quadgraph_validation.stability.error_classes import ACCURATE, CLASSES, HONEST, REFUSED, SILENT

COLOURS = {ACCURATE: "#a6d8a8", HONEST: "#fbe29a", REFUSED: "#c9ccd3", SILENT: "#e8786e"}
_CELL = (0.56, 0.36)  # inches
_ACROSS = 2  # panels side by side


def write(folder: Path, record: dict[str, Any]) -> list[Path]:
    """Draw stability-MAP.png for every map of a record. Raises InputError without matplotlib."""
    pyplot = load_pyplot("bench")
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for each in record["maps"]:
        path = folder / f"stability-{each['name']}.png"
        figure = _figure(pyplot, each)
        with atomic_file.replacing(path) as stream:
            figure.savefig(stream, format="png", dpi=100, pil_kwargs={"optimize": True})
        pyplot.close(figure)
        paths.append(path)
    return paths


def percent(error: float) -> str:
    """A relative error in %, in at most four characters; ~0 where it is below what a double tells from none."""
    value = 100 * error
    if value >= 1000:
        return ">999"
    if value >= 9.5:
        return f"{value:.0f}"
    if value >= 0.0095:
        return f"{value:.2g}"
    return f"{value:.0e}".replace("e-0", "e-") if value > 1e-12 else "~0"


def text_of(point: dict[str, Any]) -> str:
    """What stands in a cell: the larger of the errors over the whole surface and its unlit part, in %."""
    if "true" not in point:
        return "x"
    return percent(max(error for error in point["true"].values() if error is not None))


def _figure(pyplot: Any, each: dict[str, Any]) -> Any:
    panels = each["panels"]
    across = min(_ACROSS, len(panels))
    down = -(-len(panels) // across)
    columns, rows = len(each["x"]["values"]), len(each["y"]["values"])
    margin = 0.55 + 0.075 * max(len(text) for text in each["y"]["texts"])
    size = across * (columns * _CELL[0] + margin + 0.2), down * (rows * _CELL[1] + 0.75) + 0.7
    figure, axes = pyplot.subplots(
        down, across, figsize=(max(size[0], 6.6), size[1]), layout="constrained", squeeze=False
    )
    for axis in axes.flat[len(panels) :]:
        axis.set_axis_off()
    for number, (name, points) in enumerate(panels.items()):
        axis = axes.flat[number]
        _panel(axis, points)
        axis.set_title(name, fontsize=9)
        axis.set_xticks([i + 0.5 for i in range(columns)], each["x"]["texts"], fontsize=7.5)
        if number >= len(panels) - across:
            axis.set_xlabel(each["x"]["label"], fontsize=8.5)
        axis.set_yticks([j + 0.5 for j in range(rows)], each["y"]["texts"], fontsize=7.5)
    figure.supylabel(each["y"]["label"], fontsize=8.5)
    figure.suptitle(f"{each['title']}\nerror in % against {each['truth']}", fontsize=8.5)
    keys = [pyplot.Rectangle((0, 0), 1, 1, color=COLOURS[name]) for name in CLASSES]
    figure.legend(keys, CLASSES, loc="outside lower center", ncols=len(CLASSES), fontsize=8, frameon=False)
    return figure


def _panel(axis: Any, points: list[list[dict[str, Any]]]) -> None:
    from matplotlib.colors import ListedColormap

    colours = ListedColormap([COLOURS[name] for name in CLASSES])
    numbers = [[CLASSES.index(point["class"]) for point in row] for row in points]
    axis.pcolormesh(numbers, cmap=colours, vmin=-0.5, vmax=len(CLASSES) - 0.5, edgecolors="white", linewidth=1.5)
    axis.set(xlim=(0, len(points[0])), ylim=(0, len(points)))
    for j, row in enumerate(points):
        for i, point in enumerate(row):
            axis.text(i + 0.5, j + 0.5, text_of(point), ha="center", va="center", fontsize=7.5, color="#222222")
    axis.tick_params(length=0)
    for spine in axis.spines.values():
        spine.set_visible(False)
