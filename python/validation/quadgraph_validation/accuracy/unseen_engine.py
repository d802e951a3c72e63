"""What the engine says of an unseen case: the default bake, and solves through the public API."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from quadgraph.api.engine import Engine
from quadgraph.api.fields import SurfaceField
from quadgraph.api.lights import EnvironmentLight, Light
from quadgraph.api.materials import Material, VolumeMaterial
from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph_validation.bodies import unseen_bodies
from quadgraph_validation.bodies.smooth_sky import SmoothSky
from quadgraph_validation.bodies.unseen_cases import UnseenCase, UnseenMedium


@dataclass(frozen=True, eq=False)
class UnseenAnswer:
    """Of one solve. sweeps: asked for, None for the engine's own choice; exitance (n,) W/mm^2 by patch; printed: the
    error that the engine states, by part, empty if none; seconds: of the solve on the clock.
    """

    sweeps: int | None
    exitance: np.ndarray
    printed: dict[str, float]
    model: str
    seconds: float


@dataclass(frozen=True, eq=False)
class UnseenAnswers:
    """tets: of the finest level; apart: mm by which the farthest face lies from the triangle that it is taken for."""

    tets: int
    apart: float
    answers: list[UnseenAnswer]


def answers(
    case: UnseenCase, patch: np.ndarray, sweeps: Sequence[int | None], folder: Path, device: str
) -> UnseenAnswers:
    """Bake the body into a folder and solve once for each of `sweeps`. patch (m,): of each triangle.

    Raises what bakes and solves raise.
    """
    mesh, file = folder / "body.ply", folder / "body.qgraph"
    unseen_bodies.write(mesh, case.surface)
    report = bake(mesh, file, BakeOptions(unit="mm"))
    with Engine(file, device=device) as engine:
        engine.material = _material(case.medium)
        engine.lights = [_light(case, folder)]
        engine.solve(**_options(0, case))  # whatever is made once is made now
        found = [_answer(engine, case, patch, wanted) for wanted in sweeps]
        apart = float(_triangle_of(case, engine.surface())[1].max())
    return UnseenAnswers(int(report.levels[0]["tets"]), apart, found)


def _options(sweeps: int | None, case: UnseenCase) -> dict[str, Any]:
    """Of `Engine.solve`: the defaults but for what was asked for."""
    asked = {} if sweeps is None else {"correction": sweeps > 0, "sweeps": sweeps}
    return asked if case.inter_reflection else asked | {"inter_reflection": False}


def _answer(engine: Engine, case: UnseenCase, patch: np.ndarray, sweeps: int | None) -> UnseenAnswer:
    start = time.perf_counter()
    solution = engine.solve(**_options(sweeps, case))
    seconds = time.perf_counter() - start
    field = engine.surface()
    of_face = patch[_triangle_of(case, field)[0]]
    power = np.bincount(of_face, field.area * field.exitance[:, 0], int(patch.max()) + 1)
    area = np.bincount(of_face, field.area, int(patch.max()) + 1)
    printed = {} if solution.error is None else {"whole": solution.error.whole, "unlit": solution.error.unlit}
    return UnseenAnswer(sweeps, power / area, printed, solution.model, seconds)


def _triangle_of(case: UnseenCase, field: SurfaceField) -> tuple[np.ndarray, np.ndarray]:
    """(n,) triangle of the body whose middle is nearest to each face's, and how far it is, mm."""
    distance, index = cKDTree(case.surface.corners.mean(axis=1)).query(field.position)
    return index, distance


def _light(case: UnseenCase, folder: Path) -> Light:
    if not isinstance(case.light, SmoothSky):
        return case.light
    case.light.write(folder / "sky.hdr")
    return EnvironmentLight(folder / "sky.hdr", 1.0)


def _material(medium: UnseenMedium) -> Material | VolumeMaterial:
    if medium.even:
        return Material(float(medium.sigma_s_prime[0, 0, 0]), float(medium.sigma_a[0, 0, 0]), medium.eta)
    return VolumeMaterial(medium.sigma_s_prime, medium.sigma_a, medium.spacing, medium.first, medium.eta)
