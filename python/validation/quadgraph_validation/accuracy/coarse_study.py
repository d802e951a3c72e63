"""How coarse may the mesh be: the slab of the slab study with ever fewer layers of elements."""

from __future__ import annotations

import itertools
from typing import Any

from rich.table import Table

from quadgraph_validation.accuracy import slab_study
from quadgraph_validation.bodies.media import media
from quadgraph_validation.truth.schemes import DIFFUSION, SP3, BodyOf
from quadgraph_validation.truth.slab_transport import discrete_ordinates

ETA = 1.3
LAYERS = (160, 20, 10, 5, 3)
CASES = tuple(itertools.product(LAYERS))
CELLS = (("marble", 0, DIFFUSION), ("marble", 0, SP3), ("skin1", 1, SP3))


def run(body_of: BodyOf) -> dict[str, Any]:
    """Relative errors of R and T against exact transport, collimated light, per number of layers."""
    return record_of([row for case in CASES for row in rows_of(case, body_of)])


def record_of(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """The record of a run with these rows."""
    return {"thickness_mm": slab_study.THICKNESS, "eta": ETA, "rows": rows}


def rows_of(case: tuple[int], body_of: BodyOf) -> list[dict[str, Any]]:
    """Of so many layers, a cell for each medium and scheme."""
    (layers,) = case
    body = slab_study.column(body_of, layers)
    cells = []
    for name, channel, scheme in CELLS:
        medium = media(name)[channel]
        truth = discrete_ordinates(medium, slab_study.THICKNESS, ETA, lambertian=False)
        found = slab_study.solved(body, media(name), ETA, False, scheme)[channel]
        cells.append(
            {
                "medium": f"{name} {'RGB'[channel]}",
                "scheme": scheme.name,
                "mean_free_paths": medium.sigma_t * slab_study.THICKNESS / layers,
                "errors": slab_study.relative_errors(found, truth),
            }
        )
    return [{"layers": layers, "cells": cells}]


def tables(record: dict[str, Any]) -> list[Table]:
    """One row per number of layers."""
    columns = (f"{cell['medium']}: {cell['scheme'].split(' / ')[-1]}" for cell in record["rows"][0]["cells"])
    table = Table("layers", "element / mean free path", *columns, title="coarse slabs: error of R, T in %")
    for row in record["rows"]:
        cells = row["cells"]
        table.add_row(
            str(row["layers"]),
            f"{cells[0]['mean_free_paths']:.2f} / {cells[-1]['mean_free_paths']:.2f}",
            *(f"{100 * cell['errors'][0]:+.2f} {100 * cell['errors'][1]:+.2f}" for cell in cells),
        )
    return [table]
