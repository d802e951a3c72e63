"""Captures of a body with known coefficients: the engine's pictures on another, finer mesh, with noise."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from baked import write_levels
from quadgraph import core
from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph.mesh.surface import Surface
from shapes import icosphere, write_obj

ETA = 1.3
TRUTH = {"sigma_a": [0.006, 0.02, 0.05], "sigma_s_prime": [1.1, 0.7, 0.9]}
CAMERAS = {
    "front": {"eye": [20, 20, 110], "look_at": [0, 0, 0], "fov": 24, "width": 40, "height": 40},
    "back": {"eye": [-70, 10, -80], "look_at": [0, 0, 0], "fov": 24, "width": 40, "height": 40},
}
LIGHTS = {
    "key": {"type": "rectangle", "centre": [60, 60, 60], "u": [80, 0, 0], "v": [0, -50, 50], "power": [1000, 900, 800]},
    "sun": {"type": "directional", "direction": [0.8, -0.2, -0.4], "irradiance": [0.03, 0.03, 0.04]},
}
READ_OUT, SHOT, WHITE = 0.001, 1e-4, 0.8


def potato(subdivisions: int) -> Surface:
    """A smooth body without symmetry, 38 mm across."""
    ball = icosphere(subdivisions, 18.0)
    x, y = ball.vertices[:, :1], ball.vertices[:, 1:2]
    return Surface(ball.vertices * [1, 0.8, 0.9] * (1 + 0.12 * np.sin(x / 6 + 1) + 0.1 * np.cos(y / 7)), ball.triangles)


def pebble(subdivisions: int) -> Surface:
    """A flat ellipsoid, 40 mm across."""
    ball = icosphere(subdivisions, 20.0)
    return Surface(ball.vertices * [1, 0.5, 0.8], ball.triangles)


def bodies(
    folder: Path, vertices: int = 800, finer: int = 4, shape: Callable[[int], Surface] = potato
) -> tuple[Path, Path]:
    """The body to fit on, baked coarsely, and the same shape in a finer mesh, of so many subdivisions."""
    mesh = write_obj(shape(4), folder / "potato.obj")
    bake(mesh, folder / "potato.qgraph", BakeOptions(unit="mm", surface_vertices=vertices))
    return folder / "potato.qgraph", write_levels(folder / "finer.qgraph", [shape(finer)])


def photographed(
    body: Path, material: Mapping[str, Any] | Path, lights: Mapping[str, Any], cameras: Iterable[Mapping[str, Any]]
) -> Iterator[np.ndarray]:
    """(h, w, 3) W/(mm^2 sr) of scattered light, by each camera; solved once."""
    stage = core.Stage("cpu")
    for number, camera in enumerate(cameras):
        document = {
            "body": str(body),
            "material": str(material) if isinstance(material, Path) else {**material, "eta": ETA},
            "lights": [lights],
            "camera": {name: value for name, value in camera.items() if name not in ("width", "height")},
            "picture": {"width": camera["width"], "height": camera["height"], "transmission_roughness": 0},
        }
        stage.show(core.scene_file(json.dumps(document)).at(0))
        if number == 0:
            stage.solve()
        yield np.array(stage.render().scattered, np.float64)


def write(folder: Path, material: Mapping[str, Any] | Path, seed: int, gains: bool = False) -> Path:
    """Photograph the finer body of `folder`, each light from each camera, and write capture.json for the coarser.

    gains: unknown, and 20% off.
    """
    generator = np.random.default_rng(seed)
    photographs = []
    for light, stated in LIGHTS.items():
        seen = photographed(folder / "finer.qgraph", material, stated, CAMERAS.values())
        for name, radiance in zip(CAMERAS, seen, strict=True):
            exposure = WHITE / radiance.max()
            value = exposure * radiance * (1 + gains * generator.uniform(-0.2, 0.2))
            value += generator.normal(size=value.shape) * np.sqrt(READ_OUT**2 + SHOT * value)
            file = f"{light}-{name}.npz"
            np.savez(folder / file, photograph=value)
            noise = {"read_out": READ_OUT, "shot": SHOT}
            entry = {"file": file, "camera": name, "lights": [light], "exposure": exposure, "noise": noise}
            photographs.append(entry if gains else entry | {"gain": 1})
    path = folder / "capture.json"
    path.write_text(json.dumps(document(photographs)))
    return path


def twin(folder: Path, seed: int, **meshes: Any) -> Path:
    """The folder with a capture of TRUTH with nothing wrong; meshes: as `bodies` takes them."""
    bodies(folder, **meshes)
    write(folder, TRUTH, seed)
    return folder


def document(photographs: list[dict[str, Any]]) -> dict[str, Any]:
    """A whole capture of these photographs."""
    fixed = {"quadgraph_capture": 1, "body": "potato.qgraph", "eta": ETA, "polarised": True}
    return copy.deepcopy(fixed | {"cameras": CAMERAS, "lights": LIGHTS, "photographs": photographs})
