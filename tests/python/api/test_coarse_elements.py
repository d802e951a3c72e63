"""Bodies whose elements are many mean free paths deep, by the default solve."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import quadgraph
from baked import write_levels
from quadgraph.mesh.surface import Surface
from shapes import icosphere

RADIUS, SUN = 40.0, "directional:0,0,-1:1"


@pytest.fixture(scope="module")
def body(tmp_path_factory) -> Path:
    levels = [icosphere(4, RADIUS), icosphere(3, RADIUS)]
    return write_levels(tmp_path_factory.mktemp("coarse") / "ball.qgraph", levels)


@pytest.fixture
def engine(body) -> Iterator[quadgraph.Engine]:
    with quadgraph.Engine(body, device="cpu") as made:
        yield made


def returned(engine: quadgraph.Engine) -> float:
    """Scattered light that leaves, as a share of what enters."""
    surface = engine.surface()
    return float(surface.area @ surface.exitance[:, 0] / (surface.area @ surface.q[:, 0]))


def medium(albedo: float, extinction: float) -> str:
    return f"sigma_s_prime={extinction * albedo:g},sigma_a={extinction * (1 - albedo):g},eta=1"


@pytest.mark.parametrize("albedo", [0.6, 0.8, 0.95])
@pytest.mark.parametrize("light", ["ambient:1", SUN])
def test_a_body_that_absorbs_much_returns_what_a_half_space_does(engine, albedo, light):
    """Even light, and a beam that meets all angles of a ball evenly, of which isotropic scattering returns what Hulst's
    approximation says (1980, within .1%). The radius is 70 mean free paths; sweeps of linear elements that are 8 deep
    see a tenth to a third less.
    """
    engine.material, engine.lights = medium(albedo, 1.8), [light]
    engine.solve()
    s = np.sqrt(1 - albedo)
    assert returned(engine) == pytest.approx((1 - s) * (1 - 0.139 * s) / (1 + 1.17 * s), rel=0.07)


def lumps(subdivisions: int) -> Surface:
    """A sphere with hollows, whose terminator winds."""
    sphere = icosphere(subdivisions)
    x, y, z = sphere.vertices.T
    waves = 0.25 * np.sin(4 * x) * np.cos(5 * y + 1) * np.sin(3 * z + 0.5) + 0.15 * np.sin(7 * y) * np.cos(6 * z)
    return Surface(RADIUS * sphere.vertices * (1 + waves)[:, None], sphere.triangles)


def test_sweeps_go_on_while_they_settle_slowly(tmp_path):
    """The first one changes the unlit side by 6%, of which an eighth would be left in elements that resolve the light;
    in those of 6 mean free paths more is, and the second one finds it.
    """
    path = write_levels(tmp_path / "lumps.qgraph", [lumps(4), lumps(3)])
    with quadgraph.Engine(path, device="cpu") as engine:
        engine.material, engine.lights = medium(0.9995, 1.35), [SUN]
        solution = engine.solve()
    first, second = solution.correction.sweeps[:2]
    assert 0.13 * first.change.unlit < 0.016
    assert second.change.unlit > 0.05 * first.change.unlit


@pytest.mark.long
def test_the_error_that_is_stated_is_that_of_means_over_patches(engine):
    """Samples of another seed change them by about the noise that the model's error has, not by that of vertices."""
    engine.material, engine.lights = medium(0.999, 1.0), ["ambient:1"]
    found = []
    for seed in range(4):
        solution = engine.solve(sweeps=3, sweep_seed=seed + 1)
        surface = engine.surface()
        patch = np.floor((surface.position / RADIUS + 1) * 3).astype(int) @ (1, 6, 36)  # cells of a third of the radius
        patch = np.unique(patch, return_inverse=True)[1]
        area = np.bincount(patch, surface.area)
        found.append(np.bincount(patch, surface.area * surface.exitance[:, 0]) / area)
    spread = np.sqrt((np.var(found, axis=0, ddof=1) @ area) / (np.mean(found, axis=0) ** 2 @ area))
    assert solution.model_error.whole > 0.7 * spread
    assert solution.model_error.whole < solution.correction.sweeps[-1].noise.whole
