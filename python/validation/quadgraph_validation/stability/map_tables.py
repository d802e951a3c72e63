"""Tables for people: how many points of each class, and the worst of them."""

from __future__ import annotations

from typing import Any

from rich.table import Table

from quadgraph_validation.stability.error_classes import CLASSES


def all_of(record: dict[str, Any]) -> list[Table]:
    """The counts by map and method, and of all maps together."""
    table = Table("map", "method", *CLASSES, "largest error called accurate", title="points by class")
    for each in record["maps"]:
        for number, (method, rows) in enumerate(each["panels"].items()):
            counted = record["counts"][each["name"]][method]
            cells = (str(counted[name]) if counted[name] else "" for name in CLASSES)
            table.add_row("" if number else each["name"], method, *cells, _largest(rows))
        table.add_section()
    return [table]


def _largest(rows: list[list[dict[str, Any]]]) -> str:
    errors = [
        error
        for row in rows
        for point in row
        if point["class"] == CLASSES[0]
        for error in point["true"].values()
        if error is not None
    ]
    return f"{max(errors):.2g}" if errors else ""
