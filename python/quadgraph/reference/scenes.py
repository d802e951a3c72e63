"""Real bodies under a known light from known places: what path tracing and the engine both render."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from quadgraph.surface import Surface

HEIGHT_MM = 100.0  # of every body, along y
PIXELS = 128  # width and height of every picture
FOV = 30.0  # degrees, vertical

# Positions (..., 3) mm to sigma_s' and sigma_a, both (...,) 1/mm.
Coefficients = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class View:
    """A view of the middle of the bounding box, as engine/render/camera.h defines it, y up: degrees, degrees, mm.

    scan: rows of pixels that figures draw as lines; effort: batches of samples that it gets for each one of the easiest
    view, for a dark side needs more.
    """

    azimuth: float
    elevation: float
    distance: float
    scan: tuple[int, ...]
    effort: int = 1

    @property
    def text(self) -> str:
        """What the engine reads."""
        return f"{self.azimuth:g},{self.elevation:g},{self.distance:g}"


@dataclass(frozen=True)
class Scene:
    """A body of the shared meshes, its optical properties, one light of 1 W/mm^2 and the views.

    voxel: mm, edge of the cubes within which path tracing takes the coefficients of their middle as constant;
    direction: the way the light travels, (3,); None: even light from everywhere.
    """

    name: str
    mesh: str
    eta: float
    coefficients: Coefficients
    voxel: float
    direction: tuple[float, float, float] | None
    views: dict[str, View]

    @property
    def light(self) -> str:
        """What the engine reads."""
        if self.direction is None:
            return "ambient:1"
        return f"directional:{','.join(f'{x:g}' for x in self.direction)}:1"


@dataclass(frozen=True)
class Grid:
    """Coefficients of the cubes that cover a body: sigma_s' and sigma_a (nz, ny, nx) float32, 1/mm.

    low: (3,) mm, the corner where the first cube begins; voxel: mm.
    """

    low: np.ndarray
    voxel: float
    sigma_s_prime: np.ndarray
    sigma_a: np.ndarray

    @property
    def extent(self) -> np.ndarray:
        """(3,) mm along x, y, z."""
        return self.voxel * np.array(self.sigma_a.shape[::-1])


def grid_of(scene: Scene, surface: Surface) -> Grid:
    """Sample the scene's coefficients in the middle of every cube; cubes begin at multiples of their edge."""
    low = np.floor(surface.vertices.min(axis=0) / scene.voxel) * scene.voxel
    count = np.ceil((surface.vertices.max(axis=0) - low) / scene.voxel).astype(int)
    axes = [low[k] + scene.voxel * (np.arange(count[k]) + 0.5) for k in (2, 1, 0)]
    z, y, x = np.meshgrid(*axes, indexing="ij")
    sigma_s_prime, sigma_a = scene.coefficients(np.stack([x, y, z], axis=-1))
    return Grid(low, scene.voxel, sigma_s_prime.astype(np.float32), sigma_a.astype(np.float32))


def bounding_sphere(surface: Surface) -> tuple[np.ndarray, float]:
    """Middle (3,) of the bounding box and the distance of the farthest vertex from it, mm."""
    centre = (surface.vertices.min(axis=0) + surface.vertices.max(axis=0)) / 2
    return centre, float(np.linalg.norm(surface.vertices - centre, axis=1).max())


def camera_axes(view: View) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Unit vectors (3,) to the right, up and from the body to the eye."""
    azimuth, elevation = np.radians([view.azimuth, view.elevation])
    sine, cosine = np.sin(azimuth), np.cos(azimuth)
    backward = np.array([sine * np.cos(elevation), np.sin(elevation), cosine * np.cos(elevation)])
    up = np.array([-sine * np.sin(elevation), np.cos(elevation), -cosine * np.sin(elevation)])
    return np.cross(up, backward), up, backward


def description(scene: Scene, view: str, mesh_sha256: str, grid: Grid) -> dict[str, Any]:
    """Everything of the scene that a picture of it depends on, ready for JSON."""
    digest = hashlib.sha256()
    for values in (grid.low.astype(np.float64), grid.sigma_s_prime, grid.sigma_a):
        digest.update(repr(values.shape).encode() + np.ascontiguousarray(values).tobytes())
    camera = {name: value for name, value in asdict(scene.views[view]).items() if name not in ("scan", "effort")}
    return {
        "scene": scene.name,
        "view": view,
        "camera": camera | {"vertical_fov": FOV, "pixels": PIXELS},
        "mesh": {"name": scene.mesh, "sha256": mesh_sha256, "height_mm": HEIGHT_MM},
        "eta": scene.eta,
        "coefficients": {"voxel_mm": grid.voxel, "sha256": digest.hexdigest()},
        "light": scene.light,
    }


def checker(position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cells of 12 mm that absorb weakly and strongly by turns."""
    odd = np.floor(position / 12).sum(axis=-1) % 2 == 1
    return np.ones(odd.shape), np.where(odd, 0.1, 0.005)


def veins(position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Smooth dark veins in a body that scatters more and less by turns along its height."""
    x, y, z = np.moveaxis(2 * np.pi * position, -1, 0)
    vein = (0.5 + 0.5 * np.sin(x / 30 + 1.5 * np.sin(y / 35) + 1.2 * np.sin(z / 28 + 1))) ** 3
    return 1 + 0.3 * np.sin(y / 40 + np.sin(x / 50)), 0.002 + 0.03 * vein


def even(position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same everywhere."""
    shape = position.shape[:-1]
    return np.ones(shape), np.full(shape, 0.01)


SCENES = {
    scene.name: scene
    for scene in (
        Scene(
            "bunny",
            "bunny.ply",
            1.0,
            checker,
            12.0,
            (-0.5, -0.5, -0.7),
            {"A": View(20, 15, 230, (38, 90)), "B": View(245, 20, 230, (24, 50), effort=4)},
        ),
        Scene(
            "fertility",
            "fertility.ply",
            1.0,
            veins,
            1.0,
            (-0.6, -0.5, -0.6),
            {"A": View(15, 20, 280, (46, 78)), "B": View(150, 15, 280, (46, 74), effort=3)},
        ),
        Scene("spot", "spot.ply", 1.3, even, 12.0, None, {"A": View(35, 10, 265, (40, 84))}),
    )
}
