"""The study of the light's error: its truth where it is known in closed form, and its measures."""

from __future__ import annotations

import numpy as np
import pytest

from quadgraph.api.lights import AmbientLight, DirectionalLight, PointLight, RectangleLight, SpotLight
from quadgraph.base.errors import InputError
from quadgraph_validation.accuracy import light_study
from quadgraph_validation.truth import face_light
from shapes import cube, icosphere, join, moved


def on_top(light, eta: float = 1.0, shade: bool = False) -> np.ndarray:
    """q of the two upper triangles of a cube of 2 mm about the origin; `shade`: under a ball."""
    body = moved(cube(2.0), *(-cube(2.0).vertices.mean(axis=0)))
    top = (body.corners[..., 2] > 0.99).all(axis=1)
    if shade:
        body = join(body, moved(icosphere(2, 6.0), 0, 0, 20))
    return face_light.entering(body, light, eta, 256, seed=2)[: len(top)][top]


def test_the_truth_is_the_closed_form_where_there_is_one():
    slanting = DirectionalLight((0.0, 0.6, -0.8), 3.0)
    assert on_top(slanting) == pytest.approx(2.4, rel=1e-6)
    assert (on_top(slanting, eta=1.5) < 2.4 * 0.97).all()
    far = PointLight((0.0, 0.0, 1001.0), 4 * np.pi * 1e6)
    assert on_top(far) == pytest.approx(1.0, rel=1e-3)
    # Near the axis of a Lambertian rectangle, far away: power / pi over the square of the distance.
    lamp = RectangleLight((0.0, 0.0, 1001.0), (0.0, 2.0, 0.0), (2.0, 0.0, 0.0), np.pi * 1e6)
    assert on_top(lamp) == pytest.approx(1.0, rel=1e-3)
    narrow = SpotLight((0.0, 0.0, 1001.0), (0.0, 0.0, -1.0), 60.0, 1.0, edge=0.0)
    assert on_top(narrow) == pytest.approx(1e-6 / (2 * np.pi * 0.5), rel=1e-2)


def test_the_truth_is_dark_in_a_shadow_and_refuses_a_sky():
    assert (on_top(DirectionalLight((0.0, 0.0, -1.0), 1.0), shade=True) == 0).all()
    with pytest.raises(InputError, match="AmbientLight found, wanted is a directional"):
        on_top(AmbientLight(1.0))


def test_errors_are_those_of_means_over_patches_by_part():
    exitance = np.repeat(np.array([4.0, 4.0, 1.0, 1.0])[:, None], 3, axis=1)
    field = {"area": np.ones(4), "exitance": exitance, "q": exitance * [[1], [1], [0], [0]]}
    change = np.array([0.4, -0.4, 0.2, 0.0])[:, None] * np.ones(3)
    found = light_study.errors(field, change, np.array([0, 0, 1, 2]))
    assert found["whole"] == pytest.approx(0.2 / np.sqrt(34))  # of the first two the mean is right
    assert found["unlit"] == pytest.approx(0.2 / np.sqrt(2))


def test_only_errors_that_are_told_are_judged():
    rows = [
        {"true": dict.fromkeys(light_study.PARTS, true), "printed": dict.fromkeys(light_study.PARTS, printed)}
        for true, printed in ((0.01, 0.015), (0.01, 0.03), (1e-5, 0.1))
    ]
    assert light_study.summary(rows)["whole"] == {
        "cases": 2,
        "within": 0.5,
        "least": pytest.approx(1.5),
        "greatest": pytest.approx(3.0),
    }
