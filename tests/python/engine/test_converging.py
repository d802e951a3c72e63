"""Pictures that run on to an error: the mean of solves whose samples are others, with a noise that is known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import quadgraph
from baked import write_levels
from quadgraph.api.lights import AmbientLight, DirectionalLight
from quadgraph.base.errors import InputError
from shapes import icosphere

MATERIAL = "sigma_s_prime=.3,sigma_a=0.02,eta=1.3"
QUICK = {"sweep_points": 500}
SEEN = {"width": 48, "height": 48, "samples": 4}


@pytest.fixture(scope="module")
def ball(tmp_path_factory) -> Path:
    return write_levels(tmp_path_factory.mktemp("ball") / "ball.qgraph", [icosphere(2, 10), icosphere(1, 10)])


@pytest.fixture
def engine(ball):
    with quadgraph.Engine(ball, device="cpu") as made:
        made.material, made.lights = MATERIAL, [DirectionalLight((0.0, 0.0, -1.0), 1.0)]
        yield made


def least_of(engine) -> float:
    """What a picture of the ball can have."""
    engine.solve(**QUICK)
    return engine.render(converge=1e-4, **SEEN).convergence.least


def test_a_picture_with_the_error_that_is_asked_for_is_left_as_it_is(engine):
    engine.solve(**QUICK)
    plain, found = engine.render(**SEEN), engine.render(converge=0.9, **SEEN)
    assert plain.convergence is None
    assert plain.standard_error is None
    assert found.convergence.reached
    assert len(found.convergence.steps) == 1
    assert found.standard_error is None
    assert np.array_equal(found.scattered, plain.scattered)


def test_solves_join_the_mean_until_the_error_is_reached(engine):
    engine.solve(**QUICK)
    first = engine.render(**SEEN).error.whole
    wanted = 0.5 * (first + least_of(engine))
    engine.solve(**QUICK)
    picture = engine.render(converge=wanted, **SEEN)
    found = picture.convergence
    assert found.reached
    assert found.limit == ""
    assert found.steps[0].error.whole == pytest.approx(first)
    assert picture.error == found.steps[-1].error
    assert picture.error.whole <= wanted < found.steps[-2].error.whole
    assert found.steps[-1].solves == len(found.steps) - 1
    assert found.steps[-1].samples == 4 * found.steps[-1].solves
    assert engine.solution.error.whole <= found.steps[0].error.whole


def test_what_cannot_be_reached_ends_with_what_limits_it(engine):
    engine.solve(**QUICK)
    found = engine.render(converge=0.001, **SEEN).convergence
    assert not found.reached
    assert not found.out_of_time
    assert found.least > 0.001
    assert found.steps[-1].error.whole < 1.1 * found.least
    assert "more sweeps and samples would leave" in found.limit


def test_a_limit_of_time_keeps_the_picture_that_there_is(engine):
    engine.solve(**QUICK)
    picture = engine.render(converge=1e-4, time_limit=1e-3, **SEEN)
    assert picture.convergence.out_of_time
    assert not picture.convergence.reached
    assert picture.convergence.limit.startswith("no time is left")
    assert picture.scattered.any()


def test_the_standard_error_is_what_two_pictures_differ_by(engine):
    """Of an index-matched ball, which reflects nothing: where it is seen on a face has little to say."""
    engine.material = "sigma_s_prime=.3,sigma_a=0.02,eta=1"
    pictures = []
    for seed in (0, 500):
        engine.solve(sweep_seed=seed, **QUICK)
        pictures.append(engine.render(converge=1e-4, **(SEEN | {"samples": 16})))
    inside = pictures[0].alpha == 1
    stated = np.sqrt(sum((each.standard_error[inside] ** 2).mean() for each in pictures))
    differ = np.sqrt(((pictures[0].scattered - pictures[1].scattered)[inside] ** 2).mean())
    assert pictures[0].standard_error.shape == (48, 48, 3)
    assert 0.5 < stated / differ < 2
    assert (pictures[0].standard_error[pictures[0].alpha == 0] == 0).all()


def test_light_from_all_around_enters_by_other_rays_in_every_solve(engine):
    """So its part of the error falls with their number."""
    engine.lights = [AmbientLight(1.0)]
    alone = engine.solve(**QUICK).light_error.whole
    steps = engine.render(converge=1e-4, **SEEN).convergence.steps
    assert engine.solution.light_error.whole == pytest.approx(alone / np.sqrt(steps[-1].solves), rel=0.05)


def test_a_picture_after_one_that_converged_is_of_one_solve_again(engine):
    engine.solve(**QUICK)
    before = engine.render(**SEEN)
    engine.render(converge=1e-4, **SEEN)
    after = engine.render(**SEEN)
    assert after.error == before.error
    assert np.allclose(after.scattered, before.scattered, rtol=1e-4)


@pytest.mark.parametrize(
    ("solve", "picture", "said"),
    [
        ({"correction": False}, {}, "error of this picture is not known"),
        ({}, {"radiance": "lambertian"}, "error of this picture is not known"),
        ({}, {"show": "phi"}, "error of this picture is not known"),
        ({"certify": 0.1}, {}, "found with certify"),
        ({}, {"converge": 0.0, "time_limit": 3.0}, "without converge"),
        ({}, {"converge": 1.5}, "converge"),
    ],
)
def test_what_has_no_error_does_not_converge(engine, solve, picture, said):
    engine.solve(**(QUICK | solve))
    with pytest.raises(InputError, match=said):
        engine.render(**(SEEN | {"converge": 0.01} | picture))
