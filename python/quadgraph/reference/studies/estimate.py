"""The engine's own estimate of its error against the true one: bodies, materials and lights of many kinds."""

from __future__ import annotations

import tempfile
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from quadgraph.reference import chains
from quadgraph.reference.chains import Subject
from quadgraph.reference.judged import PARTS, Case, Judged

FINER = 2  # the truth has sixteen times the vertices

SUBJECTS = (
    Subject("sphere", "sphere", 20),
    Subject("torus", "torus", 10),
    Subject("box", "box", 30),
    Subject("lobes", "lobes", 60),
    Subject("bunny", "bunny.ply", 80, 28000),
    Subject("small bunny", "bunny.ply", 30, 28000),
    Subject("armadillo", "armadillo.ply", 80, 28000),
    Subject("fertility", "fertility.ply", 60),
    Subject("igea", "igea.ply", 100, 28000),
    Subject("spot", "spot.ply", 50),
    Subject("twirl", "twirl.ply", 80),
    Subject("fandisk", "fandisk.ply", 40),
)

CASES = (
    Case("sphere", "marble", "sun", "diffusion"),
    Case("sphere", "skin1", "sun"),
    Case("sphere", "wholemilk", "sun and sky"),
    Case("torus", "marble", "sun and sky", "sp3"),
    Case("torus", "potato", "lamp"),
    Case("torus", "marble-veins", "three"),
    Case("box", "marble", "sun"),
    Case("box", "skin1", "sun and sky"),
    Case("box", "ketchup", "lamp"),
    Case("lobes", "marble", "lamp"),
    Case("lobes", "chicken2", "sun"),
    Case("lobes", "marble-veins", "sun"),
    Case("bunny", "marble", "sun", "diffusion"),
    Case("bunny", "skin1", "sun and sky"),
    Case("bunny", "marble-veins", "lamp"),
    Case("bunny", "ketchup", "three"),
    Case("small bunny", "marble", "sun and sky"),
    Case("small bunny", "skin1", "sun"),
    Case("small bunny", "apple", "lamp", "diffusion"),
    Case("armadillo", "marble", "sun", "sp3"),
    Case("armadillo", "skin2", "near lamp and sky"),
    Case("armadillo", "ketchup", "sun"),
    Case("fertility", "marble", "lamp", "sp3"),
    Case("fertility", "wholemilk", "sun and sky"),
    Case("fertility", "skin1", "three"),
    Case("igea", "skin1", "sun"),
    Case("igea", "marble", "near lamp and sky"),
    Case("igea", "chicken1", "sun and sky"),
    Case("spot", "skimmilk", "sun"),
    Case("spot", "ketchup", "lamp"),
    Case("spot", "marble-veins", "sun and sky"),
    Case("twirl", "skin2", "sun"),
    Case("twirl", "marble", "sun and sky", "diffusion"),
    Case("fandisk", "marble", "sun"),
    Case("fandisk", "potato", "three"),
)


def judge(body: Judged, case: Case) -> dict[str, Any]:
    """One row: the engine's estimate of its error and the true one, by part."""
    body.light(case)
    report = body.solve()
    true = body.true_error()
    return asdict(case) | {
        "model": report["model"],
        "vertices": body.vertices,
        "estimate": {part: report["error"][part] for part in true},
        "true": true,
    }


def run(device: str, meshes: Path, names: list[str]) -> dict[str, Any]:
    """Judge all cases of the named subjects, of all if there are none. meshes: folder of the mesh files.

    Raises InputError for an unknown name or a mesh that cannot be read.
    """
    rows = []
    for subject in chains.chosen(SUBJECTS, names):
        with tempfile.TemporaryDirectory(prefix="quadgraph-study-") as folder:
            body = Judged(chains.baked(subject, meshes, Path(folder)), device, FINER)
            rows += [judge(body, case) for case in CASES if case.subject == subject.name]
    return {"rows": rows, "statistics": statistics(rows)}


def statistics(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Of the ratios of estimate to truth: their number, the share within a factor of 2, the extremes and the median."""
    result = {}
    for part in PARTS:
        ratios = np.array([row["estimate"][part] / row["true"][part] for row in rows if part in row["true"]])
        if len(ratios) == 0:
            continue
        result[part] = {
            "count": len(ratios),
            "within_2": float(np.mean((ratios >= 0.5) & (ratios <= 2))),
            "least": float(ratios.min()),
            "median": float(np.median(ratios)),
            "greatest": float(ratios.max()),
        }
    return result


def tables(record: dict[str, Any]) -> list[Table]:
    """All cases, and the statistics."""
    columns = ("body", "vertices", "material", "light", "model")
    numbers = ("estimate", "true", "ratio", "estimate, unlit", "true, unlit", "ratio, unlit")
    cases = Table(*columns, *numbers, title="relative RMS error of M: the engine's estimate, and the truth")
    for row in record["rows"]:
        cells = [cell for part in PARTS for cell in _cells(row, part)]
        cases.add_row(row["subject"], f"{row['vertices']:,}", row["material"], row["light"], row["model"], *cells)
    summary = Table("part", "cases", "within a factor of 2", "least", "median", "greatest", title="estimate over truth")
    for part, found in record["statistics"].items():
        extremes = (f"{found[key]:.2f}" for key in ("least", "median", "greatest"))
        summary.add_row(part, str(found["count"]), f"{found['within_2']:.0%}", *extremes)
    return [cases, summary]


def _cells(row: dict[str, Any], part: str) -> list[str]:
    if part not in row["true"]:
        return ["", "", ""]
    estimate, true = row["estimate"][part], row["true"][part]
    return [f"{estimate:.2%}", f"{true:.2%}", f"{estimate / true:.2f}"]
