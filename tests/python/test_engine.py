"""The GPU engine, driven as a user drives it from Python, against the CPU reference and physics."""

from __future__ import annotations

import numpy as np
import pytest

from baked import face_frames, write_levels
from shapes import icosphere

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

RADIUS = 10.0  # mm
MATERIAL = "sigma_s_prime=1.5/1.0/0.7,sigma_a=0.01/0.03/0.1,eta=1.3"


@pytest.fixture(scope="module")
def sphere_path(tmp_path_factory):
    """A sphere of two levels."""
    path = tmp_path_factory.mktemp("sphere") / "sphere.qgraph"
    return write_levels(path, [icosphere(4, RADIUS), icosphere(3, RADIUS)])


@pytest.fixture
def engine(sphere_path):
    """An engine under the validation layer; every message fails the test."""
    engine = _core.Engine(sphere_path, validation=True)
    yield engine
    assert engine.validation_messages == []


def lit_from_above(level) -> np.ndarray:
    """Clamped-cosine irradiance from +z, (n_f, 3) W/mm^2."""
    _, normal, _ = face_frames(level)
    return np.clip(normal[:, 2:], 0, None) * np.array([1.0, 0.8, 0.6])


@pytest.mark.parametrize("solver", ["dpcg", "cascade"])
@pytest.mark.parametrize("method", ["fem", "quadgraph-fv", "quadgraph-fdm"])
@pytest.mark.parametrize("material", [MATERIAL, "marble-veins,vein_period=6"])
def test_gpu_equals_cpu_reference(engine, method, solver, material):
    engine.set_material(material)
    levels = engine.graph.levels
    for number, level in enumerate(levels):
        engine.set_irradiance(number, lit_from_above(level))
    report = engine.solve(method=method, solver=solver, tolerance=1e-6, max_iterations=20000)
    sigma_s_prime, sigma_a = _core.evaluate_material(engine.graph, 0, _core.Material(material))
    eta = _core.Material(material).eta
    expected = _core.solve_reference(
        engine.graph, 0, sigma_s_prime, sigma_a, eta, lit_from_above(levels[0]), method=method, tolerance=1e-11
    )
    field = engine.surface_field()
    scale = np.abs(expected["exitance"]).max(axis=0)
    worst = np.abs((field["exitance"] - expected["exitance"]) / scale).max()
    print(f"{method} {solver}: worst difference {worst:.1e}, residual {report['levels'][-1]['residual']:.1e}")
    assert worst < 1e-4
    assert np.allclose(report["energy"]["absorbed"], expected["energy"]["absorbed"], rtol=1e-3)
    assert np.allclose(report["energy"]["entered"], expected["energy"]["entered"], rtol=1e-5)


def test_furnace_to_single_precision(engine):
    engine.set_material("sigma_s_prime=2/1/0.5,sigma_a=0,eta=1.3")
    for number, level in enumerate(engine.graph.levels):
        engine.set_irradiance(number, np.full((len(level.faces), 3), 0.7, np.float32))
    for method in ("fem", "quadgraph-fv", "quadgraph-fdm"):
        engine.solve(method=method, tolerance=1e-6)
        field = engine.surface_field()
        assert np.abs(field["exitance"] / 0.7 - 1).max() < 1e-4
        assert np.abs(field["phi"] * (1 - _core.internal_diffuse_reflectance(1.3)) / (4 * 0.7) - 1).max() < 1e-4


def test_fem_balances_energy_and_every_level_converges(engine):
    engine.set_material(MATERIAL)
    engine.set_lights(["directional:0,0,-1:2.0", "point:30,0,0:500"])
    report = engine.solve(tolerance=1e-5)
    assert all(level["converged"] for level in report["levels"])
    assert np.abs(report["energy"]["balance"]).max() < 1e-3
    assert min(report["energy"]["absorbed"]) > 0
    assert report["error"]["unlit"] > 0


def test_directional_light_brings_its_power_through_the_cross_section(engine):
    engine.set_material("sigma_s_prime=1,sigma_a=0.005,eta=1")
    engine.set_lights(["directional:0,0,-1:2.0/1.0/0.5"])
    engine.solve()
    field = engine.surface_field()
    power = (field["q"] * field["area"][:, None]).sum(axis=0)
    assert np.allclose(power, np.pi * RADIUS**2 * np.array([2.0, 1.0, 0.5]), rtol=0.01)
    unlit = field["position"][:, 2] < -0.5 * RADIUS
    assert (field["q"][unlit] == 0).all()
    assert (field["exitance"][unlit] > 0).all()


def test_brighter_light_scales_everything(engine):
    engine.set_material(MATERIAL)
    engine.set_lights(["directional:0,0,-1:1.0"])
    engine.solve(tolerance=1e-5)
    once = engine.surface_field()["exitance"].copy()
    engine.set_lights(["directional:0,0,-1:1e6"])
    engine.solve(tolerance=1e-5)
    assert np.allclose(engine.surface_field()["exitance"] * 1e-6, once, rtol=2e-3, atol=1e-5 * once.max())


def test_picture_is_an_array_whose_layers_are_physical(engine):
    engine.set_material(MATERIAL)
    engine.set_lights(["directional:0.3,-0.2,-1:1.0"])
    engine.solve()
    picture = engine.render(view="0,0", width=96, height=64)
    assert picture.diffuse.shape == picture.specular.shape == (64, 96, 3)
    assert picture.alpha.shape == (64, 96)
    covered = picture.alpha > 0.5
    assert 0.1 < covered.mean() < 0.9
    assert picture.diffuse[covered].max() > 0
    assert picture.diffuse[~(picture.alpha > 0)].max() == 0
    assert picture.srgb().shape == (64, 96, 3)


def test_unusable_input_is_named(engine, sphere_path):
    with pytest.raises(Exception, match="sigma_s_prime") as error:
        engine.set_material("sigma_s_prime=-1,sigma_a=0")
    assert type(error.value).__name__ == "InputError"
    for bad in ("directional:0,0,0:1", "directional:1,0,0", "spot:0,0,0:1", "point:0,0,nan:1"):
        with pytest.raises(Exception, match=r"light|directional|point|spot"):
            engine.set_lights([bad])
    with pytest.raises(Exception, match=r"q: shape"):
        engine.set_irradiance(0, np.ones((3, 3)))
    with pytest.raises(Exception, match="no such gpu"):
        _core.Engine(sphere_path, device="no such gpu")
