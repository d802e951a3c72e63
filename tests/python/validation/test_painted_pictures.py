"""Pictures of a body in the colours of its texture beside random walks, and Mitsuba's, in the same coefficients."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from baked import write_levels
from coloured_files import GREEN, RED, coloured_glb, encoded, srgb, textured
from quadgraph.api.engine import Engine
from quadgraph.api.lights import AmbientLight
from quadgraph.api.materials import VolumeMaterial
from quadgraph.api.options import Camera
from quadgraph.baking.colours.colour_options import ColourOptions
from quadgraph.baking.colours.colour_volume import mesh_colours
from shapes import icosphere

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
pytest.importorskip("quadgraph_validation.truth.camera_walks", reason="needs the extra walks")
from quadgraph_validation.bodies import scenes
from quadgraph_validation.truth import blocks, camera_walks, known_material, path_tracing

PIXELS = 32
DISTANCE, FOV = 60.0, 24.0
BALL = icosphere(5, 10)


def painted(folder: Path, eta: float) -> tuple[Path, VolumeMaterial]:
    """A ball of 20 mm in a texture of four fields, and its colours with a mean free path of 1 mm."""
    fields = srgb(np.array([[RED, GREEN], [GREEN, RED]]))
    pixels = np.repeat(np.repeat(fields, 32, axis=0), 32, axis=1)
    mesh = coloured_glb(folder / "ball.glb", BALL, textured(), encoded(pixels))
    body = write_levels(folder / "ball.qgraph", [BALL, icosphere(4, 10), icosphere(3, 10)])
    return body, mesh_colours(mesh, body, ColourOptions(mean_free_path=1, eta=eta))[0]


def engine_picture(
    body: Path, material: VolumeMaterial, pixels: int = PIXELS, fov: float = FOV
) -> tuple[np.ndarray, np.ndarray]:
    """Radiance (h, w, 3) of light that was in the body, W/(mm^2 sr), and coverage (h, w)."""
    with Engine(body, device="cpu") as engine:
        engine.material = material
        engine.lights = [AmbientLight(irradiance=np.pi)]
        engine.solve()
        camera = Camera(azimuth=0, elevation=0, distance=DISTANCE, fov=fov)
        picture = engine.render(camera, width=pixels, height=pixels, transmission_roughness=0)
        return np.array(picture.scattered) + picture.unscattered, np.array(picture.alpha)


def test_a_painted_ball_looks_as_walks_see_it(tmp_path, short):
    """Blocks of four pixels within 3% RMS in each channel, in even light, behind a smooth surface of index 1.3."""
    body, material = painted(tmp_path, 1.3)
    shown, alpha = engine_picture(body, material)
    found = known_material.KnownMaterial(
        material.sigma_s_prime, material.sigma_a, 1.3, np.array(material.origin), np.full(3, material.spacing)
    )
    eye = camera_walks.Eye(np.array([0.0, 0.0, DISTANCE]), np.zeros(3), FOV, "y", PIXELS, PIXELS)
    walker = camera_walks.CameraWalker(BALL, [{"type": "ambient", "irradiance": np.pi}])
    for channel in range(3):
        seen = walker.see(eye, channel, found.in_channel(channel), 1.3, 256 if short else 512, 3, lambda _share: None)
        check(shown[..., channel], seen.radiance[0], seen.noise[0], alpha)


def check(shown: np.ndarray, truth: np.ndarray, noise: np.ndarray, alpha: np.ndarray) -> None:
    off = blocks.deviation(shown, truth, noise, blocks.covered(alpha))
    assert off.noise < 0.03
    assert off.rms < 0.03, off
    assert off.mean == pytest.approx(1, abs=0.02)


@pytest.mark.long
def test_a_painted_ball_looks_as_mitsuba_sees_it(tmp_path):
    """The same without a change of the index, the coefficients as a grid volume of Mitsuba's: its cells, not linear."""
    pytest.importorskip("mitsuba", reason="Mitsuba is not installed: pip install './python/validation[truth]'")
    body, material = painted(tmp_path, 1.0)
    shown, alpha = engine_picture(body, material, scenes.PIXELS, scenes.FOV)
    low = np.array(material.origin) - material.spacing / 2
    view = scenes.View(0, 0, DISTANCE, ())
    scene = scenes.StudyScene("painted", "", 1.0, scenes.even, material.spacing, None, {"A": view}, 20.0)
    for channel in range(3):
        cells = (material.sigma_s_prime[..., channel], material.sigma_a[..., channel])
        grid = scenes.Grid(low, material.spacing, *cells)
        with path_tracing.tracer(scene, BALL, grid, "A") as tracer:
            batches = np.array([tracer.batch(number) for number in range(4)]) * np.pi
        noise = batches.std(axis=0, ddof=1) / np.sqrt(len(batches))
        check(shown[..., channel], batches.mean(axis=0), noise, alpha)
