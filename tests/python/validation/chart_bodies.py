"""A ball for tests of methods on the default bake, which nothing has to bake."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest

from baked import write_levels
from quadgraph_validation.bodies.scenes import StudyScene, View, of_medium
from shapes import icosphere

RADIUS = 10.0  # mm


class Baked:
    """A bake that is there."""

    def __init__(self, path: Path):
        self.path = path

    def made(self) -> Path:
        return self.path


def chart_ball(views: Mapping[str, View]) -> StudyScene:
    """The scene: the red of ketchup in every channel, one beam."""
    coefficients = of_medium([0.18] * 3, [0.061] * 3)
    return StudyScene("ball", "", 1.3, coefficients, 4.0, (0.0, 0.0, -1.0), dict(views), 2 * RADIUS, True)


@pytest.fixture(scope="module")
def ball(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("ball") / "ball.qgraph"
    return write_levels(path, [icosphere(3, RADIUS), icosphere(2, RADIUS)])
