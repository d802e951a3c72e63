"""`quadgraph bench --rivals`: the system that other solvers get is the engine's, and so is what they find."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from baked import write_levels
from quadgraph.base.errors import InputError, SolverError
from quadgraph_validation.benchmark import linear_system, rivals
from quadgraph_validation.benchmark.bench_scene import DIRECTION, LIGHT, BenchScene, Device
from quadgraph_validation.benchmark.contest import Contest, History, counts_for_residual
from quadgraph_validation.benchmark.solver_convergence import DIAGONAL, TARGETS, SolverWay
from shapes import icosphere

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """A sphere of two levels, radius 10 mm."""
    return write_levels(tmp_path_factory.mktemp("rivals") / "sphere.qgraph", [icosphere(3, 10), icosphere(2, 10)])


@pytest.fixture(scope="module")
def lit(path):
    """The engine with the sphere under given irradiance, and the linear system of that."""
    engine = Device().open(path, "marble", [LIGHT])
    q = linear_system.give_irradiance(engine, DIRECTION)
    return engine, linear_system.assemble(engine.graph, "marble", q, DIRECTION), q


@pytest.fixture(scope="module")
def contest(lit):
    """The problem as rivals get it."""
    return Contest(lit[1], lit[2])


def made_even(level, material, q, exitance):
    """Exitance (m, 3) of a smooth body of one material made even as docs/physics.md, "Exitance", has it."""
    optical = _core.Material(material)
    sigma_a, sigma_s = np.array(optical.sigma_a), np.array(optical.sigma_s_prime)
    faces, places = np.asarray(level.faces), np.asarray(level.vertices, np.float64)
    corners = places[faces]
    edges = np.roll(corners, -1, axis=1) - corners
    normal = np.cross(edges[:, 0], edges[:, 1])
    area = np.linalg.norm(normal, axis=1) / 2
    normal /= 2 * area[:, None]
    edge = np.sqrt((edges**2).sum(axis=2).mean(axis=1))
    share = np.clip(edge[:, None] * (sigma_a + sigma_s) / 2 - 1, 0, 1)
    s = np.sqrt(sigma_a / (sigma_a + sigma_s))
    back = (1 - s) * (1 - 0.139 * s) / (1 + 1.17 * s)
    kept = internal_diffuse_reflectance(optical.eta)
    far = exitance - np.minimum(0.85 * (1 - kept) * back / (1 - kept * back) * q, exitance)
    lit = (q != 0).any(axis=1)
    brought = np.zeros_like(exitance)
    for v in range(faces.max() + 1):
        around = np.flatnonzero((faces == v).any(axis=1))
        weight = area[around, None] * share[around]
        turn = np.clip(
            (normal[around] @ normal[around].T - np.sqrt(0.5)) / (np.cos(np.radians(35)) - np.sqrt(0.5)), 0, 1
        )
        joined = turn**2 * (3 - 2 * turn) * (lit[around][:, None] == lit[around])
        exchanged = np.einsum("fg,gc,fgc->fc", joined, weight, far[around] - far[around][:, None])
        brought[around] += exchanged / weight.sum(axis=0) / 3
    return exitance + share * brought


def internal_diffuse_reflectance(eta):
    """Of uniform light inside what a smooth surface reflects back, by Fresnel's equations."""
    nodes, weights = np.polynomial.legendre.leggauss(200)
    critical = np.sqrt(1 - 1 / eta**2)
    mu = critical + (1 - critical) * (nodes + 1) / 2
    outside = np.sqrt(1 - eta**2 * (1 - mu**2))
    s, p = (eta * mu - outside) / (eta * mu + outside), (mu - eta * outside) / (mu + eta * outside)
    return critical**2 + (1 - critical) * (weights * mu * (s**2 + p**2) / 2).sum()


def test_the_matrices_are_symmetric_and_solved_directly_give_the_engines_exitance(lit):
    engine, built, q = lit
    x = np.column_stack([spsolve(a.tocsc(), built.b[:, c]) for c, a in enumerate(built.matrices)])
    for a in built.matrices:
        assert abs(a - a.T).max() < 1e-12 * abs(a).max()
    engine.solve(solver="dpcg", model="diffusion", tolerance=1e-6, inter_reflection=False)
    ours = engine.surface_field()["exitance"]
    raw, exact = built.exitance(x), made_even(engine.graph.levels[0], "marble", q, built.exitance(x))
    assert np.linalg.norm(exact - ours) < 2e-5 * np.linalg.norm(ours)
    assert np.linalg.norm(exact - raw) > 1e-2 * np.linalg.norm(raw)


def test_the_residual_is_measured_as_the_engine_reports_it(lit):
    engine, built, _ = lit
    report = engine.solve(solver="dpcg", model="diffusion", cycles=6, inter_reflection=False)
    x = np.asarray(engine.phi(), np.float64)
    worst = max(built.residual(x[:, c], c) for c in range(3))
    assert worst == pytest.approx(report["levels"][-1]["residual"], rel=0.02)


def test_irradiance_given_instead_of_light_keeps_its_power_on_every_level(path):
    engine = Device().open(path, "marble", [LIGHT])
    lit = engine.solve(solver="dpcg", model="diffusion", tolerance=1e-5, inter_reflection=False)
    linear_system.give_irradiance(engine, DIRECTION)
    given = engine.solve(solver="dpcg", model="diffusion", tolerance=1e-5, inter_reflection=False)
    assert np.allclose(given["energy"]["entered"], lit["energy"]["entered"], rtol=1e-5)
    assert np.allclose(given["energy"]["scattered_out"], lit["energy"]["scattered_out"], rtol=1e-2)


@pytest.mark.parametrize("rival", rivals.RIVALS, ids=lambda rival: rival.name)
def test_rivals_get_exactly_the_iterations_that_they_need(contest, rival):
    pytest.importorskip("pyamg", reason="pyamg is not installed: pip install './python/validation[bench]'")
    entrant = rivals.Entrant(rival, contest.system)
    for target in TARGETS:
        counts = rivals.iterations_wanted(contest, entrant, target, residual=target)
        x = entrant.solve(counts["error"])
        assert contest.judge.error(contest.system.exitance(x))["unlit"] <= 1.001 * target
        fewer = entrant.solve([max(n - 1, 1) for n in counts["error"]])
        assert contest.judge.error(contest.system.exitance(fewer))["unlit"] > target
        solved = entrant.solve(counts["residual"])
        assert all(contest.system.residual(solved[:, c], c) <= 1.001 * target for c in range(3))


def test_iterations_for_an_error_may_differ_by_channel_and_no_more_than_all_alike(contest):
    sizes = contest.sizes
    slow = History([1.0, 0.1, 0.01], [size * share for size, share in zip([sizes[0]] * 3, (1, 0.5, 1e-5), strict=True)])
    fast = [History([1.0, 0.01], [sizes[c], 1e-5 * sizes[c]]) for c in (1, 2)]
    assert contest.counts_for_error([slow, *fast], 0.01) == [3, 2, 2]
    assert counts_for_residual([slow, *fast], 0.05) == [3, 2, 2]


def test_a_run_has_everybody_at_the_target_and_agrees(path):
    pytest.importorskip("pyamg", reason="pyamg is not installed: pip install './python/validation[bench]'")
    record = rivals.run(BenchScene("sphere", path), Device(), 1, lambda text: None, (DIAGONAL,))
    assert record["agreement"]["unlit"] < TARGETS[-1]
    assert set(record["set_up_ms"]) == {rival.name for rival in rivals.RIVALS}
    for target in record["targets"]:
        assert target["ours"]["dpcg"]["unlit"] <= target["unlit"]
        for goals in target["rivals"].values():
            assert all(goals[goal]["time_ms"] > 0 and min(goals[goal]["iterations"]) > 0 for goal in goals)


def test_ours_that_never_arrives_is_an_error(path, monkeypatch):
    pytest.importorskip("pyamg", reason="pyamg is not installed: pip install './python/validation[bench]'")
    monkeypatch.setattr("quadgraph_validation.benchmark.solver_convergence.MOST_ITERATIONS", 2)
    with pytest.raises(SolverError, match="not reached"):
        rivals.run(BenchScene("sphere", path), Device(), 1, lambda text: None, (SolverWay("jacobi"),))


def test_without_pyamg_the_way_to_get_it_is_told(monkeypatch):
    monkeypatch.setitem(sys.modules, "pyamg", None)
    with pytest.raises(InputError, match=r"pip install './python/validation\[bench\]'"):
        rivals.load_pyamg()
