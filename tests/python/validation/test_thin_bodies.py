"""A body that bends within few mean free paths: what leaves it in every direction, against random walks."""

from __future__ import annotations

import numpy as np
import pytest

from quadgraph.file import graph_file
from quadgraph_validation.bodies import meshes
from quadgraph_validation.bodies.media import media
from quadgraph_validation.truth import monte_carlo

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

RADIUS = 3.0  # mm, 2.3 mean free paths of red
WALKS = 400_000
BAND = 0.05  # of the cosine from the light, to either side
DISTANCE, FOV, PIXELS = 300.0, 1.5, 96


def intensity(engine, angle: float) -> np.ndarray:
    """Radiant intensity (3,), W/sr, at `angle` degrees from where the light comes from."""
    found = engine.render(view=f"{angle},0,{DISTANCE}", vertical_fov=FOV, width=PIXELS, height=PIXELS)
    pixel = 2 * DISTANCE * np.tan(np.radians(FOV / 2)) / PIXELS
    return np.asarray(found.scattered, np.float64).sum(axis=(0, 1)) * pixel**2


def test_a_small_ball_of_skin_sends_as_much_light_everywhere_as_random_walks(tmp_path):
    from quadgraph import _core

    ball = meshes.ball(RADIUS, 1)
    engine = _core.Engine(graph_file.write(tmp_path / "ball.qgraph", [ball]))
    skin = media("skin1")
    count = len(ball.nodes)
    engine.set_optical(
        0,
        np.tile(np.float32([m.sigma_s_prime for m in skin]), (count, 1)),
        np.tile(np.float32([m.sigma_a for m in skin]), (count, 1)),
        1.0,
    )
    cosine = np.clip(meshes.face_frames(ball)[1][:, 2], 0, 1)
    engine.set_irradiance(0, np.repeat(cosine[:, None], 3, axis=1).astype(np.float32), (0.0, 0.0, -1.0))
    engine.solve(model="sp3")
    walks = [
        monte_carlo.through_sphere(m, RADIUS, 1.0, WALKS, np.random.default_rng(c + 1)) for c, m in enumerate(skin)
    ]
    power = monte_carlo.entering_sphere(RADIUS, 1.0) / WALKS
    for angle in (35.0, 70.0, 110.0):
        found, at = intensity(engine, angle), np.cos(np.radians(angle))
        for c, exits in enumerate(walks):
            passing = exits.scattered & (np.abs(exits.direction[:, 2] - at) < BAND)
            truth = passing.sum() * power / (2 * np.pi * 2 * BAND)
            noise = 1 / np.sqrt(passing.sum())
            assert abs(found[c] / truth - 1) < 0.02 + 3 * noise
