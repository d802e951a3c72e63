"""The engine's own estimate of its error against the true one: bodies, materials and lights of many kinds."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from quadgraph.baking.budget.surface_errors import PARTS
from quadgraph_validation.accuracy.judged_levels import Case, Judged, judged
from quadgraph_validation.bodies import level_chains
from quadgraph_validation.bodies.level_chains import Subject

FINER = (2, 1)  # of the two levels that are judged: the truth has sixteen, or four, times the vertices
CONFIDENCE = 0.95
# Of a solve to a tolerance, and of one to an error, which brings every level to a quarter of it: none is good enough.
MODES: dict[str, dict[str, float]] = {"--tolerance": {}, "--error": {"error": 0.002}}

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
    # Thin in mean free paths, where errors of 1% are within reach.
    Subject("thin spot", "spot.ply", 6.25),
    Subject("thin fertility", "fertility.ply", 7.5),
    Subject("thin twirl", "twirl.ply", 10),
    Subject("thin fandisk", "fandisk.ply", 5),
    Subject("thin armadillo", "armadillo.ply", 10, 28000),
    Subject("thin bunny", "bunny.ply", 10, 28000),
    Subject("thin igea", "igea.ply", 6.25, 28000),
    Subject("thin lobes", "lobes", 7.5),
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
    Case("thin spot", "skin1", "sun"),
    Case("thin spot", "ketchup", "sun and sky"),
    Case("thin fertility", "ketchup", "sun"),
    Case("thin fertility", "skin2", "lamp"),
    Case("thin twirl", "ketchup", "sun"),
    Case("thin twirl", "skin1", "lamp"),
    Case("thin fandisk", "potato", "sun"),
    Case("thin fandisk", "skin1", "lamp"),
    Case("thin armadillo", "skin1", "lamp"),
    Case("thin armadillo", "ketchup", "near lamp and sky"),
    Case("thin bunny", "skin1", "sun"),
    Case("thin bunny", "potato", "lamp"),
    Case("thin igea", "skin1", "lamp"),
    Case("thin igea", "ketchup", "sun"),
    Case("thin lobes", "skin1", "sun and sky"),
    Case("thin lobes", "ketchup", "lamp"),
)


def judge(body: Judged, case: Case) -> list[dict[str, Any]]:
    """A row per level and mode: the engine's estimate of its error and the true one, by part."""
    body.light(case)
    return [_row(body, case, finer, mode) for finer in FINER for mode in MODES]


def _row(body: Judged, case: Case, finer: int, mode: str) -> dict[str, Any]:
    report = body.solve(finer, **MODES[mode])
    true = body.true_error(finer, report["finest"])
    return asdict(case) | {
        "mode": mode,
        "model": report["model"],
        "vertices": body.vertices_of(finer + report["finest"]),
        "work": report["work"],
        "estimate": {part: report["error"][part] for part in true},
        "true": true,
    }


def run(device: str, meshes: Path, names: list[str]) -> dict[str, Any]:
    """Judge all cases of the named subjects, of all if there are none. meshes: folder of the mesh files.

    Raises InputError for an unknown name or a mesh that cannot be read.
    """
    rows = judged(level_chains.chosen(SUBJECTS, names), CASES, meshes, lambda path: Judged(path, device, *FINER), judge)
    return {"rows": rows, "statistics": statistics(rows)}


def statistics(rows: list[dict[str, Any]]) -> dict[str, dict[str, dict[str, float]]]:
    """By mode and part, of the ratios of estimate to truth: their number, the share within a factor of 2, the extremes,
    the median, and `confidence`, the factor on the estimate that 95% of the truths do not exceed.

    "larger" is the larger one of both parts, which is what an error that is asked for bounds.
    """
    return {mode: found for mode in MODES if (found := _by_part([row for row in rows if row["mode"] == mode]))}


def _by_part(rows: list[dict[str, Any]]) -> dict[str, dict[str, float]]:
    result = {}
    for part in (*PARTS, "larger"):
        ratios = np.array([ratio for row in rows if (ratio := _ratio(row, part))])
        if len(ratios) == 0:
            continue
        result[part] = {
            "count": len(ratios),
            "within_2": float(np.mean((ratios >= 0.5) & (ratios <= 2))),
            "least": float(ratios.min()),
            "median": float(np.median(ratios)),
            "greatest": float(ratios.max()),
            "confidence": float(np.quantile(1 / ratios, CONFIDENCE)),
        }
    return result


def _ratio(row: dict[str, Any], part: str) -> float | None:
    """Estimate over truth; None if the row does not have the part."""
    estimate, true = row["estimate"], row["true"]
    if part == "larger":
        return max(estimate.values()) / max(true.values())
    return estimate[part] / true[part] if part in true else None


def tables(record: dict[str, Any]) -> list[Table]:
    """All cases, and the statistics."""
    columns = ("body", "vertices", "material", "light", "model", "mode")
    numbers = ("estimate", "true", "ratio", "estimate, unlit", "true, unlit", "ratio, unlit")
    cases = Table(*columns, *numbers, title="relative RMS error of M: the engine's estimate, and the truth")
    for row in record["rows"]:
        cells = [cell for part in PARTS for cell in _cells(row, part)]
        names = [row[key] for key in ("material", "light", "model", "mode")]
        cases.add_row(row["subject"], f"{row['vertices']:,}", *names, *cells)
    extremes = ("least", "median", "greatest", "confidence")
    heads = (*extremes[:-1], f"{CONFIDENCE:.0%} of truth over estimate")
    summary = Table("mode", "part", "cases", "within a factor of 2", *heads, title="estimate over truth")
    for mode, parts in record["statistics"].items():
        for part, found in parts.items():
            cells = (f"{found[key]:.2f}" for key in extremes)
            summary.add_row(mode, part, str(found["count"]), f"{found['within_2']:.0%}", *cells)
    return [cases, summary]


def _cells(row: dict[str, Any], part: str) -> list[str]:
    if part not in row["true"]:
        return ["", "", ""]
    estimate, true = row["estimate"][part], row["true"][part]
    return [f"{estimate:.2%}", f"{true:.2%}", f"{estimate / true:.2f}"]
