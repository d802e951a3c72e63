"""Pictures that converge on the chart: what was timed is what is judged, and what they state stands beside."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from chart_bodies import Baked, ball, chart_ball
from chart_records import point, record
from quadgraph import cli
from quadgraph_validation.bodies.scene_bakes import Choice
from quadgraph_validation.bodies.scenes import PIXELS, View
from quadgraph_validation.chart import chart_measure as measuring
from quadgraph_validation.chart import chart_page, static_chart
from quadgraph_validation.chart import chart_record as records
from quadgraph_validation.chart.chart_body import ChartBody
from quadgraph_validation.chart.chart_judge import ChartJudge
from quadgraph_validation.chart.chart_method import MethodChain, pde_of, walks_judge
from quadgraph_validation.chart.converging_method import ERRORS, ConvergingMethod, converging_methods
from quadgraph_validation.chart.engine_methods import EngineMethod
from quadgraph_validation.truth.stored_truth import StoredTruth

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

__all__ = ["ball"]

VIEWS = {"A": View(70, 15, 46, ()), "B": View(160, 15, 46, ())}
BALL = chart_ball(VIEWS)


def body_of(ball: Path) -> ChartBody:
    return ChartBody(BALL, ball, ball.parent, "cpu", 2 * PIXELS, {Choice(): Baked(ball)})


@pytest.fixture
def body(ball) -> ChartBody:
    return body_of(ball)


@pytest.fixture(scope="module")
def converged(ball) -> dict[float, tuple[dict, np.ndarray]]:
    """What is stated of both views, and the picture of the first, by what was asked for."""
    body, found = body_of(ball), {}
    for asked in (0.2, 0.015):
        method = ConvergingMethod(choice=Choice(), converge=asked)
        method.prepare(body)
        assert method.frame(0)["converging picture"] > 0
        first, _ = (method.picture(view) for view in VIEWS)
        found[asked] = method.stated(), first
    return found


def test_the_picture_that_is_judged_is_the_one_that_was_timed(body, monkeypatch):
    method = ConvergingMethod(choice=Choice(), converge=0.2)
    method.prepare(body)
    sizes = []
    show = EngineMethod._show
    monkeypatch.setattr(EngineMethod, "_show", lambda self, *a, **b: (sizes.append(a), show(self, *a, **b))[1])
    method.frame(0)
    first, again = method.picture("A"), method.picture("A")
    method.picture("B")
    assert sizes == [(VIEWS[view].text, 2 * PIXELS) for view in "AB"]
    assert np.array_equal(first, again)
    assert first.shape == (PIXELS, PIXELS, 3)
    whole = np.asarray(method._shown["A"].scattered, float)
    assert first[40:42, 60].mean() == pytest.approx(whole[80:84, 120:122].mean(), rel=1e-9)


@pytest.mark.long
def test_a_smaller_error_takes_more_solves_and_is_stated(converged):
    told = {asked: stated for asked, (stated, _) in converged.items()}
    for asked, stated in told.items():
        assert set(stated["views"]) == set(VIEWS)
        for view in stated["views"].values():
            assert view["reached"] == (view["error"]["whole"] <= asked)
            assert view["reached"] or view["limit"]
        parts = [view["error"]["whole"] for view in stated["views"].values()]
        assert min(parts) <= stated["whole"] <= max(parts)
    assert told[0.015]["whole"] < told[0.2]["whole"]
    solves = {asked: stated["views"]["A"]["solves"] for asked, stated in told.items()}
    assert solves[0.015] > solves[0.2] == 1


@pytest.mark.long
def test_pictures_to_two_errors_differ_by_no_more_than_both_state(converged, body):
    coarse, fine = (picture for _, picture in converged.values())
    inside = body.coverage("A") > 0.999
    off = np.sqrt(((coarse - fine)[inside] ** 2).mean() / (fine[inside] ** 2).mean())
    assert 0 < off < sum(stated["views"]["A"]["error"]["whole"] for stated, _ in converged.values())


def test_what_it_states_is_in_the_record_beside_what_is_true(body):
    method = ConvergingMethod(choice=Choice(), converge=0.2)
    method.prepare(body)
    method.frame(0)
    images = {}
    for name, image in body.scene.images.items():
        images[name] = StoredTruth.empty({}, PIXELS, PIXELS)
        for _ in range(2):
            images[name].add(1.25 * method.picture(image.view)[..., image.channel])
    judge = ChartJudge(body, {}, images)
    points = measuring.measure(body, judge, [method, EngineMethod(level=1, cycles=1)], 1, lambda text: None)
    assert not [one.failed for one in points if one.failed]
    told, other = (one.record() for one in points)
    assert told["errors"]["transport"]["whole"] == pytest.approx(0.2, rel=1e-3)
    assert told["stated"]["whole"] == method.stated()["whole"]
    assert told["processor_s"] > 0
    assert other["processor_s"] is None
    assert (told["errors"]["pde"], told["errors"]["walks"], told["motion"]) == (None, None, None)
    assert records.stated(told) > 0
    assert records.stated(other) is None


def test_on_the_chart_they_are_on_the_default_bake_alone():
    assert not list(converging_methods(MethodChain((900,), 0, (Choice(cells=4), Choice(7000, 0.3)))))
    found = list(converging_methods(MethodChain((900,), 0, (Choice(), Choice(cells=4)))))
    assert [method.name for method in found] == [
        "converging picture · default bake · to 4%",
        "converging picture · default bake · to 2%",
        "converging picture · default bake · to 1%",
    ]
    assert len({method.family for method in found}) == 1
    for method, asked in zip(found, ERRORS, strict=True):
        told = json.loads(json.dumps(method.settings))
        assert (told["converge"], told["bake"], told["sweeps"]) == (asked, "default", "auto")
        assert pde_of(told) is None
        assert not walks_judge(told)
        assert records.kind({"name": method.name, "settings": told}) == "converging"
        assert not method.moves


@pytest.fixture
def with_stated(tmp_path) -> Path:
    """A record with two points that state of themselves less, and more, than is true."""
    told = record(("bunny",))
    view = {"error": {"whole": 0.03}, "solves": 5, "sweeps": 3, "seconds": 9.0, "noise": 0.01}
    for asked, stated in ((0.04, 0.015), (0.01, 0.06)):
        one = point("converging picture", 0, 90 / asked, 0.01)
        one["settings"] |= {"bake": "default", "converge": asked}
        one["stated"] = {"whole": stated, "views": {"A": view}}
        told["scenes"][0]["points"].append(one)
    path = tmp_path / "chart.json"
    path.write_text(json.dumps(told))
    return path


def test_bars_go_from_true_errors_to_stated_ones_in_the_panel_of_pictures(with_stated):
    whole, unlit = records.panels(records.read(with_stated)["scenes"][0])[2:4]
    own = [(true, said) for true, said in zip(whole.errors, whole.stated, strict=True) if true != said]
    assert sorted(own) == [(0.03, 0.015), (0.03, 0.06)]
    assert unlit.stated == unlit.errors


def test_page_drawing_and_table_show_what_is_stated(with_stated, tmp_path, capsys):
    told = records.read(with_stated)
    page = chart_page.write(tmp_path / "chart.html", told).read_text()
    assert "states 1.5% of its pictures itself (A: 5 solves of 3 sweeps)" in page
    assert '"arrayminus"' in page
    drawn = [static_chart.write(tmp_path / name, told)[0].read_bytes() for name in ("with",)]
    for one in told["scenes"][0]["points"]:
        one.pop("stated", None)
    drawn.append(static_chart.write(tmp_path / "without", told)[0].read_bytes())
    assert drawn[0] != drawn[1]
    assert cli.main(["chart", "--from", str(with_stated)]) == 0
    rows = [line for line in capsys.readouterr().out.splitlines() if line.strip("│ ").startswith("converging picture")]
    assert [next(text for text in ("1.5%", "6%") if f" {text} " in row) for row in rows] == ["1.5%", "6%"]
