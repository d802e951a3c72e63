"""The surface of a capture's body where it lies, and what meets it: rays of cameras, and ways to eyes and lights."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph import core
from quadgraph.acquisition.cameras.lens import PinholeView
from quadgraph.acquisition.cameras.rigid_placement import Placement
from quadgraph.acquisition.capture.capture import Capture
from quadgraph.base.errors import InputError
from quadgraph.mesh import mesh_io, mesh_names

_OFF = 1e-4  # of the body's size, by which rays begin above the surface
_FAR = 1e3  # of the body's size: from where parallel light comes
FLAT = 0.17  # cosine, below which a place is seen or lit too flatly to tell anything


class PlacedBody:
    """vertices (n, 3), mm; triangles (m, 3); normals (m, 3), unit and outwards; areas (m,), mm^2."""

    def __init__(self, vertices: np.ndarray, triangles: np.ndarray) -> None:
        """Of a surface where it lies. Raises InputError if rays cannot be cast."""
        self.vertices, self.triangles = vertices, triangles
        corners = self.vertices[triangles]
        cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        length = np.linalg.norm(cross, axis=1)
        self.areas = length / 2
        self.normals = cross / np.maximum(length, 1e-300)[:, None]
        self.middle = (self.vertices.min(axis=0) + self.vertices.max(axis=0)) / 2
        self.radius = float(np.linalg.norm(self.vertices - self.middle, axis=1).max())
        self._corners = np.ascontiguousarray(corners - self.middle, np.float32).reshape(-1, 3)
        self._scene, self._mesh = _scene(self._corners)

    def hit(self, origins: np.ndarray, ways: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The triangle that each ray, (n, 3) both, meets first, -1 where none, and where it is met, (n, 3)."""
        found = self._scene.run(
            (origins - self.middle).astype(np.float32), np.ascontiguousarray(ways, np.float32), output=True
        )
        triangles = np.asarray(found["primID"], np.int64)
        return triangles, origins + ways * np.asarray(found["tfar"], float)[:, None]

    def samples(self, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Places spread evenly over the surface, (n, 3), and their triangles, (n,); always the same."""
        generator = np.random.default_rng(0)
        shares = np.cumsum(self.areas) / self.areas.sum()
        triangles = np.searchsorted(shares, (np.arange(count) + generator.uniform(size=count)) / count)
        triangles = np.minimum(triangles, len(self.areas) - 1)
        first, second = np.sqrt(generator.uniform(size=count)), generator.uniform(size=count)
        weights = np.stack([1 - first, first * (1 - second), first * second], axis=1)
        return np.einsum("nk,nkx->nx", weights, self.vertices[self.triangles[triangles]]), triangles

    def cosine_to(self, places: np.ndarray, triangles: np.ndarray, towards: np.ndarray) -> np.ndarray:
        """(n,) cosines between the normals and the ways from places to others, (3,) or (n, 3); 0 where the body is in
        between, or the surface looks away.
        """
        ways = towards - places
        ways = ways / np.linalg.norm(ways, axis=1, keepdims=True)
        cosine = np.einsum("nx,nx->n", ways, self.normals[triangles])
        found = np.zeros(len(places))
        facing = np.flatnonzero(cosine > 0)
        if facing.size:
            begin = places[facing] + _OFF * self.radius * self.normals[triangles[facing]]
            free = self.hit(begin, ways[facing])[0] < 0
            found[facing[free]] = cosine[facing[free]]
        return found

    def lit_by(self, places: np.ndarray, triangles: np.ndarray, light: Mapping[str, Any]) -> np.ndarray:
        """(n,) cosines between the normals and the way to a light, 1 for one from all sides."""
        towards = self.light_place(light)
        return np.ones(len(places)) if towards is None else self.cosine_to(places, triangles, towards)

    def light_place(self, light: Mapping[str, Any]) -> np.ndarray | None:
        """(3,) where a light is, mm, parallel light far away; None where it comes from all sides."""
        for name in ("position", "centre"):
            if name in light:
                return np.array(light[name], float)
        if "direction" in light:
            way = np.array(light["direction"], float)
            return np.asarray(self.middle - _FAR * self.radius * way / np.linalg.norm(way))
        return None

    def seen_by(self, view: PinholeView, places: np.ndarray) -> np.ndarray:
        """(n,) triangles that the rays of a view meet at places of its picture, (n, 2) pixels; -1 where none."""
        slopes = view.lens.slopes(places)
        ways = np.concatenate([slopes, np.ones((len(slopes), 1))], axis=1) @ view.axes()
        return self.hit(np.broadcast_to(view.eye, ways.shape), ways)[0]


def of_capture(capture: Capture) -> PlacedBody:
    """The body of a capture where the capture says. Raises InputError."""
    vertices, triangles = surface(capture.path, capture.body, capture.unit, capture.height_mm)
    return PlacedBody(_placed(capture, vertices), triangles)


def surface(path: Path, body: Path, unit: str | None, height_mm: float | None) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (n, 3), mm, and triangles of the body that a document names. Raises InputError naming the document."""
    stated = unit is not None or height_mm is not None
    if mesh_names.is_mesh(body):
        if not stated:
            raise InputError(f"{path}: unit: is missing, {body.name} is a mesh and needs it: mm, cm or m")
        read = mesh_io.read_surface(body, unit=unit, height_mm=height_mm)
        return read.surface.vertices, np.asarray(read.surface.triangles)
    if stated:
        raise InputError(f"{path}: unit: found for {body.name}, allowed for meshes; leave it out")
    display = core.load(body).display
    return np.asarray(display["vertices"], float), np.asarray(display["triangles"]).reshape(-1, 3)


def _placed(capture: Capture, vertices: np.ndarray) -> np.ndarray:
    """Vertices where a single `transform` lays them. Raises InputError for other deformers."""
    for number, step in enumerate(capture.deformation):
        if step.get("type") != "transform":
            raise InputError(
                f"{capture.path}: deformation[{number}].type: found {step.get('type')}, allowed is transform alone: "
                "what is covered of a body that bends is not looked at"
            )
        centre = np.array(step.get("centre", (vertices.min(axis=0) + vertices.max(axis=0)) / 2), float)
        scale = np.array(step.get("scale", 1.0), float)
        axis = tuple(step.get("axis", (0, 1, 0)))
        place = Placement(1.0, axis, float(step.get("degrees", 0.0)), np.array(step.get("translate", [0, 0, 0]), float))
        vertices = (scale * (vertices - centre)) @ place.rotation.T + centre + place.translation
    return vertices


def view_of(camera: Mapping[str, Any], size: tuple[int, int]) -> PinholeView | None:
    """The view of a capture's camera; None for one that is given by angles or is orthographic."""
    if "eye" not in camera or "orthographic" in camera:
        return None
    eye, look_at = np.array(camera["eye"], float), np.array(camera["look_at"], float)
    up = camera.get("up", "y")
    along = (look_at - eye)["xyz".index(up)] / np.linalg.norm(look_at - eye)
    if abs(along) > 1 - 1e-9:  # straight from above or below, where the azimuth counts
        return None
    return PinholeView(eye, look_at, float(camera.get("fov", 30.0)), up, *size)


def _scene(corners: np.ndarray) -> Any:
    """An Embree scene of triangles, three rows each, and its mesh, which must live as long. Raises InputError."""
    try:
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene
    except ImportError as error:
        raise InputError(f"embreex cannot be imported ({error}): pip install embreex") from error
    scene = EmbreeScene(robust=True)
    return scene, TriangleMesh(scene, corners, np.arange(len(corners), dtype=np.int32).reshape(-1, 3))
