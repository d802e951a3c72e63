"""Real bodies under a known light from known places: what path tracing and the engine both render."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph.mesh.surface import Surface
from quadgraph_validation.bodies.media import media

HEIGHT_MM = 100.0  # of a body along y, unless its scene says otherwise
PIXELS = 128  # width and height of every picture
FOV = 30.0  # degrees, vertical

# Positions (..., 3) mm to sigma_s' and sigma_a in 1/mm, both (...,) of a grey scene and (..., 3) of a coloured one.
Coefficients = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class View:
    """A view of the middle of the bounding box, as engine/render/display/camera.h has it, y up: degrees, degrees, mm.

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
class Image:
    """One path-traced picture of a scene: a view in one of the engine's channels 0, 1, 2."""

    view: str
    channel: int = 0


@dataclass(frozen=True)
class StudyScene:
    """A body, its optical properties, one grey light of 1 W/mm^2 and the views.

    mesh: as scene_meshes.file finds it; voxel: mm, edge of the cubes within which path tracing takes the coefficients
    of their middle as constant; direction: the way the light travels, (3,); None: uniform light; height: mm
    along y; coloured: whether the coefficients differ by channel.
    """

    name: str
    mesh: str
    eta: float
    coefficients: Coefficients
    voxel: float
    direction: tuple[float, float, float] | None
    views: dict[str, View]
    height: float = HEIGHT_MM
    coloured: bool = False

    @property
    def images(self) -> dict[str, Image]:
        """Name to picture: a grey scene's views as they are, a coloured one's as VIEW-R, VIEW-G, VIEW-B."""
        if not self.coloured:
            return {view: Image(view) for view in self.views}
        return {f"{view}-{name}": Image(view, c) for view in self.views for c, name in enumerate("RGB")}

    def in_channels(self, position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """sigma_s' and sigma_a, both (n, 3) float64 in 1/mm, at (n, 3) positions in mm."""
        scattering, absorption = (np.asarray(value, np.float64) for value in self.coefficients(position))
        if self.coloured:
            return scattering, absorption
        return np.repeat(scattering[:, None], 3, axis=1), np.repeat(absorption[:, None], 3, axis=1)

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


def grid_of(scene: StudyScene, surface: Surface, channel: int = 0) -> Grid:
    """Sample the scene's coefficients in the middle of every cube; cubes begin at multiples of their edge."""
    low = np.floor(surface.vertices.min(axis=0) / scene.voxel) * scene.voxel
    count = np.ceil((surface.vertices.max(axis=0) - low) / scene.voxel).astype(int)
    axes = [low[k] + scene.voxel * (np.arange(count[k]) + 0.5) for k in (2, 1, 0)]
    z, y, x = np.meshgrid(*axes, indexing="ij")
    values = scene.coefficients(np.stack([x, y, z], axis=-1))
    of_channel = (np.asarray(value[..., channel] if scene.coloured else value, np.float32) for value in values)
    return Grid(low, scene.voxel, *of_channel)


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


def description(scene: StudyScene, image: str, mesh_sha256: str, grid: Grid) -> dict[str, Any]:
    """Everything of the scene that one of its images depends on, ready for JSON; grid: of the image's channel."""
    digest = hashlib.sha256()
    for values in (grid.low.astype(np.float64), grid.sigma_s_prime, grid.sigma_a):
        digest.update(repr(values.shape).encode() + np.ascontiguousarray(values).tobytes())
    camera = {
        name: value
        for name, value in asdict(scene.views[scene.images[image].view]).items()
        if name not in ("scan", "effort")
    }
    return {
        "scene": scene.name,
        "view": image,
        "camera": camera | {"vertical_fov": FOV, "pixels": PIXELS},
        "mesh": {"name": scene.mesh, "sha256": mesh_sha256, "height_mm": scene.height},
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
    """Homogeneous coefficients."""
    shape = position.shape[:-1]
    return np.ones(shape), np.full(shape, 0.01)


def of_medium(sigma_s_prime: Sequence[float], sigma_a: Sequence[float]) -> Coefficients:
    """Homogeneous coefficients, one value in 1/mm per channel."""

    def coefficients(position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        shape = (*position.shape[:-1], 3)
        return np.broadcast_to(sigma_s_prime, shape), np.broadcast_to(sigma_a, shape)

    return coefficients


def of_material(name: str) -> Coefficients:
    """A measured material in quadgraph_validation.bodies.media, the same everywhere."""
    channels = media(name)
    return of_medium([m.sigma_s_prime for m in channels], [m.sigma_a for m in channels])


def pale(position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The study `sphere`'s medium."""
    shape = position.shape[:-1]
    return np.full(shape, 2.0), np.full(shape, 0.01)


SCENES = {
    scene.name: scene
    for scene in (
        StudyScene(
            "bunny",
            "bunny.ply",
            1.0,
            checker,
            12.0,
            (-0.5, -0.5, -0.7),
            {"A": View(20, 15, 230, (38, 90)), "B": View(245, 20, 230, (24, 50), effort=4)},
        ),
        StudyScene(
            "fertility",
            "fertility.ply",
            1.0,
            veins,
            1.0,
            (-0.6, -0.5, -0.6),
            {"A": View(15, 20, 280, (46, 78)), "B": View(150, 15, 280, (46, 74), effort=3)},
        ),
        StudyScene("spot", "spot.ply", 1.3, even, 12.0, None, {"A": View(35, 10, 265, (40, 84))}),
        StudyScene(
            "sphere",
            "icosphere",
            1.0,
            pale,
            4.0,
            (0.0, 0.0, -1.0),
            {"A": View(40, 15, 46, (44, 64)), "B": View(140, 15, 46, (44, 64), effort=3)},
            height=20.0,
        ),
        StudyScene(
            "skin",
            "pymeshlab/bunny.obj",
            1.0,
            of_material("skin1"),
            4.0,
            (-0.5, -0.5, -0.7),
            {"A": View(20, 15, 46, (38, 90))},
            height=20.0,
            coloured=True,
        ),
    )
}


def chosen(names: Sequence[str]) -> list[StudyScene]:
    """Scenes of the given names, all if there are none. Raises InputError for a name that is not among them."""
    for name in names:
        if name not in SCENES:
            raise InputError(f"scene '{name}': allowed are {', '.join(SCENES)}")
    return [SCENES[name] for name in names or SCENES]
