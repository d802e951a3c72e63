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
from quadgraph_validation.accuracy import unseen_motion
from quadgraph_validation.accuracy.unseen_motion import UnseenMotion
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
    """tets: of the finest level; apart: mm by which the farthest face lies from the triangle that it is taken for;
    motion: what frames in motion gave, None if they were not asked for.
    """

    tets: int
    apart: float
    answers: list[UnseenAnswer]
    motion: UnseenMotion | None


@dataclass(frozen=True)
class UnseenSetting:
    """sweeps: a solve for each, None for the engine's own choice; device: as Engine takes it; motion: in frames, too;
    carry: frames from one with sweeps to the next; for_material: bake for the case's own material.
    """

    sweeps: Sequence[int | None] = (None,)
    device: str = ""
    motion: bool = False
    carry: int = 1
    for_material: bool = False


def answers(case: UnseenCase, patch: np.ndarray, how: UnseenSetting, folder: Path) -> UnseenAnswers:
    """Bake the body into a folder, solve once for each of the sweeps, then in motion. patch (m,): of each triangle.

    Raises what bakes and solves raise, and InputError for a sky in motion.
    """
    mesh, file = folder / "body.ply", folder / "body.qgraph"
    unseen_bodies.write(mesh, case.surface)
    materials = (text_of(case.medium, folder),) if how.for_material else ()
    report = bake(mesh, file, BakeOptions(unit="mm", for_materials=materials))
    with Engine(file, device=how.device) as engine:
        engine.material = material_of(case.medium)
        engine.lights = [_light(case, folder)]
        engine.solve(**_options(0, case))  # whatever is made once is made now
        triangle, apart = _triangle_of(case, engine.surface())
        of_face = patch[triangle]
        found = [_answer(engine, of_face, wanted, _options(wanted, case)) for wanted in how.sweeps]
        frames = _moved(engine, case, of_face, how.carry) if how.motion else None
    return UnseenAnswers(int(report.levels[0]["tets"]), float(apart.max()), found, frames)


def _options(sweeps: int | None, case: UnseenCase) -> dict[str, Any]:
    """Of `Engine.solve`: the defaults but for what was asked for."""
    asked = {} if sweeps is None else {"correction": sweeps > 0, "sweeps": sweeps}
    return asked if case.inter_reflection else asked | {"inter_reflection": False}


def _answer(engine: Engine, of_face: np.ndarray, sweeps: int | None, options: dict[str, Any]) -> UnseenAnswer:
    start = time.perf_counter()
    solution = engine.solve(**options)
    seconds = time.perf_counter() - start
    printed = unseen_motion.stated(solution)
    return UnseenAnswer(sweeps, _by_patch(engine, of_face), printed, solution.model, seconds)


def _moved(engine: Engine, case: UnseenCase, of_face: np.ndarray, carry: int) -> UnseenMotion:
    shown: list[UnseenMedium] = []

    def show(medium: UnseenMedium, light: Light) -> None:
        if not shown or shown[-1] is not medium:  # a volume is read again each time that it is set
            engine.material = material_of(medium)
            shown[:] = [medium]
        engine.lights = [light]

    return unseen_motion.moved(engine, case, show, lambda: _by_patch(engine, of_face), _options(None, case), carry)


def _by_patch(engine: Engine, of_face: np.ndarray) -> np.ndarray:
    """(n,) W/mm^2 exitance of the last solution."""
    field = engine.surface()
    count = int(of_face.max()) + 1
    return np.bincount(of_face, field.area * field.exitance[:, 0], count) / np.bincount(of_face, field.area, count)


def _triangle_of(case: UnseenCase, field: SurfaceField) -> tuple[np.ndarray, np.ndarray]:
    """(n,) triangle of the body whose middle is nearest to each face's, and how far it is, mm."""
    distance, index = cKDTree(case.surface.corners.mean(axis=1)).query(field.position)
    return index, distance


def _light(case: UnseenCase, folder: Path) -> Light:
    if not isinstance(case.light, SmoothSky):
        return case.light
    case.light.write(folder / "sky.hdr")
    return EnvironmentLight(folder / "sky.hdr", 1.0)


def text_of(medium: UnseenMedium, folder: Path) -> str:
    """A medium's text, or the name of its file."""
    material = material_of(medium)
    if isinstance(material, Material):
        return material.text
    material.save(folder / "medium.npz")
    return str(folder / "medium.npz")


def material_of(medium: UnseenMedium) -> Material | VolumeMaterial:
    """A medium as engines take it."""
    if medium.even:
        return Material(float(medium.sigma_s_prime[0, 0, 0]), float(medium.sigma_a[0, 0, 0]), medium.eta)
    return VolumeMaterial(medium.sigma_s_prime, medium.sigma_a, medium.spacing, medium.first, medium.eta)
