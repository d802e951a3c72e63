"""The error of the light that is printed: none where nothing can be wrong, and what rays from every face find."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import quadgraph
from baked import write_levels
from quadgraph.api.lights import DirectionalLight, Light
from quadgraph.core import load_core
from quadgraph.mesh.surface import Surface
from quadgraph_validation.truth import face_light
from shapes import icosphere, join, moved

ETA = 1.3
SUN = DirectionalLight((0.2, 0.1, -1.0), 1.0)
MATERIAL = f"sigma_s_prime=1,sigma_a=0.02,eta={ETA}"
QUICK = {"correction": True, "sweeps": 1, "sweep_points": 2000}


def balls(detail: int) -> list[Surface]:
    """A ball of 10 mm, and a small one between it and the sun."""
    return [icosphere(detail, 10), moved(icosphere(detail - 1, 4), -2.5, -1.5, 17)]


@pytest.fixture(scope="module")
def shaded(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("balls") / "balls.qgraph"
    return write_levels(path, [join(*balls(3)), join(*balls(2))], rays=64)


def light_error(path: Path, *lights: Light | str, device: str = "", **options):
    with quadgraph.Engine(path, device=device) as engine:
        engine.material, engine.lights = MATERIAL, list(lights)
        return engine.solve(**(QUICK | options)).light_error


def test_nothing_is_wrong_where_no_part_hides_another(tmp_path):
    path = write_levels(tmp_path / "ball.qgraph", [icosphere(3, 10), icosphere(2, 10)])
    error = light_error(path, SUN)
    assert max(error.whole, error.unlit, error.dimmest) < 1e-3
    dark = light_error(path, DirectionalLight((0.0, 0.0, -1.0), 0.0))
    assert (dark.whole, dark.unlit, dark.dimmest) == (0, 0, 0)


def test_it_is_what_rays_from_every_face_find(shaded):
    engine = load_core().Engine(shaded)
    engine.set_material(MATERIAL)
    engine.set_lights([SUN.text])
    printed = engine.solve(**QUICK)["light_error"]["whole"]
    field = engine.surface_field()
    level = engine.graph.levels[0]
    faces = Surface(level.vertices.astype(np.float64), level.faces.astype(np.int64))
    truth = np.repeat(face_light.entering(faces, SUN, ETA, 400, seed=1)[:, None], 3, axis=1)

    def exitance(q: np.ndarray) -> np.ndarray:
        engine.set_irradiance(0, q.astype(np.float32))
        engine.solve(tolerance=1e-5, inter_reflection=False, solver="dpcg")
        return engine.surface_field()["exitance"].astype(np.float64)

    change = exitance(field["q"]) - exitance(truth)
    weight = field["area"][:, None]
    true = np.sqrt((weight * change**2).sum() / (weight * field["exitance"].astype(np.float64) ** 2).sum())
    assert true > 2e-4
    assert true / 2 < printed < 2 * true


def test_it_grows_as_the_texels_of_a_shadow_map_do(shaded, tmp_path):
    """A speck far away makes the map of the sun wider, and each of its texels."""
    specks = [moved(icosphere(1, 0.5), 0, 600, 0)]
    path = write_levels(tmp_path / "wide.qgraph", [join(*balls(3), *specks), join(*balls(2), *specks)], rays=64)
    assert light_error(path, SUN).whole > 1.5 * light_error(shaded, SUN).whole


def test_light_from_all_around_is_off_by_the_noise_of_its_rays(shaded):
    sampled, fewer = (light_error(shaded, "ambient:1", mean_rays=few) for few in (False, True))
    assert 0 < sampled.whole < 0.02
    assert fewer.whole > 1.3 * sampled.whole  # by a quarter of the rays


def test_it_is_known_of_what_is_corrected_at_rest_under_lights(shaded):
    assert light_error(shaded, SUN, correction=False, sweeps=0) is None
    with quadgraph.Engine(shaded) as engine:
        engine.material, engine.lights = MATERIAL, [SUN]
        first = engine.solve(**QUICK)
        assert first.light_error is not None
        again = engine.solve(**QUICK)
        assert again.light_error == first.light_error
        assert engine.solve(**QUICK, motion=True).light_error is None
