"""Which rows the tables have, and how each is measured."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from quadgraph.base.errors import InputError
from quadgraph.base.progress import ProgressCallback
from quadgraph_validation.tables import grading, packing, published, table_bodies, table_convergence, table_ways
from quadgraph_validation.tables.table_bodies import BUNNY, DONUT, FERTILITY, TableSubject
from quadgraph_validation.tables.table_row import TableRow, TableSetting

# Surface nodes at scale 1 of the bodies that Figure 12 has several tetrahedralisations of.
GROWTH = {
    BUNNY: (32_000, 90_000, 280_000),
    DONUT: (32_000, 90_000, 280_000),
    FERTILITY: (32_000, 160_000),
}


def rows(table: str, setting: TableSetting, wanted: Sequence[str]) -> list[TableRow]:
    """Rows of a table on the bodies in `wanted`; on all bodies if it is empty."""
    made = {"1": _scenes, "12": _growth, "13": grading.rows, "14": table_convergence.rows, "packing": packing.rows}[
        table
    ]
    return [row for row in made(setting) if not wanted or row.body in wanted]


def names() -> list[str]:
    """Names of all bodies."""
    found = [subject.name for subject in (*table_bodies.TABLE_1, *GROWTH)] + list(grading.SCENES)
    return list(dict.fromkeys(found))


def check(wanted: Sequence[str]) -> None:
    """Raise InputError for a body that no table has."""
    for name in wanted:
        if name not in names():
            raise InputError(f"body '{name}': allowed are {', '.join(names())}")


def _missing(subject: TableSubject, setting: TableSetting) -> str:
    if subject.present(setting.store.meshes):
        return ""
    return f"{setting.store.meshes / subject.mesh}: no such file"


def _scenes(setting: TableSetting) -> Iterator[TableRow]:
    for subject in table_bodies.TABLE_1:
        paper = published.scene(subject.paper)
        faces = setting.nodes(1000 * paper.surface_nodes)
        yield _row(subject, faces, paper.iterations, setting, subject.name)


def _growth(setting: TableSetting) -> Iterator[TableRow]:
    for subject, sizes in GROWTH.items():
        iterations = published.scene(subject.paper).iterations if subject.paper else published.USUAL_ITERATIONS
        for size in sizes:
            faces = setting.nodes(size)
            yield _row(subject, faces, iterations, setting, f"{subject.name}-{faces}")


def _row(subject: TableSubject, faces: int, iterations: int, setting: TableSetting, key: str) -> TableRow:
    def measure(tell: ProgressCallback) -> dict[str, Any]:
        found = setting.store.body(subject, faces, tell)
        told = {"body": subject.name, "mesh": subject.mesh, "paper": subject.paper, "other": subject.other}
        measured = table_ways.measure(
            found.path, iterations, setting.repeats, setting.pixels, setting.device, lambda text: tell(f"{key}: {text}")
        )
        return told | found.report | {"published_iterations": iterations} | measured

    return TableRow(key, subject.name, _missing(subject, setting), measure)
