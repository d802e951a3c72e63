"""The study of pictures of unseen bodies: its measures, what it draws, and one body by few walks."""

from __future__ import annotations

import numpy as np
import pytest

from quadgraph.api.lights import AmbientLight, RectangleLight

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
pytest.importorskip("quadgraph_validation.truth.camera_walks", reason="needs the extra walks")
pictures_study = pytest.importorskip("quadgraph_validation.accuracy.pictures_study")


def test_errors_are_relative_and_without_the_noise_of_the_truth():
    truth = np.array([1.0, 2.0, 4.0, 4.0, 4.0, 4.0])
    found = truth * [1.1, 0.9, 1, 1, 1, 1]
    exact = pictures_study.errors(found, truth, np.zeros(6))
    assert exact["whole"] == pytest.approx(np.sqrt(0.05 / 69))
    assert exact["dimmest"] == pytest.approx(np.sqrt(0.05 / 5))
    noisy = pictures_study.errors(found, truth, np.full(6, 0.05))
    assert noisy["whole"] == pytest.approx(np.sqrt((0.05 - 0.015) / (69 - 0.015)))
    assert pictures_study.errors(found, truth, np.full(6, 0.2))["whole"] == 0  # all of it may be noise


def test_parts_that_walks_cannot_tell_are_left_out_of_the_summary():
    rows = [
        {
            "noise": {"whole": noise, "dimmest": 0.2},
            "true": {way: {"whole": error, "dimmest": 9.0} for way in ways},
            "stated": {"rest": {"whole": 0.03, "dimmest": 0.03}},
        }
        for ways in [pictures_study.WAYS]
        for noise, error in ((0.01, 0.02), (0.01, 0.04), (0.03, 0.01), (0.3, 5.0))
    ]
    found = pictures_study.summary(rows)
    assert found["rest"]["whole"]["cases"] == 3
    assert found["rest"]["whole"]["errors"] == pytest.approx([0.02, 0.036, 0.04])
    assert found["rest"]["whole"]["ratios"] == pytest.approx([0.75, 1.125, 1.5])  # the third may be all noise
    assert found["rest"]["dimmest"] == {"cases": 0, "errors": [], "ratios": []}
    assert found["uncorrected"]["whole"]["ratios"] == []
    assert len(pictures_study.tables({"rows": [], "summary": found})) == 3


@pytest.mark.parametrize("seed", [101, 102, *(pytest.param(seed, marks=pytest.mark.long) for seed in range(103, 109))])
def test_lights_are_where_walks_from_the_body_meet_them(seed):
    sight = pictures_study.drawn(seed)
    vertices = sight.case.surface.vertices
    radius = np.linalg.norm(np.ptp(vertices, axis=0)) / 2
    assert np.linalg.norm(sight.eye - sight.look_at) == pytest.approx(3.2 * radius)
    light = sight.case.light
    if seed % 2 == 0:
        assert isinstance(light, AmbientLight)
        return
    assert isinstance(light, RectangleLight)
    normal = np.cross(light.u, light.v)
    normal /= np.linalg.norm(normal)
    assert ((vertices - light.centre) @ normal > 0).all()  # it shines towards every point of the body
    towards = sight.look_at - light.centre
    assert np.linalg.norm(towards) <= 2.5 * radius * 1.0001


@pytest.mark.long
def test_pictures_of_unseen_bodies_are_close_to_walks():
    record = pictures_study.run(pictures_study.PicturesRun(303, 4, 2500, "cpu"))
    assert all(row["noise"]["whole"] < 0.05 for row in record["rows"])
    median, _, worst = record["summary"]["rest"]["whole"]["errors"]
    assert median < 0.02
    assert worst < 0.05
    for row in record["rows"]:
        assert row["stated"]["rest"]["whole"] > 0.4 * row["true"]["rest"]["whole"]
    assert median < 0.5 * record["summary"]["uncorrected"]["whole"]["errors"][0]
