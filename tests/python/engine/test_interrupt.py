"""Device work that a signal gives up half-way: with light that meets the body again and a sky, which tests of the
engine alone leave out (tests/cpp/render/interrupt_test.cpp).
"""

from __future__ import annotations

import signal

import numpy as np
import pytest

import quadgraph
from baked import write_levels
from light_truth import write_hdr
from quadgraph.api.deformers import Twist
from shapes import torus


class GivenUpError(Exception):
    """What the alarm's handler throws."""


@pytest.fixture(scope="module")
def ring(tmp_path_factory):
    surfaces = [torus(around=32, across=16), torus(around=20, across=10)]
    path = write_levels(tmp_path_factory.mktemp("ring") / "ring.qgraph", surfaces, rays=32)
    write_hdr(path.with_name("sky.hdr"), np.linspace(0.1, 1, 32 * 16 * 3).reshape(16, 32, 3))
    return path


@pytest.fixture
def alarm():
    """Throws GivenUpError in the main thread after so many seconds."""

    def throw(number, frame):
        raise GivenUpError

    before = signal.signal(signal.SIGALRM, throw)
    yield lambda seconds: signal.setitimer(signal.ITIMER_REAL, seconds)
    signal.setitimer(signal.ITIMER_REAL, 0)
    signal.signal(signal.SIGALRM, before)


def engine_on(path, material="marble"):
    engine = quadgraph.Engine(path, device="cpu")
    engine.material, engine.lights = material, ["directional:1,0,0:1", f"environment:{path.with_name('sky.hdr')}:0:.2"]
    return engine


@pytest.mark.parametrize(
    ("method", "twisted"),
    [pytest.param("fem", False, marks=pytest.mark.long), ("fem", True), ("shortest-path", False)],
)
def test_after_an_exception_amid_its_work_an_engine_answers_as_a_new_one(ring, alarm, method, twisted):
    how = {"method": method, "solver": "dpcg"} | ({"sweeps": 1, "sweep_points": 2000} if method == "fem" else {})

    def prepare(engine):
        engine.set_deformation([Twist(degrees=30)] if twisted else [])

    def answer(engine):
        engine.solve(**how)
        return engine.render(width=32, height=24).scattered

    with engine_on(ring) as fresh:
        prepare(fresh)
        expected = answer(fresh)
    given_up = 0
    with engine_on(ring, "skin1") as tried:
        answer(tried)
        tried.material = "marble"
        prepare(tried)
        for seconds in np.geomspace(0.002, 0.4, 8):
            try:
                alarm(seconds)
                answer(tried)
                alarm(0)
            except GivenUpError:
                given_up += 1
            assert np.array_equal(answer(tried), expected)
    assert given_up > 0


def test_signals_are_heeded_while_fluence_is_looked_up(ring):
    """Without a look at them in between all of a call's would be one, at its end."""
    heard = []
    before = signal.signal(signal.SIGALRM, lambda number, frame: heard.append(number))
    try:
        with engine_on(ring) as engine:
            engine.solve(cycles=1, correction=False)
            points = np.full((2_000_000, 3), (10, 0, 0), np.float32)
            signal.setitimer(signal.ITIMER_REAL, 0.001, 0.001)
            engine.fluence_at(points)
            signal.setitimer(signal.ITIMER_REAL, 0)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert len(heard) > 3
