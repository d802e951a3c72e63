"""Whether a solve that was asked for an error has it: bodies that the benchmark does not use."""

from __future__ import annotations

import tempfile
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.table import Table

from quadgraph.reference import chains
from quadgraph.reference.chains import Subject
from quadgraph.reference.judged import PARTS, Case, Judged

FINER = 1  # the truth has four times the vertices: so few are left where errors of 1% are
ASKED = (0.05, 0.02, 0.01)  # relative RMS error of M

SUBJECTS = (
    Subject("spot", "spot.ply", 5),
    Subject("fertility", "fertility.ply", 8),
    Subject("igea", "igea.ply", 5, 28000),
    Subject("armadillo", "armadillo.ply", 8, 28000),
)
CASES = (
    Case("spot", "skin1", "sun and sky"),
    Case("fertility", "ketchup", "three"),
    Case("igea", "skin2", "sun"),
    Case("armadillo", "ketchup", "sun"),
)


def judge(body: Judged, case: Case, asked: float) -> dict[str, Any]:
    """One row: what was asked for, whether the engine says that it got there, and the true error by part."""
    report = body.solve(error=asked)
    estimate = {part: report["error"][part] for part in PARTS}
    return asdict(case) | {
        "model": report["model"],
        "asked": asked,
        "reached": max(estimate.values()) <= asked,
        "vertices": body.graph.levels[body.finer + report["finest"]].surface_vertex_count,
        "work": report["work"],
        "estimate": estimate,
        "true": body.true_error(report["finest"]),
    }


def run(device: str, meshes: Path, names: list[str]) -> dict[str, Any]:
    """Judge the named subjects, all if there are none. meshes: folder of the mesh files.

    Raises InputError for an unknown name or a mesh that cannot be read.
    """
    rows = []
    for subject in chains.chosen(SUBJECTS, names):
        with tempfile.TemporaryDirectory(prefix="quadgraph-study-") as folder:
            body = Judged(chains.baked(subject, meshes, Path(folder)), device, FINER)
            for case in CASES:
                if case.subject == subject.name:
                    body.light(case)
                    rows += [judge(body, case, asked) for asked in ASKED]
    return {"rows": rows}


def tables(record: dict[str, Any]) -> list[Table]:
    """One row per body and error asked for."""
    columns = ("body", "material", "light", "model", "asked", "reached", "vertices", "work")
    found = [(what, part) for what in ("estimate", "true") for part in PARTS]
    table = Table(*columns, *(", ".join(pair) for pair in found), title="--error")
    for row in record["rows"]:
        numbers = [f"{row[what][part]:.2%}" if part in row[what] else "" for what, part in found]
        names = [row[key] for key in ("subject", "material", "light", "model")]
        reached = "yes" if row["reached"] else "no"
        table.add_row(*names, f"{row['asked']:.0%}", reached, f"{row['vertices']:,}", f"{row['work']:.1f}", *numbers)
    return [table]
