"""Pictures of a ball that scatters forwards, beside random walks that leave it towards the camera."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import quadgraph
from baked import write_levels
from shapes import icosphere

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
monte_carlo = pytest.importorskip("quadgraph_validation.truth.monte_carlo", reason="needs the extra walks")
Medium = pytest.importorskip("quadgraph_validation.bodies.media").Medium

RADIUS, ALBEDO, ETA, G = 3.0, 0.6, 1.3, 0.9  # reduced mean free paths; a dark, thin body
WALKS, WIDE = 600_000, 4.0  # degrees to either side of the direction that counts as towards the camera
MISSED = {25.0: 1.3, 110.0: 0.85}  # degrees from the light: what the reduced coefficient shows is beyond this share


@cache
def exits_of_all() -> monte_carlo.Exits:
    """Where all walks leave the ball."""
    medium = Medium(ALBEDO / (1 - G), 1 - ALBEDO)
    return monte_carlo.through_sphere(medium, RADIUS, ETA, WALKS, np.random.default_rng(7), G)


def walked(degrees: float) -> tuple[float, float]:
    """Mean radiance that the whole disc sends to a direction so far from the light, in 1 W/mm^2 along -z, and its
    relative standard error.
    """
    exits = exits_of_all()
    angle = np.degrees(np.arccos(np.clip(exits.direction[:, 2], -1, 1)))
    count = int((exits.scattered & (abs(angle - degrees) < WIDE)).sum())
    low, high = np.radians([degrees - WIDE, degrees + WIDE])
    per_count = monte_carlo.entering_sphere(RADIUS, ETA) / WALKS / (2 * np.pi * (np.cos(low) - np.cos(high)))
    return count * per_count / (np.pi * RADIUS**2), count**-0.5


def test_light_that_scatters_forwards_is_seen_where_it_goes(tmp_path, short):
    """Towards the light there is less of it than the reduced coefficient says, to the side more."""
    path = write_levels(tmp_path / "ball.qgraph", [icosphere(4, RADIUS), icosphere(3, RADIUS)])
    with quadgraph.Engine(path, device="cpu") as engine:
        engine.lights = ["directional:0,0,-1:1"]

        def seen(g: float) -> list[float]:
            engine.material = quadgraph.Material(ALBEDO, 1 - ALBEDO, ETA, g=g)
            engine.solve(sweep_points=5000 if short else 20_000)
            found = []
            for degrees in MISSED:
                way = np.radians(degrees)
                eye = (100 * float(np.sin(way)), 0.0, 100 * float(np.cos(way)))
                view = {"eye": eye, "look_at": (0.0, 0.0, 0.0), "orthographic": 2.2 * RADIUS, "up": "y"}
                picture = engine.render(view, width=32, height=32, transmission_roughness=0)
                found.append(float(picture.scattered[..., 0].sum() / picture.alpha.sum()))
            return found

        for (degrees, missed), found, plain in zip(MISSED.items(), seen(G), seen(0.0), strict=True):
            truth, noise = walked(degrees)
            assert noise < 0.025
            assert abs(found / truth - 1) < 0.05 + 3 * noise
            reduced = plain / truth
            assert reduced > missed if missed > 1 else reduced < missed
