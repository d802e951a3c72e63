"""The study of dense balls: its measures on exitances that are known, and what it finds."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from quadgraph_validation.accuracy import dense_study

BAND = (60, 75)


@pytest.fixture
def angle():
    return np.linspace(55, 80, 4001)


def test_a_smooth_exitance_does_not_scatter_and_noise_does(angle):
    smooth = np.cos(np.radians(angle))[:, None] * [1.0, 0.5, 0.1]
    assert max(dense_study._scatter(angle, smooth, BAND)) < 1e-4
    noisy = smooth * np.random.default_rng(3).normal(1, 0.05, smooth.shape)
    assert dense_study._scatter(angle, noisy, BAND) == pytest.approx([0.05] * 3, rel=0.1)


def test_the_bias_is_of_the_band_alone(angle):
    truth = np.cos(np.radians(angle))[:, None] * [1.0, 0.5, 0.1]
    found = np.where(((angle >= BAND[0]) & (angle < BAND[1]))[:, None], 1.2, 7.0) * truth
    assert dense_study._bias(angle, found, truth, BAND) == pytest.approx([0.2] * 3)


def test_the_shaken_ball_is_a_ball_without_symmetry():
    ball = dense_study.surface_of(40, 3, 3)
    assert np.linalg.norm(ball.vertices, axis=1) == pytest.approx(np.full(642, 40.0))
    area = np.linalg.norm(ball.doubled_normals, axis=1) / 2
    assert area.sum() == pytest.approx(4 * np.pi * 40**2, rel=0.01)
    assert len(np.unique(area.round(9))) == len(area)


@pytest.mark.long
@pytest.mark.parametrize(("material", "scatter"), [("wholemilk", 0.01), ("marble", 0.01), ("skin1", 0.12)])
def test_lit_sides_are_even_and_the_printed_error_is_the_error(material, scatter):
    row = dense_study.run("cpu", Path(), [material])["rows"][0]
    assert max(row["scatter"][0]) < scatter
    for part in ("whole", "unlit"):
        assert row["true"][part] < 1.5 * row["printed"][part]
