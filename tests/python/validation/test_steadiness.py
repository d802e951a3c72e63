"""Flicker and lag on sequences of pictures where both are known."""

from __future__ import annotations

import numpy as np
import pytest

from quadgraph_validation.truth.steadiness import ConvergedFrames, flicker, lag

FRAMES, BLOCKS = 9, 400


@pytest.fixture
def generator():
    return np.random.default_rng(11)


def course(generator, steps):
    """Pictures (t, n) at times (t,) of a light and of a camera that go their ways evenly, one frame a step."""
    base, by_light, by_camera = generator.random((3, BLOCKS))
    return lambda light, camera: base + 3 + 0.05 * np.outer(light, by_light) + 0.04 * np.outer(camera, by_camera), steps


@pytest.fixture
def moved(generator):
    """The pictures of now, what they differ by that are one frame late, and how to make others."""
    at, steps = course(generator, np.arange(FRAMES, dtype=float))
    now = at(steps, steps)
    return at, steps, ConvergedFrames(now, now), [at(steps - 1, steps) - now, at(steps, steps - 1) - now]


def test_frames_that_have_converged_are_steady(moved):
    _, _, converged, earlier = moved
    assert flicker(converged.mean, converged) == 0
    assert lag(converged.mean, converged, earlier).frames == pytest.approx([0, 0], abs=1e-12)


def test_frames_that_are_late_lag_by_as_much_and_do_not_flicker(moved):
    at, steps, converged, earlier = moved
    late = at(steps - 1.5, steps + 0.25)
    assert flicker(late, converged) == pytest.approx(0, abs=1e-12)
    found = lag(late, converged, earlier)
    assert found.frames == pytest.approx([1.5, -0.25], abs=1e-10)
    assert found.error == pytest.approx([0, 0], abs=1e-10)


def test_what_is_wrong_in_the_same_way_all_along_is_neither(moved, generator):
    """But for what of it looks like a movement, which another pattern hardly does."""
    _, _, converged, earlier = moved
    wrong = converged.mean + generator.choice([-0.01, 0.01], BLOCKS)
    assert flicker(wrong, converged) == pytest.approx(0, abs=1e-12)
    assert np.abs(lag(wrong, converged, earlier).frames).max() < 0.2


def test_independent_noise_flickers_by_its_size_times_the_root_of_two(moved, generator):
    _, _, converged, earlier = moved
    size = 0.02 * np.sqrt(converged.square)
    noisy = converged.mean + size * generator.standard_normal((FRAMES, BLOCKS))
    assert flicker(noisy, converged) == pytest.approx(0.02 * np.sqrt(2), rel=0.06)  # four standard errors
    found = lag(noisy, converged, earlier)
    assert (np.abs(found.frames) < 5 * found.error).all()


def test_frames_that_go_up_and_down_flicker_by_twice_their_height(moved):
    _, _, converged, _ = moved
    scale = np.sqrt(converged.square)
    shaken = converged.mean + 0.03 * scale * (-1.0) ** np.arange(FRAMES)[:, None]
    assert flicker(shaken, converged) == pytest.approx(0.06, rel=1e-10)


def test_noise_of_what_frames_converge_to_is_not_theirs(moved, generator):
    """Steady frames against pictures that are noisier than they, in two estimates: they flicker by nothing, and are as
    late as they are.
    """
    at, steps, converged, earlier = moved
    scale, late = np.sqrt(converged.square), at(steps - 1, steps)
    squares, lags = [], []
    for _ in range(40):
        noise = 0.05 * scale * generator.standard_normal((2, FRAMES, BLOCKS))
        halves = ConvergedFrames(*(converged.mean + noise))
        squares.append(flicker(late, halves) ** 2)
        lags.append(lag(late, halves, earlier).frames)
    # One estimate alone would say .05 sqrt(2), and half of the squares are cut off at 0.
    assert np.sqrt(np.mean(squares)) < 0.02
    assert np.mean(lags, axis=0) == pytest.approx([1, 0], abs=0.1)


def test_standard_errors_of_the_lag_are_what_it_scatters_by(moved, generator):
    _, _, converged, earlier = moved
    found = [
        lag(converged.mean + 0.1 * generator.standard_normal((FRAMES, BLOCKS)), converged, earlier) for _ in range(200)
    ]
    scatter = np.std([each.frames for each in found], axis=0)
    stated = np.sqrt(np.mean([each.error**2 for each in found], axis=0))
    assert stated == pytest.approx(scatter, rel=0.2)
