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
    """A sphere of two levels, radius 4 mm: with edges below two mean free paths no exitance is made even."""
    return write_levels(tmp_path_factory.mktemp("rivals") / "sphere.qgraph", [icosphere(3, 4), icosphere(2, 4)])


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


def test_the_matrices_are_symmetric_and_solved_directly_give_the_engines_exitance(lit):
    engine, built, _ = lit
    x = np.column_stack([spsolve(a.tocsc(), built.b[:, c]) for c, a in enumerate(built.matrices)])
    for a in built.matrices:
        assert abs(a - a.T).max() < 1e-12 * abs(a).max()
    engine.solve(solver="dpcg", model="diffusion", tolerance=1e-7, inter_reflection=False)
    ours = engine.surface_field()["exitance"]
    assert np.linalg.norm(built.exitance(x) - ours) < 2e-5 * np.linalg.norm(ours)


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
