"""Balls of a medium that scatters forwards: the engine, with g and with the reduced coefficient, against walks."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from quadgraph.api.engine import Engine
from quadgraph.api.materials import Material
from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph_validation.accuracy import dense_study, similarity_study
from quadgraph_validation.bodies import unseen_bodies
from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.truth import monte_carlo

LIGHT = "directional:0,0,-1:1"
DETAIL, SHAKE_SEED = 4, 5
CASES = similarity_study.CASES
FORWARD = (-0.5, 0.5, 0.8, 0.9)  # g
WALKS = 400_000
SEED = 11
ZONES = similarity_study.ZONES


def run(device: str, _meshes: Path, _names: Sequence[str], walks: int = WALKS) -> dict[str, Any]:
    """Every ball of the study similarity, by the default bake and solve."""
    return record_of([row for case in CASES for row in rows_of(case, device, walks)], walks)


def record_of(rows: list[dict[str, Any]], walks: int = WALKS) -> dict[str, Any]:
    """The record of a run with these rows."""
    return {"walks": walks, "seed": SEED, "zones": ZONES, "light": LIGHT, "rows": rows}


def rows_of(case: tuple[float, float, float], device: str, walks: int = WALKS) -> list[dict[str, Any]]:
    """Of a ball, one for each g."""
    with tempfile.TemporaryDirectory(prefix="quadgraph-forward-") as folder:
        return _rows(*case, Path(folder), device, walks)


def _rows(radius: float, albedo: float, eta: float, folder: Path, device: str, walks: int) -> list[dict[str, Any]]:
    mesh, body = folder / f"{radius:g}-{albedo:g}.ply", folder / f"{radius:g}-{albedo:g}.qgraph"
    unseen_bodies.write(mesh, dense_study.surface_of(radius, DETAIL, SHAKE_SEED))
    bake(mesh, body, BakeOptions(unit="mm"))
    rows = []
    with Engine(body, device=device) as engine:
        engine.lights = [LIGHT]
        for g in FORWARD:
            full = Medium(albedo / (1 - g), 1 - albedo)
            truth, noise = similarity_study.exitance(full, radius, eta, g, walks, SEED)
            row: dict[str, Any] = {"radius": radius, "albedo": albedo, "eta": eta, "g": g}
            for which, known in (("reduced", 0.0), ("with_g", g)):
                engine.material = Material(albedo, 1 - albedo, eta, g=known)
                solution = engine.solve()
                found = _by_zone(engine, radius, eta)
                row[which] = {
                    name: similarity_study.apart(found[part], truth[part], noise[part])
                    for name, part in similarity_study.PARTS.items()
                }
            row["stated"] = [solution.error.whole, solution.error.unlit] if solution.error else None
            rows.append(row)
    return rows


def _by_zone(engine: Engine, radius: float, eta: float) -> np.ndarray:
    """All light that leaves, scattered or not, by zones of equal area, the unlit first: (ZONES,) of what entered."""
    field = engine.surface()
    height = field.position[:, 2] / np.linalg.norm(field.position, axis=1)
    zone = np.clip(((height + 1) / 2 * ZONES).astype(int), 0, ZONES - 1)
    leaving = field.area * (field.exitance + field.unscattered)[:, 0]
    mean = np.bincount(zone, leaving, ZONES) / np.bincount(zone, field.area, ZONES)
    return mean * (4 * np.pi * radius**2 / ZONES) / monte_carlo.entering_sphere(radius, eta)


def tables(record: dict[str, Any]) -> list[Table]:
    """One row per ball, two columns per g."""
    forward = sorted({row["g"] for row in record["rows"]})
    table = Table(
        *("radius, mean free paths", "albedo", "eta"),
        *(f"g {g:g}: {by}" for g in forward for by in ("reduced", "with g")),
        title="light that scatters forwards: exitance, error in %: whole / lit / unlit",
    )
    for ball, rows in similarity_study.by_ball(record["rows"]).items():
        cells = [
            " / ".join(f"{100 * row[by][part]['error']:.1f}" for part in similarity_study.PARTS)
            for row in rows
            for by in ("reduced", "with_g")
        ]
        table.add_row(*(f"{number:g}" for number in ball), *cells)
    return [table]
