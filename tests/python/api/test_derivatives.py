"""Derivatives of outgoing light: each other's transpose, the slope of what the engine itself solves, and refusals."""

from __future__ import annotations

import numpy as np
import pytest

import quadgraph
from baked import write_levels
from quadgraph.base.errors import InputError
from shapes import icosphere, join, moved

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")


@pytest.fixture(scope="module")
def engine(tmp_path_factory):
    """A ball in two lights."""
    path = write_levels(tmp_path_factory.mktemp("ball") / "ball.qgraph", [icosphere(2, 8), icosphere(1, 8)])
    with quadgraph.Engine(path, device="cpu") as engine:
        engine.material = "skin1,eta=1.3"
        engine.lights = [
            quadgraph.DirectionalLight(direction=(0.3, -0.2, -1), irradiance=(1, 0.8, 0.6)),
            quadgraph.PointLight(position=(20, 5, 3), power=(900, 500, 700)),
        ]
        engine.solve(tolerance=1e-6, correction=False, model="sp3", method="fem")
        yield engine


def views(engine: quadgraph.Engine) -> quadgraph.Views:
    """From every fifth face, a little off its normal."""
    surface = engine.surface()
    faces = np.arange(0, len(surface.normal), 5)
    way = surface.normal[faces] + np.array([0.2, 0.1, -0.1])
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    return quadgraph.Views(faces, way, np.full((len(faces), 3), 1 / 3))


def dot(a: tuple, b: tuple) -> float:
    return float(sum((x * y).sum() for x, y in zip(a, b, strict=True)))


def test_forward_and_adjoint_are_transposed(engine):
    model = engine.forward_model(views=views(engine), tolerance=1e-13)
    rng = np.random.default_rng(5)
    along = [rng.normal(size=each.shape) for each in model.vjp()]
    weights = [rng.normal(size=each.shape) for each in model.outgoing]
    change, gradient = model.jvp(*along), model.vjp(*weights)
    size = np.sqrt(dot(change, change) * dot(weights, weights))
    assert abs(dot(change, weights) - dot(gradient, along)) <= 1e-11 * size


def test_the_slope_is_that_of_differences(engine):
    model = engine.forward_model(views=views(engine), tolerance=1e-13)
    rng = np.random.default_rng(6)
    along = [rng.normal(size=model.sigma_a.shape) * each for each in (model.sigma_s_prime, model.sigma_a)]
    slope = model.jvp(*along)
    sides = []
    for step in (1e-4, -1e-4):
        moved = (model.sigma_s_prime + step * along[0], model.sigma_a + step * along[1])
        sides.append(
            engine.forward_model(sigma_s_prime=moved[0], sigma_a=moved[1], views=views(engine), tolerance=1e-13)
        )
    for name in quadgraph.Outgoing._fields:
        found = (getattr(sides[0].outgoing, name) - getattr(sides[1].outgoing, name)) / 2e-4
        wanted = getattr(slope, name)
        assert np.linalg.norm(found - wanted) <= 1e-5 * max(np.linalg.norm(wanted), 1e-12), name


def test_a_change_of_the_engine_is_as_foretold(engine):
    """The power that leaves, by the device in single precision, against the derivative; evening out keeps it."""
    area = engine.surface().area[:, None]
    weights = np.repeat(area, 3, axis=1)
    before = engine.solve(tolerance=1e-6, correction=False, model="sp3", method="fem").energy.scattered_out
    model = engine.forward_model()
    assert (area * model.outgoing.exitance).sum(axis=0) == pytest.approx(before, rel=1e-3)
    share = 0.02
    gradient = model.vjp(exitance=weights)
    foretold = share * (gradient.sigma_a * model.sigma_a).sum(axis=0)
    scattering, absorption = model.sigma_s_prime[0], model.sigma_a[0]
    engine.set_coefficients(lambda _points: (scattering, (1 + share) * absorption), eta=1.3)
    after = engine.solve(tolerance=1e-6, correction=False, model="sp3", method="fem").energy.scattered_out
    engine.material = "skin1,eta=1.3"
    engine.solve(tolerance=1e-6, correction=False, model="sp3", method="fem")
    assert (foretold < 0).all()
    assert after - before == pytest.approx(foretold, rel=0.03)


def test_exitance_grows_with_power_and_is_linear_in_it(engine):
    model = engine.forward_model(bounces=False)
    count = len(model.vjp().power)
    both = model.jvp(power=np.ones((count, 3)))
    assert both.exitance == pytest.approx(model.outgoing.exitance, rel=1e-9)


def test_light_is_solved_for_the_powers_that_are_given(engine):
    """Both by the same factor change what leaves by it; by different ones it still grows with both."""
    once, factor = engine.forward_model(), np.array([1.5, 0.5, 2])
    assert (once.power == 1).all()
    both = engine.forward_model(power=np.tile(factor, (2, 1)))
    assert both.outgoing.exitance == pytest.approx(factor * once.outgoing.exitance, rel=1e-6)
    apart = engine.forward_model(power=[[1.5, 0.5, 2], [0.25, 3, 1]])
    assert apart.jvp(power=apart.power).exitance == pytest.approx(apart.outgoing.exitance, rel=1e-6)
    assert not np.allclose(apart.outgoing.exitance, factor * once.outgoing.exitance, rtol=0.01)


def test_bounces_are_on_the_level_that_knows_what_its_faces_see(tmp_path):
    """Two balls, one of which shines on the other; of small levels it is the finest."""
    levels = [join(ball, moved(ball, 18, 0, 0)) for ball in (icosphere(2, 8), icosphere(1, 8))]
    path = write_levels(tmp_path / "balls.qgraph", levels, rays=64)
    with quadgraph.Engine(path, device="cpu") as engine:
        engine.material = "marble"
        engine.solve(correction=False)
        mutual, own, coarse = (engine.forward_model(**each) for each in ({}, {"bounces": False}, {"level": 1}))
        assert (mutual.bounces, own.bounces, coarse.bounces) == (True, False, False)
        assert (mutual.outgoing.exitance.sum(axis=0) > 1.001 * own.outgoing.exitance.sum(axis=0)).all()
        with pytest.raises(InputError, match="bounces: level 0 of the file knows what its faces see, not level 1"):
            engine.forward_model(level=1, bounces=True)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"level": 2}, "level: 2 found, 0 to 1 allowed"),
        ({"tolerance": 0.0}, "tolerance: 0 found"),
        ({"sigma_a": np.ones((3, 3))}, r"sigma_a: shape \(3, 3\) found"),
        ({"sigma_a": "much"}, "sigma_a: text found"),
        ({"sigma_s_prime": -1}, r"sigma_s_prime: shape \(\) found"),
        ({"power": np.ones((3, 3))}, r"power: shape \(3, 3\), expected \(2, 3\)"),
        ({"power": -np.ones((2, 3))}, r"power\[0\]: -1.0+, allowed is 0 to"),
        ({"model": "p9"}, "p9"),
        ({"views": quadgraph.Views([0], [[0, 0, 0]], [[1, 0, 0]])}, "samples\\[0\\]: a direction into the body"),
        ({"views": quadgraph.Views([10**6], [[0, 0, 1]], [[1, 0, 0]])}, "samples\\[0\\]: face 1000000"),
        ({"views": quadgraph.Views([-1], [[0, 0, 1]], [[1, 0, 0]])}, "views: face"),
    ],
)
def test_what_does_not_fit_is_refused(engine, options, message):
    with pytest.raises(InputError, match=message):
        engine.forward_model(**options)


def test_weights_and_directions_of_other_shapes_are_refused(engine):
    model = engine.forward_model()
    with pytest.raises(InputError, match=r"exitance: shape \(1, 3\) found, \(320, 3\) is wanted"):
        model.vjp(exitance=np.ones((1, 3)))
    with pytest.raises(InputError, match="sigma_a: numbers that are not finite"):
        model.jvp(sigma_a=np.full(model.sigma_a.shape, np.nan))


def test_a_body_that_is_deformed_or_not_solved_is_refused(engine, tmp_path):
    path = write_levels(tmp_path / "ball.qgraph", [icosphere(1, 8)])
    with quadgraph.Engine(path, device="cpu") as other:
        other.material = "marble"
        with pytest.raises(InputError, match="no solution"):
            other.forward_model()
        other.set_deformation([quadgraph.Twist(degrees=20)])
        other.solve(correction=False)
        with pytest.raises(InputError, match="the body is deformed"):
            other.forward_model()


def test_the_operator_alone_answers_for_what_lies_deep_and_not_for_what_lights_and_views_meet(engine):
    """Through 30 mean free paths neither light nor a view comes; where they enter and leave, they are much of it."""
    surface = views(engine)
    model = engine.forward_model(views=surface, tolerance=1e-12)
    dense = [np.full_like(model.sigma_a, value) for value in (10.0, 0.01)]
    model = engine.forward_model(sigma_s_prime=dense[0], sigma_a=dense[1], views=surface, tolerance=1e-12)
    weights = np.ones_like(model.outgoing.radiance)
    whole, operator = model.vjp(radiance=weights), model.vjp(radiance=weights, only_operator=True)
    corners = np.linalg.norm(model.vertices[model.tets], axis=2)
    deep = corners.max(axis=1) < 5  # mm from the middle of 8
    assert deep.sum() > 10
    for name in ("sigma_a", "sigma_s_prime"):
        own, part = getattr(whole, name), getattr(operator, name)
        off = np.abs(own - part)
        assert off[deep].max() < 1e-5 * np.abs(own[deep]).max(), name
        assert off[~deep].max() > 0.05 * np.abs(own[~deep]).max(), name
    assert not operator.power.any()


def test_what_enters_is_what_the_solve_says(engine):
    model = engine.forward_model()
    solution = engine.solve(tolerance=1e-6, correction=False, model="sp3", method="fem")
    assert (engine.surface().area[:, None] * model.entering).sum(axis=0) == pytest.approx(solution.energy.entered, 1e-4)
    lit = (model.entering > 0).any(axis=1)
    assert 0.3 < lit.mean() < 0.9
