"""The engine's own estimate of its error against the true one: bodies, materials and lights of many kinds."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from quadgraph.baking.budget.surface_errors import PARTS
from quadgraph_validation.accuracy.judged_levels import Judged, LevelCase, judged
from quadgraph_validation.bodies import level_chains
from quadgraph_validation.bodies.level_chains import ChainSubject

FINER = (2, 1)  # of the two levels that are judged: the truth has sixteen, or four, times the vertices
CONFIDENCE = 0.95
# Options of a solve to a tolerance, and of one to an error that no level meets, which solves all to a quarter of it.
MODES: dict[str, dict[str, float]] = {"--tolerance": {}, "--error": {"error": 0.002}}

SUBJECTS = (
    ChainSubject("sphere", "sphere", 20),
    ChainSubject("torus", "torus", 10),
    ChainSubject("box", "box", 30),
    ChainSubject("lobes", "lobes", 60),
    ChainSubject("bunny", "bunny.ply", 80, 28000),
    ChainSubject("small bunny", "bunny.ply", 30, 28000),
    ChainSubject("armadillo", "armadillo.ply", 80, 28000),
    ChainSubject("fertility", "fertility.ply", 60),
    ChainSubject("igea", "igea.ply", 100, 28000),
    ChainSubject("spot", "spot.ply", 50),
    ChainSubject("twirl", "twirl.ply", 80),
    ChainSubject("fandisk", "fandisk.ply", 40),
    # Thin in mean free paths, where errors of 1% are within reach.
    ChainSubject("thin spot", "spot.ply", 6.25),
    ChainSubject("thin fertility", "fertility.ply", 7.5),
    ChainSubject("thin twirl", "twirl.ply", 10),
    ChainSubject("thin fandisk", "fandisk.ply", 5),
    ChainSubject("thin armadillo", "armadillo.ply", 10, 28000),
    ChainSubject("thin bunny", "bunny.ply", 10, 28000),
    ChainSubject("thin igea", "igea.ply", 6.25, 28000),
    ChainSubject("thin lobes", "lobes", 7.5),
)

CASES = (
    LevelCase("sphere", "marble", "sun", "diffusion"),
    LevelCase("sphere", "skin1", "sun"),
    LevelCase("sphere", "wholemilk", "sun and sky"),
    LevelCase("torus", "marble", "sun and sky", "sp3"),
    LevelCase("torus", "potato", "lamp"),
    LevelCase("torus", "marble-veins", "three"),
    LevelCase("box", "marble", "sun"),
    LevelCase("box", "skin1", "sun and sky"),
    LevelCase("box", "ketchup", "lamp"),
    LevelCase("lobes", "marble", "lamp"),
    LevelCase("lobes", "chicken2", "sun"),
    LevelCase("lobes", "marble-veins", "sun"),
    LevelCase("bunny", "marble", "sun", "diffusion"),
    LevelCase("bunny", "skin1", "sun and sky"),
    LevelCase("bunny", "marble-veins", "lamp"),
    LevelCase("bunny", "ketchup", "three"),
    LevelCase("small bunny", "marble", "sun and sky"),
    LevelCase("small bunny", "skin1", "sun"),
    LevelCase("small bunny", "apple", "lamp", "diffusion"),
    LevelCase("armadillo", "marble", "sun", "sp3"),
    LevelCase("armadillo", "skin2", "near lamp and sky"),
    LevelCase("armadillo", "ketchup", "sun"),
    LevelCase("fertility", "marble", "lamp", "sp3"),
    LevelCase("fertility", "wholemilk", "sun and sky"),
    LevelCase("fertility", "skin1", "three"),
    LevelCase("igea", "skin1", "sun"),
    LevelCase("igea", "marble", "near lamp and sky"),
    LevelCase("igea", "chicken1", "sun and sky"),
    LevelCase("spot", "skimmilk", "sun"),
    LevelCase("spot", "ketchup", "lamp"),
    LevelCase("spot", "marble-veins", "sun and sky"),
    LevelCase("twirl", "skin2", "sun"),
    LevelCase("twirl", "marble", "sun and sky", "diffusion"),
    LevelCase("fandisk", "marble", "sun"),
    LevelCase("fandisk", "potato", "three"),
    LevelCase("thin spot", "skin1", "sun"),
    LevelCase("thin spot", "ketchup", "sun and sky"),
    LevelCase("thin fertility", "ketchup", "sun"),
    LevelCase("thin fertility", "skin2", "lamp"),
    LevelCase("thin twirl", "ketchup", "sun"),
    LevelCase("thin twirl", "skin1", "lamp"),
    LevelCase("thin fandisk", "potato", "sun"),
    LevelCase("thin fandisk", "skin1", "lamp"),
    LevelCase("thin armadillo", "skin1", "lamp"),
    LevelCase("thin armadillo", "ketchup", "near lamp and sky"),
    LevelCase("thin bunny", "skin1", "sun"),
    LevelCase("thin bunny", "potato", "lamp"),
    LevelCase("thin igea", "skin1", "lamp"),
    LevelCase("thin igea", "ketchup", "sun"),
    LevelCase("thin lobes", "skin1", "sun and sky"),
    LevelCase("thin lobes", "ketchup", "lamp"),
)


def judge(body: Judged, case: LevelCase) -> list[dict[str, Any]]:
    """A row per level and mode: the engine's estimate of its error and the true one, by part."""
    body.light(case)
    return [_row(body, case, finer, mode) for finer in FINER for mode in MODES]


def _row(body: Judged, case: LevelCase, finer: int, mode: str) -> dict[str, Any]:
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
    return record_of(rows)


def record_of(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """The record of a run with these rows."""
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
            ratios = (f"{found[key]:.2f}" for key in extremes)
            summary.add_row(mode, part, str(found["count"]), f"{found['within_2']:.0%}", *ratios)
    return [cases, summary]


def _cells(row: dict[str, Any], part: str) -> list[str]:
    if part not in row["true"]:
        return ["", "", ""]
    estimate, true = row["estimate"][part], row["true"][part]
    return [f"{estimate:.2%}", f"{true:.2%}", f"{estimate / true:.2f}"]
