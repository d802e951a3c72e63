"""The chart in words: every point with its time and errors, the best at its time marked."""

from __future__ import annotations

from typing import Any

from rich.table import Table

from quadgraph_validation.chart import chart_record as records

_COLUMNS = tuple((truth, part) for truth in records.TRUTHS for part in records.PARTS)
_WORDS = {"pde": "PDE", "transport": "transport", "walks": "walks"}


def all_of(record: dict[str, Any]) -> list[Table]:
    """One table per scene, by time."""
    return [_table(scene) for scene in record["scenes"]]


def _table(scene: dict[str, Any]) -> Table:
    errors = (f"{_WORDS[truth]}, {part}" for truth, part in _COLUMNS)
    moving = ("flicker", "frames behind light / camera")
    table = Table("method", "ms", "without picture", "solve", *errors, "stated", *moving)
    table.title = f"{scene['name']} on {records.device_text(scene)}; *: best at its time"
    table.columns[0].no_wrap = True
    best = {
        (panel.truth, panel.part): [panel.points[i]["name"] for i in panel.front] for panel in records.panels(scene)
    }
    done = [point for point in scene["points"] if not point.get("failed")]
    for point in sorted(done, key=lambda point: point["ms"]):
        cells = [_cell(point, column, best.get(column, [])) for column in _COLUMNS]
        table.add_row(point["name"], *(f"{ms:.3g}" for ms in _times(point)), *cells, _stated(point), *_in_motion(point))
    failed = [f"{point['name']}: {point['failed']}" for point in scene["points"] if point.get("failed")]
    table.caption = "\n".join(failed)
    return table


def _cell(point: dict[str, Any], column: tuple[str, str], best: list[str]) -> str:
    truth, part = column
    errors = records.errors_of(point, truth)
    if part not in errors:
        return ""
    return f"{100 * errors[part]:.3g}%" + ("*" if point["name"] in best else "")


def _stated(point: dict[str, Any]) -> str:
    stated = records.stated(point)
    return "" if stated is None else f"{100 * stated:.3g}%"


def _in_motion(point: dict[str, Any]) -> tuple[str, str]:
    return records.flicker_text(point), records.lag_text(point)


def _times(point: dict[str, Any]) -> tuple[float, float, float]:
    return point["ms"], records.without_picture(point), point["stages"]["solve"]
