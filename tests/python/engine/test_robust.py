"""The engine where methods fail: contrasts, clear and black regions, elements of any size, hard meshes."""

from __future__ import annotations

import numpy as np
import pytest

import quadgraph
from baked import write_levels
from quadgraph.file.graph_file import write
from quadgraph_validation.bodies.meshes import box, face_frames
from shapes import icosphere, join, moved, torus

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

RADIUS = 5.0  # mm
ETA = 1.4


@pytest.fixture(scope="module")
def sphere(tmp_path_factory):
    return write_levels(
        tmp_path_factory.mktemp("robust") / "sphere.qgraph", [icosphere(3, RADIUS), icosphere(2, RADIUS)]
    )


def alternating(nodes: np.ndarray, first: tuple[float, float], second: tuple[float, float]) -> tuple:
    """One of two pairs (sigma_s', sigma_a) per node, at random."""
    choice = np.random.default_rng(5).random(len(nodes)) < 0.5
    return tuple(np.repeat(np.where(choice, a, b)[:, None], 3, axis=1) for a, b in zip(first, second, strict=True))


def inclusion(nodes: np.ndarray, inside: tuple[float, float], outside: tuple[float, float]) -> tuple:
    """One pair of coefficients in the core, another around it."""
    core = np.linalg.norm(nodes, axis=1) < 0.5 * RADIUS
    return tuple(np.repeat(np.where(core, a, b)[:, None], 3, axis=1) for a, b in zip(inside, outside, strict=True))


def even(nodes: np.ndarray, sigma_s_prime: float, sigma_a: float) -> tuple:
    return np.full((len(nodes), 3), sigma_s_prime), np.full((len(nodes), 3), sigma_a)


CASES = {
    "kappa 10^4": lambda nodes: alternating(nodes, (0.01, 1e-4), (100.0, 1e-4)),
    "sigma_a 10^4": lambda nodes: alternating(nodes, (1.0, 1e-3), (1.0, 10.0)),
    "no absorption": lambda nodes: even(nodes, 2.0, 0.0),
    "black": lambda nodes: even(nodes, 0.01, 10.0),
    "clear core": lambda nodes: inclusion(nodes, (0.0, 0.0), (2.0, 0.01)),
    "clear core that absorbs": lambda nodes: inclusion(nodes, (0.0, 0.5), (2.0, 0.01)),
    "opaque core": lambda nodes: inclusion(nodes, (1.0, 100.0), (1.0, 0.01)),
    "mean free path of 0.01 elements": lambda nodes: even(nodes, 99.0, 1.0),
    "mean free path of 100 elements": lambda nodes: even(nodes, 0.0099, 0.0001),
    "clear all through": lambda nodes: even(nodes, 0.0, 0.0),
}


def light_on(level) -> np.ndarray:
    """Irradiance (n_f, 3) of light that falls slantwise from +z."""
    _, normal, _ = face_frames(level)
    return np.clip(normal[:, 2:], 0, None) * np.ones(3)


def check(engine, optical, model: str, balance: float = 1e-5) -> None:
    """Finite, balanced, nothing negative, and the answer of the CPU in double precision.

    Asked for more than single precision may hold: then the solve says that it did not converge, and is right still.
    """
    light = {"direction": (0.2, 0.0, -1.0)}
    for number, level in enumerate(engine.graph.levels):
        engine.set_optical(number, *optical(np.asarray(level.nodes, np.float64)), ETA)
        engine.set_irradiance(number, light_on(level), **light)
    report = engine.solve(model=model, tolerance=1e-6, max_iterations=20000)
    field, finest = engine.surface_field(), engine.graph.levels[0]
    coefficients = optical(np.asarray(finest.nodes, np.float64))
    worst = np.inf  # of the two ways to store the entries the one that was taken
    for stored in (True, False):
        exact = _core.solve_reference(
            engine.graph, 0, *coefficients, ETA, light_on(finest), **light, model=model, stored=stored
        )
        largest = max(exact["exitance"].max(), 1e-30)
        worst = min(worst, np.abs(field["exitance"] - exact["exitance"]).max() / largest)
    imbalance = np.abs(report["energy"]["balance"]).max()
    print(f"{model}: balance {imbalance:.1e}, worst {worst:.1e}, {report['levels'][-1]}")
    assert np.isfinite(field["exitance"]).all()
    assert field["exitance"].min() >= 0
    assert field["unscattered"].min() >= 0
    assert imbalance < balance
    assert worst < 1e-3
    # Converged is said of the exitance: then it is right to more than the tolerance times what single precision adds.
    if report["levels"][-1]["converged"]:
        assert worst < 2e-5


@pytest.mark.parametrize("model", ["diffusion", "sp3"])
@pytest.mark.parametrize("case", CASES)
def test_materials(sphere, case, model):
    check(_core.Engine(sphere, validation=True), CASES[case], model)


@pytest.mark.parametrize("model", ["diffusion", "sp3"])
def test_two_bodies_and_a_body_with_a_hole(tmp_path, model):
    apart = join(icosphere(2, 2.0), moved(icosphere(2, 1.0), 5.0, 0.0, 0.0))
    check(_core.Engine(write_levels(tmp_path / "two.qgraph", [apart]), validation=True), CASES["no absorption"], model)


@pytest.mark.parametrize("model", ["diffusion", "sp3"])
def test_slivers_and_needles(tmp_path, model):
    """Layers of 0.002 mm, dihedral angles of 0.1 degrees; and a needle 30 mm long and 0.03 mm thick."""
    steps = np.array([0.0, 1.0, 2.0, 3.0])
    thin = np.array([0.0, 0.002, 1.5, 3.0])
    for name, mesh in {
        "slivers": box(steps, steps, thin, lambda normal: np.zeros(len(normal), bool)),
        "needle": box(0.01 * steps, 0.01 * steps, 10 * steps, lambda normal: np.zeros(len(normal), bool)),
    }.items():
        engine = _core.Engine(write(tmp_path / f"{name}.qgraph", [mesh]), validation=True)
        # In the needle fluence hardly varies between neighbours: a float holds no more of the difference.
        check(engine, lambda nodes: even(nodes, 1.0, 0.05), model, balance=1e-5 if name == "slivers" else 1e-4)


@pytest.mark.parametrize("model", ["diffusion", "sp3"])
@pytest.mark.parametrize("contrast", [10, 100, 1e4, 1e6])
@pytest.mark.parametrize("edited", [False, True])
def test_a_channel_does_not_depend_on_the_others(tmp_path, model, contrast, edited):
    """However much more another one absorbs: packed entries share an exponent between channels."""
    body = write_levels(tmp_path / "ring.qgraph", [torus(10, 4, 24, 12)])
    engine = quadgraph.Engine(body, device="cpu")
    engine.lights = ["directional:0.3,-0.5,-1:1"]

    def exitance(blue: float):
        given = 1 if edited else blue
        engine.material = f"sigma_s_prime=1/1/{given:f},sigma_a=.05/.05/{0.05 * given:f}"
        edit = {"operation": "multiply", "sigma_s_prime": [1, 1, blue], "sigma_a": [1, 1, blue]}
        engine.set_edits([edit] if edited else [])
        engine.solve(model=model, correction=False, tolerance=1e-4)
        return engine.surface().exitance[:, 0].copy()

    alone, beside = exitance(1), exitance(contrast)
    assert np.linalg.norm(beside - alone) < 1e-3 * np.linalg.norm(alone)
