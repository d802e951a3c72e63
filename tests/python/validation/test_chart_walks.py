"""Random walks on the chart: the truth of exitances by patches, the engine's own walks, and times at equal error."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from chart_bodies import Baked, ball, chart_ball
from chart_records import point, record
from quadgraph import cli
from quadgraph.base.errors import SolverError
from quadgraph_validation.bodies.scene_bakes import Choice
from quadgraph_validation.bodies.scenes import SCENES, View, of_medium
from quadgraph_validation.chart import chart_measure as measuring
from quadgraph_validation.chart import chart_record as records
from quadgraph_validation.chart import equal_error
from quadgraph_validation.chart.chart_body import ChartBody
from quadgraph_validation.chart.chart_judge import ChartJudge
from quadgraph_validation.chart.chart_method import MethodChain, pde_of, walks_judge
from quadgraph_validation.chart.engine_methods import EngineMethod, engine_methods
from quadgraph_validation.chart.walked_method import WalkedMethod, walked_methods
from shapes import icosphere

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
pytest.importorskip("numba", reason="needs the extra walks")
scene_walks = pytest.importorskip("quadgraph_validation.truth.scene_walks")
kept_walks = pytest.importorskip("quadgraph_validation.truth.kept_walks")

__all__ = ["ball"]

BALL = chart_ball({"A": View(70, 15, 46, ())})


@pytest.fixture
def body(ball) -> ChartBody:
    return ChartBody(BALL, ball, ball.parent, "cpu", 32, {Choice(): Baked(ball)})


def walked(surface, folder, walks: int):
    """Through the ball, in twenty batches."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(kept_walks, "BATCH", walks // 20)
        return scene_walks.made(BALL, surface, folder, lambda text: None, walks)


@pytest.fixture(scope="module")
def walks(ball, tmp_path_factory):
    surface = ChartBody(BALL, ball, ball.parent, "cpu", 32, {Choice(): Baked(ball)}).default_surface
    return walked(surface, tmp_path_factory.mktemp("walks"), 100_000)


def test_an_exitance_that_is_right_has_no_error_and_another_has_its_own(walks):
    """Of many triangles each patch is one number."""
    right = np.repeat(walks.exitance.mean(axis=1)[walks.patch][:, None], 3, axis=1)
    grey = replace(walks, exitance=np.repeat(walks.exitance.mean(axis=1)[:, None], 3, axis=1))
    assert set(grey.errors(right)) == {"whole", "unlit"}
    assert max(grey.errors(right).values()) == 0
    none = replace(grey, error=np.zeros_like(grey.error))
    assert none.errors(1.1 * right) == pytest.approx({"whole": 0.1, "unlit": 0.1})
    assert 0 < walks.noise["whole"] < walks.noise["unlit"] < 0.2
    # Half of a ball in parallel light is unlit, and what is less than a tenth of the mean a little beyond.
    dark = walks.entered.sum(axis=1) < 0.1 * np.average(walks.entered.sum(axis=1), weights=walks.area)
    assert walks.area[dark].sum() / walks.area.sum() == pytest.approx(0.5, abs=0.05)


def test_noise_of_the_walks_is_no_error_of_what_is_judged(body, walks, tmp_path):
    """Of two runs of the same walks, one judged by the other, about the noise of one is left, not of both."""
    other = walked(body.default_surface, tmp_path, 50_000)
    left = walks.errors(other.exitance[walks.patch])["whole"]
    assert 0.7 < left / other.noise["whole"] < 1.3


@pytest.mark.parametrize("guided", [False, True])
def test_the_engines_walks_and_those_of_the_truth_agree_to_their_noise(body, walks, guided):
    method = WalkedMethod(inter_reflection=True, choice=Choice(), seconds=0.5, guided=guided)
    method.prepare(body)
    assert method.frame(0)["random walks"] > 0
    mean, error = (np.asarray(each, float) for each in _core.walked_exitance(method._engine))
    assert np.array_equal(mean, method.exitance())
    area, of = walks.face_area, walks.patch
    by_patch = [np.bincount(of, area * mean[:, c]) / walks.area for c in range(3)]
    noise = [np.sqrt(np.bincount(of, (area * error[:, c]) ** 2)) / walks.area for c in range(3)]
    off = (np.array(by_patch).T - walks.exitance) / np.hypot(np.array(noise).T, walks.error)
    power, truth = ((walks.area[:, None] * each).sum() for each in (np.array(by_patch).T, walks.exitance))
    doubt = np.sqrt(((walks.area[:, None] * np.hypot(np.array(noise).T, walks.error)) ** 2).sum()) / truth
    middle = np.median(np.abs(off))
    print(f"median over the noise {middle:.2f}, power off by {power / truth - 1:+.2%} of {doubt:.2%}")
    assert 0.4 < middle < 1.4  # .67 of a normal one; few walks know their own noise badly, which makes tails
    assert power == pytest.approx(truth, rel=5 * doubt)


def test_walks_and_solves_of_the_default_bake_are_judged_by_patches_and_walks_show_nothing(body, walks):
    methods = [
        EngineMethod(choice=Choice(), inter_reflection=True),
        EngineMethod(choice=Choice(), inter_reflection=True, sweeps=1),
        EngineMethod(inter_reflection=True),
        WalkedMethod(choice=Choice(), inter_reflection=True, seconds=0.5),
    ]
    judge = ChartJudge(body, {}, {}, walks)
    points = measuring.measure(body, judge, methods, 1, lambda text: None)
    assert not [one.failed for one in points if one.failed]
    solved, corrected, chain, walked = (one.errors["walks"] for one in points)
    assert chain is None
    assert corrected["whole"] < 0.5 * solved["whole"]
    assert 0 < walked["whole"] < walked["unlit"] < 1
    assert points[-1].pictures == {}
    assert points[-1].errors["transport"] is None
    with pytest.raises(SolverError, match="no pictures"):
        methods[-1].picture("A")
    told = json.loads(json.dumps(measuring.scene_record(body, judge, points)))
    assert told["truth"]["walks"] == walks.noise
    panels = {(panel.truth, panel.part): panel for panel in records.panels(told)}
    assert len(panels["walks", "whole"].points) == 3
    assert panels["walks", "whole"].noise == walks.noise["whole"]
    # A frame of walks is walks alone.
    assert records.without_picture(told["points"][-1]) == pytest.approx(told["points"][-1]["ms"], rel=1e-3)


def test_walks_are_kept_under_all_that_enters_them(body, tmp_path, monkeypatch):
    monkeypatch.setattr(kept_walks, "BATCH", 1000)
    said = []
    surface = body.default_surface
    first = scene_walks.made(BALL, surface, tmp_path, said.append, 2000)
    assert said[:3] == [f"ball: random walks, channel 1, {done} of 2,000" for done in ("0", "1,000", "2,000")]
    assert len(said) == 9
    with monkeypatch.context() as without_numba:
        without_numba.delattr(kept_walks.extra_module, "load")
        again = scene_walks.made(BALL, surface, tmp_path, said.append, 2000)
    assert len(said) == 12
    assert np.array_equal(first.exitance, again.exitance)
    for changed in (replace(BALL, eta=1.2), replace(BALL, coefficients=of_medium([0.2] * 3, [0.061] * 3))):
        before = len(list(tmp_path.iterdir()))
        scene_walks.made(changed, surface, tmp_path, said.append, 2000)
        assert len(list(tmp_path.iterdir())) == before + 3


def test_coefficients_of_walks_are_those_of_the_scene():
    surface = icosphere(3, 50.0)
    scene = replace(SCENES["fertility"], height=1000.0)  # cells of 8 mm
    (medium,) = scene_walks.media_of(scene, surface)
    index = np.array([4, 6, 5])  # z, y, x
    place = np.array(medium.first) + medium.spacing * index[::-1]
    expected = scene.coefficients(place)
    assert medium.sigma_s_prime[tuple(index)] == pytest.approx(float(expected[0]), rel=1e-6)
    assert medium.sigma_a[tuple(index)] == pytest.approx(float(expected[1]), rel=1e-6)
    assert all(each.even for each in scene_walks.media_of(replace(SCENES["sphere"], height=1000.0), surface))


def test_walks_on_the_chart_are_on_the_default_bake_alone():
    assert not list(walked_methods(MethodChain((900,), 0, (Choice(cells=4),))))
    found = list(walked_methods(MethodChain((900,), 0, (Choice(),))))
    assert len({method.name for method in found}) == len(found)
    assert {method.family for method in found} == {"random walks, plain", "random walks, guided"}
    for method in found:
        told = json.loads(json.dumps(method.settings))
        assert pde_of(told) is None
        assert walks_judge(told)
        assert records.kind({"name": method.name, "settings": told}) == "walks"
        assert not method.moves
    judged = [m for m in engine_methods(MethodChain((900,), 0, (Choice(),))) if walks_judge(m.settings)]
    assert {method.choice for method in judged} == {Choice()}
    assert any(method.sweeps for method in judged)


def of_family(family: str, took: float, error: float, truth: str, **settings) -> dict:
    one = point(family, 0, 1e3 * took, error)
    one["settings"] |= {"bake": "default", "motion": False} | settings
    one["errors"] = {"pde": None, "transport": None, "walks": None} | {truth: {"whole": error}}
    one["stages"] = {"solve": 1e3 * took}
    return one


def compared(*points: dict) -> list[equal_error.EqualError]:
    return equal_error.of(record(("bunny",))["scenes"][0] | {"points": list(points)})


def test_path_tracing_is_given_the_time_that_its_noise_needs():
    """By the quicker variant; where a picture comes no closer than 2%, to 2%."""
    traced = [of_family("path tracing", t, e, "transport", variant="scalar_rgb") for t, e in ((2, 0.1), (8, 0.05))]
    traced.append(of_family("path tracing", 8, 0.04, "transport", variant="llvm_ad_rgb"))
    ours = [of_family("converging picture", t, e, "transport", converge=0.01) for t, e in ((5, 0.03), (20, 0.02))]
    (found,) = compared(*traced, *ours)
    assert (found.error, found.seconds, found.other) == (0.02, 20, "path tracing, llvm_ad_rgb")
    assert found.other_seconds == pytest.approx(32)
    assert found.times == pytest.approx(1.6)
    (found,) = compared(*traced[:2], *ours, of_family("converging picture", 40, 0.005, "transport", converge=0.01))
    assert (found.error, found.seconds) == (0.01, 40)
    assert found.other_seconds == pytest.approx(8 * 25)


def test_seconds_are_of_the_processor_where_both_have_them():
    """Other programs make the clock on the wall run longer, for one method more than for the other."""
    traced = of_family("path tracing", 900, 0.02, "transport", variant="scalar_rgb") | {"processor_s": 16.0}
    ours = of_family("converging picture", 70, 0.01, "transport", converge=0.01) | {"processor_s": 8.0}
    (found,) = compared(traced, ours)
    assert (found.processor, found.seconds, found.other_seconds) == (True, 8.0, pytest.approx(64))
    (found,) = compared(traced | {"processor_s": None}, ours)
    assert (found.processor, found.seconds, found.other_seconds) == (False, 70, pytest.approx(3600))


def test_times_of_walks_lie_between_those_that_were_measured():
    plain = [of_family("random walks, plain", t, e, "walks", seconds=t) for t, e in ((1, 0.04), (4, 0.02), (16, 0.005))]
    guided = [of_family("random walks, guided", t, e, "walks", seconds=t) for t, e in ((1, 0.02), (4, 0.01))]
    solve = of_family("fem, SP₃, inter-reflection, corrected", 3, 0.02, "walks")
    moving = of_family("fem, SP₃, inter-reflection, corrected", 1, 0.002, "walks", motion=True)
    found = {row.method: row for row in compared(*plain, *guided, solve, moving)}
    assert set(found) == {"fem, SP₃, inter-reflection, corrected · level 0 · fmg-pcg", "random walks, guided"}
    assert found["random walks, guided"].seconds == pytest.approx(4)
    assert found["random walks, guided"].other_seconds == pytest.approx(8)
    of_solve = found["fem, SP₃, inter-reflection, corrected · level 0 · fmg-pcg"]
    assert (of_solve.error, of_solve.other_seconds) == (0.02, pytest.approx(4))


def test_a_record_without_such_points_has_no_table(tmp_path, capsys):
    path = tmp_path / "chart.json"
    told = record(("bunny",))
    for more in ([], [of_family("path tracing", 8, 0.05, "transport", variant="scalar_rgb")]):
        told["scenes"][0]["points"] += more
        path.write_text(json.dumps(told))
        assert cli.main(["chart", "--from", str(path)]) == 0
        assert "at equal error" not in capsys.readouterr().out
    told["scenes"][0]["points"].append(of_family("converging picture", 20, 0.01, "transport", converge=0.01))
    path.write_text(json.dumps(told))
    assert cli.main(["chart", "--from", str(path)]) == 0
    assert "at equal error" in capsys.readouterr().out
