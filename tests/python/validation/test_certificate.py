"""What a certificate measures, beside random walks that share no line with it."""

from __future__ import annotations

import json

import numpy as np
import pytest

import quadgraph
from baked import write_levels
from quadgraph import cli
from quadgraph.api.lights import AmbientLight, DirectionalLight
from quadgraph.base.errors import InputError
from quadgraph.core import load_core
from quadgraph.mesh.surface import Surface
from shapes import icosphere, join, moved

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
mesh_walk = pytest.importorskip("quadgraph_validation.truth.mesh_walk", reason="needs the extra walks")
monte_carlo = pytest.importorskip("quadgraph_validation.truth.monte_carlo")
unseen_cases = pytest.importorskip("quadgraph_validation.bodies.unseen_cases")

Medium = pytest.importorskip("quadgraph_validation.bodies.media").Medium

SUN = DirectionalLight((0.0, 0.0, -1.0), 1.0)
BATCHES, WALKS = 10, 40_000
Z = 6.0  # standard errors of the difference that are no chance: of both, each by ten batches or more


def two_balls(detail: int) -> Surface:
    """The upper one throws its shadow and its light on the lower one."""
    return join(icosphere(detail, 8), moved(icosphere(detail, 5), 3, 0, 14))


def truth_of(surface: Surface, coefficients: tuple[float, float, float], light, part: np.ndarray) -> np.ndarray:
    """(BATCHES, parts): power that leaves after it scattered, W."""
    scattering, absorption, eta = coefficients
    grids = (np.full((1, 1, 1), value, np.float32) for value in (scattering, absorption))
    walker = mesh_walk.MeshWalker(surface, unseen_cases.UnseenMedium("even", eta, *grids), light, part)
    return np.array([walker.batch(WALKS, number, 3).scattered for number in range(BATCHES)])


CASES = {
    "ball, few mean free paths": ((0.3, 0.3, 1.4), lambda n: icosphere(n, 10), SUN),
    "two balls, sun": ((1.0, 0.02, 1.3), two_balls, SUN),
    "two balls, from all around": ((3.0, 0.02, 1.0), two_balls, AmbientLight(1.0)),
}


@pytest.mark.parametrize(
    "case", [pytest.param(name, marks=pytest.mark.long) if "two balls" in name else name for name in CASES]
)
def test_its_powers_are_those_of_other_walks(tmp_path, case):
    coefficients, body, light = CASES[case]
    path = write_levels(tmp_path / "body.qgraph", [body(3), body(2)], rays=64)
    with quadgraph.Engine(path, device="cpu") as engine:
        engine.material = "sigma_s_prime={},sigma_a={},eta={}".format(*coefficients)
        engine.lights = [light]
        certificate = engine.solve(sweeps=1, certify=1.5).certificate
        field, found = engine.surface(), engine.walked_exitance()
    level = load_core().load(path).levels[0]
    surface = Surface(level.vertices.astype(np.float64), level.faces.astype(np.int64))
    q = field.q.sum(axis=1)
    unlit = q < 0.1 * np.average(q, weights=field.area)
    walked = truth_of(surface, coefficients, light, unlit.astype(int))
    power = (field.area @ found.exitance).sum()
    assert power == pytest.approx((field.area @ field.exitance).sum() / (1 + certificate.whole.power), rel=1e-4)
    assert 0 < found.standard_error.mean() < found.exitance.mean()
    solved = field.area * field.exitance[:, 0]
    parts = {"whole": (solved.sum(), walked.sum(axis=1))}
    if unlit.any():
        parts["unlit"] = (solved[unlit].sum(), walked[:, 1])
    for name, (solved_power, truths) in parts.items():
        part = getattr(certificate, name)
        expected = solved_power / truths.mean() - 1
        noise = truths.std(ddof=1) / np.sqrt(BATCHES) / truths.mean()
        assert noise < 0.02
        assert part.power_noise < 0.02
        assert abs(part.power - expected) < Z * np.hypot(part.power_noise, noise * (1 + expected)), name


RADIUS, ALBEDO, ETA = 3.0, 0.6, 1.3  # reduced mean free paths; a dark, thin body


def out_of_ball(g: float, edge: float, seed: int) -> np.ndarray:
    """(2,) shares of what enters a ball of a reduced coefficient that leave it, everywhere and behind z = edge."""
    medium = Medium(ALBEDO / (1 - g), 1 - ALBEDO)
    exits = monte_carlo.through_sphere(medium, RADIUS, ETA, 400_000, np.random.default_rng(seed), g)
    return np.array([len(exits.position), (exits.position[:, 2] < edge).sum()]) / 400_000


def all_that_leaves(field) -> np.ndarray:
    """(n_f,) W, scattered or not."""
    return field.area * (field.exitance + field.unscattered)[:, 0]


@pytest.mark.long
def test_scattering_forwards_is_solved_measured_and_stated(tmp_path):
    """Against walks in the round ball, all that leaves; that of triangles is thinner, and its terminator wide."""
    path = write_levels(tmp_path / "ball.qgraph", [icosphere(4, RADIUS), icosphere(3, RADIUS)])
    with quadgraph.Engine(path, device="cpu") as engine:
        engine.lights = [SUN]
        engine.material = quadgraph.Material(ALBEDO, 1 - ALBEDO, ETA, g=0.9)
        solution, field = engine.solve(certify=5), engine.surface()
        assert engine.solve(correction=False).phase_warning
        engine.material = quadgraph.Material(ALBEDO, 1 - ALBEDO, ETA)
        reduced, by_reduced = engine.solve(), all_that_leaves(engine.surface())
    certificate = solution.certificate
    q = field.q.sum(axis=1)
    unlit = q < 0.1 * np.average(q, weights=field.area)
    edge = (field.position[unlit, 2].max() + field.position[~unlit, 2].min()) / 2
    leaves = all_that_leaves(field)
    truths = monte_carlo.entering_sphere(RADIUS, ETA) * out_of_ball(0.9, edge, 1)
    whole = leaves.sum() / (1 + certificate.whole.power)
    behind = leaves[unlit].sum() / (1 + certificate.unlit.power)
    assert abs(whole / truths[0] - 1) < 0.015 + Z * certificate.whole.power_noise
    assert abs(behind / truths[1] - 1) < 0.03 + Z * certificate.unlit.power_noise
    assert abs(leaves.sum() / truths[0] - 1) < 0.02 < 0.05 < abs(by_reduced.sum() / truths[0] - 1)
    assert abs(leaves[unlit].sum() / truths[1] - 1) < 0.06 < 0.08 < abs(by_reduced[unlit].sum() / truths[1] - 1)
    assert 0.2 > solution.phase_error.unlit > 0.03 > reduced.error.unlit
    assert reduced.phase_error is None
    assert solution.error.unlit > solution.phase_error.unlit
    assert certificate.disagreement == solution.phase_warning == ""
    assert "scattering forwards" in solution.advice


def test_it_finds_how_far_off_a_coarse_body_is(tmp_path):
    """Far behind, tets of three mean free paths are off by a quarter, and the estimate knows."""
    path = write_levels(tmp_path / "ball.qgraph", [icosphere(2, 10), icosphere(1, 10)])
    coefficients = (3.0, 0.02, 1.3)
    with quadgraph.Engine(path, device="cpu") as engine:
        engine.material = "sigma_s_prime={},sigma_a={},eta={}".format(*coefficients)
        engine.lights = [SUN]
        solution = engine.solve(certify=2.0)
        field = engine.surface()
    level = load_core().load(path).levels[0]
    surface = Surface(level.vertices.astype(np.float64), level.faces.astype(np.int64))
    walked = truth_of(surface, coefficients, SUN, np.arange(len(field.area))).mean(axis=0) / field.area
    unlit = field.q.sum(axis=1) == 0
    off, area = field.exitance[unlit, 0] - walked[unlit], field.area[unlit]
    true = np.sqrt(np.average(off**2, weights=area) / np.average(walked[unlit] ** 2, weights=area))
    assert true > 0.15
    found = solution.certificate.unlit
    assert abs(found.error - true) < 0.25 * true + Z * found.error_noise
    assert found.error_noise < 0.05
    assert "unlit" not in solution.certificate.disagreement


def test_what_cannot_be_certified_is_refused_and_what_was_not_asked_for_is_not_there(tmp_path):
    path = write_levels(tmp_path / "ball.qgraph", [icosphere(2, 10), icosphere(1, 10)])
    with quadgraph.Engine(path, device="cpu") as engine:
        engine.material, engine.lights = "ketchup", [SUN]
        engine.solve(sweeps=1)
        with pytest.raises(InputError, match="certified"):
            engine.walked_exitance()
        for options in ({"correction": False}, {"method": "quadgraph-fv"}, {"source": "diffuse"}):
            with pytest.raises(InputError, match="certif"):
                engine.solve(certify=1, **options)
        with pytest.raises(InputError, match="certify"):
            engine.solve(certify=-1)
        assert engine.solve(sweeps=1).certificate is None


def test_commands_print_and_write_it(tmp_path, capsys):
    path = write_levels(tmp_path / "ball.qgraph", [icosphere(2, 10), icosphere(1, 10)])
    report = tmp_path / "report.json"
    scene = [str(path), "--material", "ketchup", "--light", SUN.text, "--sweeps", "1", "--certify", "0.2"]
    assert cli.main(["solve", *scene, "--json", str(report)]) == 0
    found = json.loads(report.read_text())["certificate"]
    assert 0 < found["whole"]["power_noise"] < 0.05
    assert "million random walks in" in capsys.readouterr().out
