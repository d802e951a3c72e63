"""Steadiness of the chart's methods: frames of the engine while light and camera move, and such as come late."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from baked import write_levels
from quadgraph_validation.bodies import scenes
from quadgraph_validation.chart import chart_measure as measuring
from quadgraph_validation.chart import motion_measure
from quadgraph_validation.chart.chart_body import ChartBody, light_at, view_at
from quadgraph_validation.chart.chart_judge import ChartJudge
from quadgraph_validation.chart.engine_methods import EngineMethod
from quadgraph_validation.truth.truth_run import TracedSubject
from shapes import icosphere

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

SPHERE = scenes.SCENES["sphere"]
TURNED = replace(SPHERE, direction=(-0.8, -0.2, -0.6))


@pytest.fixture(scope="module")
def ball(tmp_path_factory) -> Path:
    return write_levels(tmp_path_factory.mktemp("motion") / "ball.qgraph", [icosphere(3, 10.0), icosphere(2, 10.0)])


@pytest.fixture
def body(ball) -> ChartBody:
    surface = icosphere(3, 10.0)
    original = TracedSubject(TURNED, Path(), surface, (scenes.grid_of(TURNED, surface),), "")
    return ChartBody(TURNED, ball, ball.parent, "cpu", 64, original=original)


@dataclass
class LateMethod(EngineMethod):
    """Shows the light of some frames ago, from where the camera was one frame ago."""

    late: float = 1.0

    def moving(self, step):
        (found,) = self.at_rest(step + self.late, [step + 1], 0)
        return found


def test_light_and_camera_arrive_with_the_last_frame():
    assert view_at(TURNED, 0) == next(iter(TURNED.views.values()))
    assert view_at(TURNED, 3).azimuth == view_at(TURNED, 0).azimuth - 3
    assert light_at(TURNED, 0).split(":")[1].startswith("-0.8,")
    assert motion_measure._STEPS[-1] == 0


def test_a_method_that_is_late_is_found_to_be(body):
    course = motion_measure.MotionCourse(body)
    found = course.steadiness(LateMethod(late=2.0))
    # A light that turns does not change pictures evenly: all of it to a twentieth.
    assert found["lag"]["light"]["frames"] == pytest.approx(2, abs=0.1)
    assert found["lag"]["camera"]["frames"] == pytest.approx(1, abs=0.1)
    assert found["flicker"] < 0.01


def test_what_is_solved_anew_each_frame_is_steady_and_one_cycle_nearly(body):
    course = motion_measure.MotionCourse(body)
    for method, bound in ((EngineMethod(), 0.02), (EngineMethod(cycles=1), 0.2)):
        found = course.steadiness(method)
        assert found["flicker"] < 0.002
        assert abs(found["lag"]["light"]["frames"]) < bound
        assert abs(found["lag"]["camera"]["frames"]) < bound


@pytest.mark.long
def test_corrections_in_motion_flicker_more_than_what_has_no_noise(body):
    course = motion_measure.MotionCourse(body)
    moving = course.steadiness(EngineMethod(sweeps=1, cycles=1, motion=True))
    plain = course.steadiness(EngineMethod(cycles=1))
    print(f"corrected in motion {moving}, uncorrected {plain}")
    assert plain["flicker"] < moving["flicker"] < 0.05
    assert abs(moving["lag"]["camera"]["frames"]) < 0.2


def test_what_moves_is_judged_so_and_recorded(body):
    methods = [EngineMethod(cycles=1), EngineMethod(level=1, cycles=1)]
    judge = ChartJudge(body, {}, {})
    points = measuring.measure(body, judge, methods, 1, lambda text: None)
    first, second = measuring.scene_record(body, judge, points)["points"]
    assert set(first["motion"]["lag"]) == set(motion_measure.MOVEMENTS)
    assert second["motion"] is None
    untraced = replace(body, original=None)
    assert measuring.measure(untraced, judge, methods[:1], 1, lambda text: None)[0].motion is None
    assert np.isfinite(first["motion"]["flicker"])
