"""Pictures of two bodies, of which one stands in the other's light, beside Mitsuba's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from quadgraph import Camera, Engine, Material
from test_bodies_by_walks import APART, DARK, LIGHTS, NEXT, PALE, pair

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
pytest.importorskip("mitsuba", reason="Mitsuba is not installed: pip install './python/validation[truth]'")
from quadgraph_validation.bodies import scenes
from quadgraph_validation.truth import blocks, path_tracing

__all__ = ["pair"]

VIEW = scenes.View(35, 10, 75, ())
WIDE = 80.0  # mm, of a cell that holds all of one body
BATCHES = 24


def halves(ball: Material, other: Material) -> scenes.Grid:
    """One material on the ball's side of the gap, the other on that of the ring."""
    low = np.array([(APART + NEXT) / 2 - WIDE, -WIDE, -WIDE])
    cells = [np.full((2, 2, 2), one, np.float32) for one in (ball.sigma_s_prime, ball.sigma_a)]
    for of_cell, one in zip(cells, (other.sigma_s_prime, other.sigma_a), strict=True):
        of_cell[:, :, 1] = one
    return scenes.Grid(low, WIDE, *cells)


@pytest.mark.long
@pytest.mark.parametrize(("ball", "other"), [(PALE, DARK), (DARK, PALE)], ids=["pale-ball", "dark-ball"])
@pytest.mark.parametrize("light", ["sun", "sky"])
def test_two_bodies_look_as_mitsuba_sees_them(pair, ball, other, light):
    """Without a change of the index: blocks of four pixels within 3% RMS."""
    path, surface, _ = pair
    one, two = replace(ball, eta=1.0), replace(other, eta=1.0)
    with Engine(path) as engine:
        engine.materials = {"ball": one, "ring": two}
        engine.lights = [LIGHTS[light]]
        engine.solve()
        camera = Camera(azimuth=VIEW.azimuth, elevation=VIEW.elevation, distance=VIEW.distance, fov=scenes.FOV)
        picture = engine.render(camera, width=scenes.PIXELS, height=scenes.PIXELS, transmission_roughness=0)
    shown = np.array(picture.scattered + picture.unscattered)[..., 0]
    sun = tuple(LIGHTS[light].direction) if light == "sun" else None
    scene = scenes.StudyScene("two", "", 1.0, scenes.even, WIDE, sun, {"A": VIEW}, 20.0)
    with path_tracing.tracer(scene, surface, halves(one, two), "A") as tracer:
        batches = np.array([tracer.batch(number) for number in range(BATCHES)])
    noise = batches.std(axis=0, ddof=1) / np.sqrt(BATCHES)
    off = blocks.deviation(shown, batches.mean(axis=0), noise, blocks.covered(np.array(picture.alpha)))
    print(f"\n{light}: {100 * off.rms:.2f}% off, noise {100 * off.noise:.2f}%, mean {off.mean:.3f}")
    assert off.noise < 0.015
    assert off.rms < 0.03
    assert off.mean == pytest.approx(1, abs=0.02)
