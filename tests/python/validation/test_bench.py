"""What `quadgraph bench` counts: work, errors, the least that reaches a target, shares of the copy bandwidth."""

from __future__ import annotations

import sys
from itertools import pairwise

import numpy as np
import pytest

from baked import write_levels
from quadgraph.baking.budget.surface_errors import unlit_part
from quadgraph.base.errors import InputError, SolverError
from quadgraph_validation.benchmark import bench_charts, frame_passes, scaling
from quadgraph_validation.benchmark.algebraic_error import AlgebraicJudge, judge
from quadgraph_validation.benchmark.bench_scene import LIGHT, Device
from quadgraph_validation.benchmark.solver_convergence import (
    DIAGONAL,
    MOST_ITERATIONS,
    TARGETS,
    SolverRunner,
    SolverWay,
)
from shapes import icosphere

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")


@pytest.fixture(scope="module")
def sphere(tmp_path_factory):
    """A marble sphere of two levels, radius 10 mm, lit from one side."""
    path = tmp_path_factory.mktemp("bench") / "sphere.qgraph"
    return Device().open(write_levels(path, [icosphere(3, 10), icosphere(2, 10)]), "marble", [LIGHT])


def runner_of(engine, way: SolverWay) -> SolverRunner:
    return SolverRunner(engine, way, judge(engine, **way.system))


def test_copying_is_measured_both_ways_and_the_faster_counts():
    copied = _core.copy_bandwidth()
    assert min(copied["kernel"], copied["transfer"]) > 0
    assert copied["gb_per_s"] == max(copied["kernel"], copied["transfer"])
    assert copied["bytes"] >= 32e6
    assert copied["device"]
    assert copied["driver"]


def test_copying_on_a_device_that_is_not_there_says_so():
    with pytest.raises(Exception, match="abacus"):
        _core.copy_bandwidth("abacus")


def test_unlit_is_what_lets_in_less_than_a_tenth_of_the_mean_by_area():
    area = np.array([1.0, 1.0, 2.0, 4.0])
    q = np.array([[3.0, 3.0, 2.0], [0.05, 0.05, 0.02], [0.03, 0.03, 0.03], [0.0, 0.0, 0.0]])
    # The mean is (8 + 0.12 + 2 * 0.09) / 8 = 1.04.
    assert unlit_part(area, q).tolist() == [False, False, True, True]


def test_error_is_relative_rms_by_area_over_both_parts():
    true = AlgebraicJudge(np.array([1.0, 3.0]), np.array([False, True]), np.array([[3.0, 0, 0], [0, 1.0, 0]]))
    assert true.error(1.1 * true.exitance) == pytest.approx({"whole": 0.1, "unlit": 0.1})
    found = true.exitance + np.array([[0, 0, 0], [0, 0, 0.5]])
    assert true.error(found) == pytest.approx({"whole": 0.5 * (3 / 12) ** 0.5, "unlit": 0.5})


@pytest.mark.parametrize("solver", ["fmg-pcg", "vcycle", "dpcg", "cascade", "jacobi"])
def test_more_iterations_are_more_work_and_less_error(sphere, solver):
    runner = runner_of(sphere, SolverWay(solver))
    few, some, many = (runner.at(n, 1e-3) for n in (1, 4, 12))
    assert 0 < few.work < some.work < many.work
    assert many.unlit < some.unlit < few.unlit
    assert many.whole < few.whole
    assert many.residual < some.residual < few.residual


def test_the_least_that_reaches_a_target_is_found(sphere):
    runner = runner_of(sphere, DIAGONAL)
    runner.explore()
    for target in TARGETS:
        point = runner.reaching(target)
        assert point.unlit <= target
        before = runner.at(point.iterations - 1, point.tolerance)
        assert before.unlit > target
    front = runner.front()
    assert len(front) > 4
    assert all(a.work < b.work and a.unlit > b.unlit for a, b in pairwise(front))


def test_times_are_medians_and_no_pass_of_the_picture_counts(sphere):
    runner = runner_of(sphere, DIAGONAL)
    point = runner.at(5, 1e-3)
    for _ in range(3):
        runner.time(point)
    record = point.record()
    assert min(point.time_ms) <= record["time_ms"] <= max(point.time_ms)
    assert 0 < record["time_ms"] <= 1.05 * record["wall_ms"]


def test_a_truth_that_does_not_converge_is_refused(sphere, monkeypatch):
    monkeypatch.setattr("quadgraph_validation.benchmark.algebraic_error._TRUTH_ITERATIONS", 3)
    with pytest.raises(SolverError, match="exact solution"):
        judge(sphere, **DIAGONAL.system)


def test_shares_of_copying_follow_from_the_medians():
    frames = [[{"name": "sweep", "time_ms": t, "bytes": 4_000_000, "count": 2}] for t in (1.0, 4.0, 2.0)]
    (entry,) = frame_passes.median_passes(frames, copy_gb_per_s=8.0)
    assert entry["time_ms"] == 2.0
    assert entry["gb_per_s"] == pytest.approx(2.0)
    assert entry["copy_share"] == pytest.approx(0.25)


def test_the_exponent_of_growth_is_fitted_to_the_large_bodies_alone():
    def body(tets: int, time_ms: float | None) -> dict:
        return {"tets": tets, "models": {"diffusion": {"time_ms": time_ms}}}

    large = [body(n, 1e-5 * n**1.03) for n in (60_000, 300_000, 2_000_000)]
    assert scaling.exponent([body(3000, 50.0), *large, body(100_000, None)], "diffusion") == pytest.approx(1.03)
    assert scaling.exponent(large[:1], "diffusion") is None


def solver_record() -> dict:
    """A record of two ways on one scene, as convergence.run makes it."""

    def way(name: str, points: list[tuple[float, float]]) -> dict:
        made = [{"iterations": 1, "work": w, "time_ms": 2 * w, "wall_ms": 3 * w, "unlit": e} for w, e in points]
        return {"name": name, "points": made, "targets": [{"unlit": 0.01, "reached": made[-1]}]}

    ways = [way("fmg-pcg", [(5, 0.1), (10, 0.001)]), way("jacobi", [(10, 0.5), (300, 0.01)])]
    return {"device": "abacus (9 beads)", "solvers": [{"name": "bunny", "material": "marble", "ways": ways}]}


def test_charts_are_drawn_for_work_and_for_time(tmp_path):
    pytest.importorskip("matplotlib", reason="matplotlib is not installed: pip install './python/validation[bench]'")
    written = bench_charts.write(tmp_path / "images", solver_record())
    assert [path.name for path in written] == ["error-work.png", "error-time.png"]
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in written)


def test_charts_without_matplotlib_name_the_extra(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(InputError, match=r"pip install './python/validation\[bench\]'"):
        bench_charts.write(tmp_path, solver_record())
    assert list(tmp_path.iterdir()) == []


def test_a_solver_that_never_arrives_is_cut_off(sphere, monkeypatch):
    monkeypatch.setattr("quadgraph_validation.benchmark.solver_convergence.MOST_ITERATIONS", 3)
    runner = runner_of(sphere, SolverWay("jacobi"))
    runner.explore()
    assert runner.reaching(TARGETS[-1]) is None
    assert runner.front()[-1].iterations <= 3 < MOST_ITERATIONS
