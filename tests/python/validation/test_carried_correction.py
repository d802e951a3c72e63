"""Frames without a correction that carry on what the last one found, beside corrected solves of the same light."""

from __future__ import annotations

import numpy as np
import pytest

import quadgraph
from baked import write_levels
from shapes import icosphere

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

THIN = quadgraph.Material((0.3, 0.4, 0.5), (0.1, 0.05, 0.02), 1.4)  # a ball of some five mean free paths
DENSER = quadgraph.Material((0.9, 1.2, 1.5), (0.3, 0.15, 0.06), 1.4)
STEP = 3.0  # degrees a frame


def sun(degrees: float) -> quadgraph.DirectionalLight:
    angle = np.radians(degrees)
    return quadgraph.DirectionalLight((np.sin(angle), 0.0, -np.cos(angle)), 1.0)


@pytest.fixture(scope="module")
def engine(tmp_path_factory):
    path = write_levels(tmp_path_factory.mktemp("ball") / "ball.qgraph", [icosphere(3, 6), icosphere(2, 6)])
    with quadgraph.Engine(path, device="cpu") as found:
        yield found


def off(found: np.ndarray, true: np.ndarray, area: np.ndarray) -> float:
    """Relative RMS over faces."""
    return np.sqrt((area @ (found - true) ** 2).sum() / (area @ true**2).sum())


def settled(engine, degrees: float, *, correction: bool = True) -> np.ndarray:
    engine.lights = [sun(degrees)]
    engine.solve(correction=correction, inter_reflection=False)
    return engine.surface().exitance.astype(float)


def frames(engine, degrees: float) -> tuple[np.ndarray, quadgraph.Solution]:
    """From a corrected solve until the light has turned so far."""
    engine.material = THIN
    settled(engine, 0)
    for k in range(1, round(degrees / STEP) + 1):
        engine.lights = [sun(k * STEP)]
        solution = engine.solve(motion=True, correction=False, carry=True, inter_reflection=False)
    return engine.surface().exitance.astype(float), solution


@pytest.mark.parametrize(("degrees", "share"), [(3, 0.15), (30, 0.4), (90, 1.0)])
def test_it_is_nearer_than_no_correction_and_its_error_says_how_near(engine, degrees, share):
    carried, solution = frames(engine, degrees)
    plain, true = settled(engine, degrees, correction=False), settled(engine, degrees)
    area = engine.surface().area
    uncorrected, left = off(plain, true, area), off(carried, true, area)
    assert uncorrected > 0.05
    assert left < share * uncorrected
    assert 0 < solution.carried < 1
    assert solution.correction is None
    assert solution.error.whole >= solution.model_error.whole > 0
    assert solution.error.whole > 0.5 * left


def test_it_fades_where_the_light_comes_from_the_other_side(engine):
    engine.material = THIN
    settled(engine, 0)
    engine.lights = [sun(180)]
    for _ in range(12):
        solution = engine.solve(motion=True, correction=False, carry=True, inter_reflection=False)
    carried = engine.surface().exitance.astype(float)
    plain, true = settled(engine, 180, correction=False), settled(engine, 180)
    area = engine.surface().area
    assert solution.carried < 0.1
    assert off(carried, true, area) < 1.1 * off(plain, true, area)


def test_it_fades_where_the_material_is_another(engine):
    engine.material = THIN
    settled(engine, 0)
    engine.material = DENSER
    solution = engine.solve(motion=True, correction=False, carry=True, inter_reflection=False)
    assert solution.carried == 0


def test_it_is_of_the_same_model_and_is_asked_for(engine):
    engine.material = THIN
    settled(engine, 0)
    quick = {"motion": True, "correction": False, "inter_reflection": False}
    assert engine.solve(**quick).carried is None
    assert engine.solve(**quick, carry=True, model="diffusion").carried is None
    assert engine.solve(**quick, carry=True).carried == pytest.approx(1, abs=1e-3)
