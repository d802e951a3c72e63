"""The error of the light that the engine prints, beside that of its irradiance against rays from every face."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph.base.relative_error import relative_rms
from quadgraph.core import load_core
from quadgraph.mesh.patches import patches_of
from quadgraph.mesh.surface import Surface
from quadgraph_validation.accuracy.kept_rows import KeptRows, Row
from quadgraph_validation.bodies import unseen_bodies, unseen_cases
from quadgraph_validation.truth import face_light

VERTICES = 2500  # on the surface: faces of which many lie on an edge of a shadow
POINTS = 256  # of the truth, on each face
SWEEP = {"correction": True, "sweeps": 1, "sweep_points": 2000}  # the light is the same in the cheapest correction
TOLERANCE = 1e-5  # of the solves that carry both irradiances to the exitance
UNLIT = 0.1  # of the mean q: below it a face is unlit, as in the engine's report
PARTS = ("whole", "unlit", "dimmest")
FACTOR = 2  # within which the printed error is to agree with the true one
TOLD = 5e-4  # a true error below it is not judged: it is lost among those of mesh and model


@dataclass(frozen=True)
class LightRun:
    """seed: of the first body; count: of bodies; device: as Engine takes it."""

    seed: int
    count: int
    device: str = ""


def run(wanted: LightRun, kept: KeptRows | None = None) -> dict[str, Any]:
    """Judge all bodies, or what is not kept. Raises InputError, and what bakes and solves raise."""
    seeds = range(wanted.seed, wanted.seed + wanted.count)
    with tempfile.TemporaryDirectory(prefix="quadgraph-light-") as folder:
        cases = [(str(seed), partial(_row, seed, wanted.device, Path(folder))) for seed in seeds]
        return record_of(wanted, (kept or KeptRows()).complete(cases))


def record_of(wanted: LightRun, rows: list[Row]) -> dict[str, Any]:
    """The record of a run with these rows."""
    return {"seed": wanted.seed, "vertices": VERTICES, "rows": rows, "summary": summary(rows)}


def _row(seed: int, device: str, folder: Path) -> Row:
    surface = unseen_bodies.surface_of(seed)
    case = unseen_cases.drawn(seed, surface)
    unseen_bodies.write(folder / "body.ply", surface)
    bake(folder / "body.ply", folder / "body.qgraph", BakeOptions(unit="mm", surface_vertices=VERTICES))
    engine = load_core().Engine(folder / "body.qgraph", device=device)
    sigma_s_prime, sigma_a = (float(of.mean()) for of in (case.medium.sigma_s_prime, case.medium.sigma_a))
    engine.set_material(f"sigma_s_prime={sigma_s_prime},sigma_a={sigma_a},eta={case.medium.eta}")
    engine.set_lights([case.light.text])
    printed = engine.solve(**SWEEP)["light_error"]
    field = {name: np.asarray(values, np.float64) for name, values in engine.surface_field().items()}
    level = engine.graph.levels[0]
    faces = Surface(level.vertices.astype(np.float64), level.faces.astype(np.int64))
    truth = np.repeat(face_light.entering(faces, case.light, case.medium.eta, POINTS, seed)[:, None], 3, axis=1)
    change = _exitance(engine, field["q"]) - _exitance(engine, truth)
    return {
        "seed": seed,
        "light": case.light.text.partition(":")[0],
        "faces": len(level.faces),
        "irradiance": relative_rms(field["area"], field["q"] - truth, truth),
        "power": float(field["area"] @ field["q"][:, 0] / (field["area"] @ truth[:, 0]) - 1),
        "true": errors(field, change, patches_of(faces)),
        "printed": {name: printed[name] for name in PARTS},
    }


def _exitance(engine: Any, q: np.ndarray) -> np.ndarray:
    """(n, 3) W/mm^2 of an irradiance that enters from all sides: only a difference of two counts."""
    engine.set_irradiance(0, q.astype(np.float32))
    engine.solve(tolerance=TOLERANCE, inter_reflection=False, solver="dpcg")
    return np.asarray(engine.surface_field()["exitance"], np.float64)


def errors(field: dict[str, np.ndarray], change: np.ndarray, patch: np.ndarray) -> dict[str, float]:
    """Relative RMS of a change (n, 3) of the exitance by part, of means over patches (n,); 0 without faces."""
    area, exitance = field["area"], field["exitance"]
    order = np.argsort(exitance.sum(axis=1))
    dimmest = np.zeros(len(area), bool)
    dimmest[order[: 1 + np.searchsorted(np.cumsum(area[order]), area.sum() / 3)]] = True
    unlit = field["q"].sum(axis=1) < UNLIT * (area @ field["q"].sum(axis=1)) / area.sum()
    parts = zip(PARTS, (np.ones(len(area), bool), unlit, dimmest), strict=True)
    return {name: _by_patches(area * part, patch, change, exitance) for name, part in parts}


def _by_patches(area: np.ndarray, patch: np.ndarray, change: np.ndarray, exitance: np.ndarray) -> float:
    size = np.bincount(patch, area)
    if not size.any():
        return 0.0
    inside = size > 0
    means = (
        np.stack([np.bincount(patch, area * column) for column in of.T], axis=1)[inside] / size[inside, None]
        for of in (change, exitance)
    )
    return relative_rms(size[inside], *means)


def summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Printed over true errors by part, of those that are told: how many agree, the least and the greatest."""
    found = {}
    for part in PARTS:
        told = [row for row in rows if row["true"][part] > TOLD]
        ratios = [row["printed"][part] / row["true"][part] for row in told]
        within = [1 / FACTOR <= ratio <= FACTOR for ratio in ratios]
        found[part] = ratios and {
            "cases": len(ratios),
            "within": float(np.mean(within)),
            "least": min(ratios),
            "greatest": max(ratios),
        }
    return found


def tables(record: dict[str, Any]) -> list[Table]:
    """Each body's errors, and how those agree."""
    columns = ("seed", "light", "irradiance, faces", "power", "true: whole / unlit / dimmest", "printed")
    cases = Table(*columns, title="error of the light, %")
    for row in record["rows"]:
        of_light = (f"{100 * row['irradiance']:.2f}", f"{100 * row['power']:+.2f}")
        errors_of = (" / ".join(f"{100 * row[of][part]:.2f}" for part in PARTS) for of in ("true", "printed"))
        cases.add_row(str(row["seed"]), row["light"], *of_light, *errors_of)
    agree = Table("part", "cases", f"within a factor of {FACTOR}", "least", "greatest", title="printed over true")
    for part, found in record["summary"].items():
        if found:
            numbers = (f"{found['within']:.0%}", f"{found['least']:.2f}", f"{found['greatest']:.2f}")
            agree.add_row(part, str(found["cases"]), *numbers)
    return [cases, agree]
