"""The GPU engine, driven as a user drives it from Python, against the CPU reference and physics."""

from __future__ import annotations

import numpy as np
import pytest

from baked import write_levels
from light_truth import lit_from_above
from quadgraph_validation.bodies.meshes import face_frames
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


@pytest.mark.parametrize("material", [MATERIAL, "marble-veins,period=6"])
@pytest.mark.parametrize("source", ["buried", "diffuse"])
@pytest.mark.parametrize("model", ["diffusion", "sp3"])
@pytest.mark.parametrize("method", ["fem", "quadgraph-fv", "quadgraph-fdm"])
def test_gpu_equals_cpu_reference(engine, method, model, source, material):
    engine.set_material(material)
    levels = engine.graph.levels
    light = {"direction": (0.3, 0.0, -1.0)}
    for number, level in enumerate(levels):
        engine.set_irradiance(number, lit_from_above(level), **light)
    way = {"method": method, "model": model, "source": source}
    report = engine.solve(**way, tolerance=1e-6, max_iterations=20000)
    sigma_s_prime, sigma_a = _core.evaluate_material(engine.graph, 0, _core.Material(material))
    eta = _core.Material(material).eta
    expected = _core.solve_reference(
        engine.graph,
        0,
        sigma_s_prime,
        sigma_a,
        eta,
        lit_from_above(levels[0]),
        **light,
        **way,
        tolerance=1e-11,
        stored=True,
    )
    field = engine.surface_field()
    scale = np.abs(expected["exitance"]).max(axis=0)
    worst = np.abs((field["exitance"] - expected["exitance"]) / scale).max()
    print(f"{way}: worst difference {worst:.1e}, residual {report['levels'][-1]['residual']:.1e}")
    assert worst < 2e-5
    for name in ("entered", "scattered_out", "absorbed", "unscattered_out"):
        assert np.allclose(report["energy"][name], expected["energy"][name], rtol=1e-4, atol=1e-6)
    assert np.allclose(report["clipped"], expected["clipped"], atol=1e-5)


@pytest.mark.parametrize("model", ["diffusion", "sp3"])
def test_furnace_to_single_precision(engine, model):
    engine.set_material("sigma_s_prime=2/1/0.5,sigma_a=0,eta=1.3")
    for number, level in enumerate(engine.graph.levels):
        engine.set_irradiance(number, np.full((len(level.faces), 3), 0.7, np.float32))
    for method in ("fem", "quadgraph-fv", "quadgraph-fdm"):
        engine.solve(method=method, model=model, source="diffuse", tolerance=1e-6)
        field = engine.surface_field()
        assert np.abs(field["exitance"] / 0.7 - 1).max() < 1e-4
        expected = 0.7 * _core.boundary(method, "diffuse", model, 1.3)["source"]
        assert np.abs(field["phi"] / expected - 1).max() < 1e-4
    for method in ("fem", "quadgraph-fv"):
        energy = engine.solve(method=method, model=model, source="buried", tolerance=1e-6)["energy"]
        assert np.abs(energy["balance"]).max() < 1e-5
        assert max(energy["absorbed"]) == 0


def test_the_published_baseline_alone_keeps_the_published_polynomial(engine):
    published = _core.boundary("quadgraph-fdm", "diffuse", "diffusion", 1.3)
    assert np.isclose(1 / (2 * published["k11"]), _core.mismatch(1.3))
    for way in (("fem", "diffuse", "diffusion"), ("quadgraph-fdm", "buried", "diffusion")):
        assert np.isclose(1 / (2 * _core.boundary(*way, 1.3)["k11"]), 2.341, rtol=1e-3)


def scatter(cos_theta: np.ndarray, exitance: np.ndarray) -> float:
    """Relative RMS of what a smooth curve over the lit side leaves."""
    lit = cos_theta > 0.3
    smooth = np.polyval(np.polyfit(cos_theta[lit], exitance[lit], 5), cos_theta[lit])
    return (exitance[lit] / smooth - 1).std()


@pytest.mark.parametrize("model", ["diffusion", "sp3"])
def test_pictures_are_smooth_where_elements_are_longer_than_the_mean_free_path(engine, model):
    """Uniform light on irregular tets of two mean free paths: local means, not values at the vertices, are shown."""
    level = engine.graph.levels[0]
    edge = np.sqrt(face_frames(level)[2].mean() * 4 / np.sqrt(3))
    engine.set_material(f"sigma_s_prime={2 / edge},sigma_a={2e-3 / edge},eta=1.3")
    engine.set_lights(["directional:0,0,-1:1"])
    report = engine.solve(model=model)
    field, shown = engine.surface_field(), engine.vertex_exitance()
    of_faces = scatter(field["normal"][:, 2], field["exitance"][:, 0])
    of_vertices = scatter(level.vertices[: len(shown), 2] / RADIUS, shown[:, 0])
    print(f"{model}: scatter of the exitance of faces {of_faces:.2%}, of the vertices shown {of_vertices:.2%}")
    assert of_vertices < 0.025
    power = (shown[level.faces].mean(axis=1) * field["area"][:, None]).sum(axis=0)
    energy = report["energy"]
    assert np.allclose(power, energy["scattered_out"], rtol=1e-4)


def test_fem_balances_energy_and_every_level_converges(engine):
    engine.set_material(MATERIAL)
    engine.set_lights(["directional:0,0,-1:2.0", "point:30,0,0:500"])
    report = engine.solve(tolerance=1e-6)
    assert all(level["converged"] for level in report["levels"])
    assert np.abs(report["energy"]["balance"]).max() < 1e-5
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
    assert picture.scattered.shape == picture.specular.shape == (64, 96, 3)
    assert picture.alpha.shape == (64, 96)
    covered = picture.alpha > 0.5
    assert 0.1 < covered.mean() < 0.9
    assert picture.scattered[covered].max() > 0
    assert picture.scattered[~(picture.alpha > 0)].max() == 0
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
    nodes = len(engine.graph.levels[0].nodes)
    with pytest.raises(Exception, match="direction"):
        engine.set_irradiance(0, lit_from_above(engine.graph.levels[0]), direction=(0, 0, 0))
    with pytest.raises(Exception, match=r"sigma_a: shape"):
        engine.set_optical(0, np.ones((nodes, 3)), np.ones((3, 3)), 1.3)
    with pytest.raises(Exception, match=r"optical\[0\]"):
        engine.set_optical(0, -np.ones((nodes, 3)), np.ones((nodes, 3)), 1.3)
    for bad in ({"method": "magic"}, {"source": "magic"}, {"model": "magic"}, {"solver": "magic"}):
        with pytest.raises(Exception, match=r"magic.*allowed"):
            engine.solve(**bad)
    with pytest.raises(Exception, match="no such gpu"):
        _core.Engine(sphere_path, device="no such gpu")


@pytest.mark.parametrize("model", ["diffusion", "sp3"])
def test_storing_entries_hardly_changes_the_exitance(small_bunny, model):
    graph = _core.Engine(small_bunny).graph
    level = graph.levels[0]
    material = _core.Material("marble-veins")
    coefficients = _core.evaluate_material(graph, 0, material)
    exact, stored = (
        _core.solve_reference(
            graph, 0, *coefficients, material.eta, lit_from_above(level), model=model, tolerance=1e-8, stored=stored
        )["exitance"]
        for stored in (False, True)
    )
    change = np.linalg.norm(stored - exact) / np.linalg.norm(exact)
    print(f"{model}: {change:.1e}")
    assert 0 < change < 1e-4
