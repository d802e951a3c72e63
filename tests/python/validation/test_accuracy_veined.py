"""The study of a veined bunny: its veins, lights and cameras, how pictures are judged, and a small one recovered."""

from __future__ import annotations

import numpy as np
import pytest

from quadgraph_validation.accuracy import veined_study
from quadgraph_validation.accuracy.veined_study import VeinedRun

MIDDLE = np.array([1.0, 2.0, 3.0])


def test_veins_are_those_of_their_seed_and_fill_a_part_of_the_body():
    points = np.random.default_rng(1).uniform(-20, 20, (20_000, 3))
    for seed in (1, 2, 3):
        share = veined_study.veins(points, seed)
        np.testing.assert_array_equal(share, veined_study.veins(points, seed))
        assert share.min() >= 0
        assert 0.99 < share.max() <= 1
        assert 0.1 < share.mean() < 0.6
        scattering, absorption = veined_study.truth(points, seed)
        assert (scattering >= veined_study.SCATTERING).all()
        assert absorption.max(axis=0) == pytest.approx(4 * veined_study.ABSORPTION, rel=0.02)
    assert not np.allclose(veined_study.veins(points, 1), veined_study.veins(points, 2))


def test_lights_stand_around_and_shine_at_the_middle():
    lights = veined_study.lights(MIDDLE)
    assert len(lights) == veined_study.LIGHTS + veined_study.HELD_OUT
    ways = []
    for light in lights:
        centre, u, v = (np.array(light[name]) for name in ("centre", "u", "v"))
        towards = MIDDLE - centre
        assert np.linalg.norm(towards) == pytest.approx(150, rel=1e-5)
        assert np.cross(u, v) @ towards == pytest.approx(120**2 * 150, rel=1e-4)
        ways.append(-towards / 150)
    between = np.array(ways) @ np.array(ways).T - 2 * np.eye(len(ways))
    assert between.max() < np.cos(np.radians(20))  # none stands where another does
    assert np.linalg.norm(np.mean(ways[: veined_study.LIGHTS], axis=0)) < 0.1


def test_cameras_look_at_the_middle_from_all_around():
    cameras = veined_study.cameras(MIDDLE, 20).values()
    ways = np.array([np.array(each["eye"]) - MIDDLE for each in cameras])
    assert np.linalg.norm(ways, axis=1) == pytest.approx([1.05 * 20 / np.sin(np.radians(12))] * len(ways), rel=1e-4)
    assert np.linalg.norm(ways[:, ::2].mean(axis=0)) < 1e-3 * np.linalg.norm(ways[0])


def test_the_noise_of_the_truth_is_no_difference():
    random = np.random.default_rng(5)
    picture = np.zeros((40, 40, 3))
    picture[4:-4, 4:-4] = np.linspace(0.05, 1, 32)[:, None]
    spread = 0.1 * picture
    true = {("view", "light"): (picture + random.normal(size=picture.shape) * spread, spread)}
    same = veined_study.differences(true, {("view", "light"): (picture, spread)})
    assert max(same.values()) < 0.05  # of the noise, which is twice that
    assert veined_study.noise(true)["lit"] == pytest.approx(0.1, rel=0.03)
    brighter = veined_study.differences(true, {("view", "light"): (1.2 * picture, spread)})
    assert brighter["lit"] == pytest.approx(0.2, abs=0.02)
    assert brighter["far"] == pytest.approx(0.2, abs=0.05)


@pytest.mark.long
def test_a_small_one_is_recovered(monkeypatch):
    """Of few and coarse photographs, for the time."""
    for name, value in (("LIGHTS", 4), ("HELD_OUT", 1), ("VIEWS", 3), ("SIDE", 16), ("VERTICES", 800)):
        monkeypatch.setattr(veined_study, name, value)
    record = veined_study.run(VeinedRun(1, 1, 1000, "cpu"))
    (row,) = record["rows"]
    assert row["held_out"]["found"]["lit"] < 0.2
    assert row["held_out"]["truth"]["lit"] < 0.1
    assert veined_study.tables(record)[0].row_count == 1
