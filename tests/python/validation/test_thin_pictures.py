"""Pictures of bodies of few mean free paths, corrected by transport, beside walks from the camera."""

from __future__ import annotations

import numpy as np
import pytest

from baked import write_levels
from quadgraph import Engine, Picture
from quadgraph.mesh.surface import Surface
from shapes import icosphere, join, moved

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
camera_walks = pytest.importorskip("quadgraph_validation.truth.camera_walks", reason="needs the extra walks")
known_material = pytest.importorskip("quadgraph_validation.truth.known_material")

AMBIENT = {"type": "ambient", "irradiance": 1.0}
PIXELS, BLOCK, WALKS = 32, 4, 1000


def blocks(picture: np.ndarray) -> np.ndarray:
    """(h, w): means over blocks of pixels."""
    side = PIXELS // BLOCK
    return picture.reshape(side, BLOCK, side, BLOCK).mean(axis=(1, 3))


def taken(tmp_path, surface: Surface, material: str, eye: tuple, fov: float) -> Picture:
    """By the engine, in even light, with its correction."""
    write_levels(tmp_path / "body.qgraph", [surface], rays=64)
    with Engine(tmp_path / "body.qgraph", device="cpu") as engine:
        engine.material = material
        engine.lights = ["ambient:1"]
        engine.solve()
        camera = {"eye": tuple(eye), "look_at": (0.0, 0.0, 0.0), "fov": fov, "up": "y"}
        return engine.render(camera, width=PIXELS, height=PIXELS, transmission_roughness=0)


def off(tmp_path, surface: Surface, sigma_s: float, sigma_a: float, eta: float, eye: tuple) -> tuple[float, float]:
    """Relative RMS of the engine's blocks, without the walks' noise, and the ratio of the means."""
    place = np.array(eye, float)
    fov = 2.1 * np.degrees(np.arcsin(np.linalg.norm(surface.vertices, axis=1).max() / np.linalg.norm(place)))
    even = known_material.KnownMaterial.even(np.full(3, sigma_s), np.full(3, sigma_a), eta)
    walker = camera_walks.CameraWalker(surface, [AMBIENT])
    seen_from = camera_walks.Eye(place, np.zeros(3), fov, "y", PIXELS, PIXELS)
    truth = walker.see(seen_from, 0, even.in_channel(0), eta, WALKS, 8, lambda _share: None)
    picture = taken(tmp_path, surface, f"sigma_s_prime={sigma_s},sigma_a={sigma_a},eta={eta}", eye, fov)
    inside = blocks(picture.alpha) > 0.999
    wanted, found = blocks(truth.radiance[0])[inside], blocks(picture.scattered[..., 0])[inside]
    noise = (blocks(truth.noise[0] ** 2)[inside] / BLOCK**2).sum()
    size = (wanted**2).sum() - noise
    return float(np.sqrt(max(((found - wanted) ** 2).sum() - noise, 0) / size)), float(found.sum() / wanted.sum())


def test_a_body_that_absorbs_nothing_cannot_be_told_from_what_is_around_it(tmp_path):
    """Index-matched, two mean free paths across: what it scatters to the eye stands for what it hides, everywhere."""
    ball = icosphere(4, 10.0)
    lens = Surface(ball.vertices * (1, 0.5, 0.25), ball.triangles)
    picture = taken(tmp_path, lens, "sigma_s_prime=0.4,sigma_a=0,eta=1", (0.0, 12.0, 50.0), 24.0)
    inside = picture.alpha > 0.999
    seen = np.pi * picture.scattered[inside] + picture.transmittance[inside]
    assert 0.1 < picture.transmittance[inside].min() < 0.2
    assert np.abs(seen - 1).max() < 0.03
    assert abs(seen.mean() - 1) < 0.01


def test_light_comes_in_from_all_sides(tmp_path):
    """A ball of four mean free paths in even light: most of what scatters in it came from another side."""
    rms, ratio = off(tmp_path, icosphere(3, 10.0), 0.03, 0.12, 1.4, (0.0, 12.0, 50.0))
    assert rms < 0.02
    assert abs(ratio - 1) < 0.01


def test_what_comes_through_from_another_part_counts_once(tmp_path):
    """Two lenses one behind the other, each of one mean free path."""
    ball = icosphere(3, 10.0)
    lens = Surface(ball.vertices * (1, 1, 0.2), ball.triangles)
    rms, ratio = off(tmp_path, join(moved(lens, 0, 0, -3), moved(lens, 0, 0, 3)), 0.2, 0.05, 1.3, (0.0, 10.0, 60.0))
    assert rms < 0.02
    assert abs(ratio - 1) < 0.02
