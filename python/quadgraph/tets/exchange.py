"""Which outside faces see which others, by rays from each: the exchange matrix of one level (inter-reflection).

Light that leaves a face reaches another along straight lines outside the body, so that the matrix depends on the shape
alone and moves with it (docs/physics.md, "Inter-reflection"). Rays and arrays: docs/qgraph-format.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from quadgraph.base.errors import InputError, ToolError
from quadgraph.mesh.surface import Surface
from quadgraph.tets.graph import Graph

DEFAULT_RAYS = 256
MOST_RAYS = 4096
MOST_FACES = 8192
_TURN = 0.6180339887498949  # golden ratio - 1: azimuths of successive faces are spread evenly
_RAYS_AT_ONCE = 1 << 18  # about a quarter of a second, so that an interruption is heard
_PAIRS_AT_ONCE = 1 << 20
# Share of the body's size by which rays start above their face, a few times what single precision can tell apart.
LIFT = 1e-6


@dataclass(frozen=True, eq=False)
class Seen:
    """What the outside faces of level `level` see of each other by `rays` rays from each.

    table: (n_f + 1 + entries,) uint32 as stored: where each row begins, then the faces met.
    """

    level: int
    rays: int
    table: np.ndarray

    @property
    def entries(self) -> int:
        """Rays that met the body."""
        return len(self.table) - int(self.table[0])

    @property
    def share(self) -> np.ndarray:
        """(n_f,) share of each face's cosine-weighted directions that meet the body; the rest meets the sky."""
        faces = int(self.table[0]) - 1
        return np.diff(self.table[: faces + 1].astype(np.int64)) / self.rays


def summary(seen: Seen, boundary: Surface) -> dict[str, Any]:
    """What there is to tell, as plain values; `boundary` holds the outside faces of that level.

    share: of all cosine-weighted directions from the surface, those that meet the body.
    """
    areas = np.linalg.norm(boundary.doubled_normals, axis=1)
    return {
        "level": seen.level,
        "rays": seen.rays,
        "entries": seen.entries,
        "share": float((seen.share * areas).sum() / areas.sum()),
        "bytes": seen.table.nbytes,
    }


def check_rays(rays: int) -> None:
    """Raise InputError unless `rays` is a number of rays that `bake` takes."""
    if not 0 <= rays <= MOST_RAYS:
        raise InputError(f"visibility_rays: {rays} found, 0 (none) to {MOST_RAYS} allowed")


def bake(graphs: Sequence[Graph], rays: int) -> Seen | None:
    """What faces see, on the level of `graphs` (finest first) that takes part in the bounces; None if `rays` is 0.

    Raises InputError if `rays` is out of range, ToolError if the ray tracer is not installed.
    """
    check_rays(rays)
    if rays == 0:
        return None
    level = level_of(graphs)
    return Seen(level, rays, table(graphs[level], rays))


def level_of(graphs: Sequence[Graph]) -> int:
    """The finest level with at most MOST_FACES outside faces, else the coarsest."""
    return next((i for i, graph in enumerate(graphs) if len(graph.faces) <= MOST_FACES), len(graphs) - 1)


def table(graph: Graph, rays: int) -> np.ndarray:
    """Rows of the faces that `rays` rays from each outside face meet first, as `Seen.table`."""
    caster = _Caster(graph)
    step = max(1, _RAYS_AT_ONCE // rays)
    lengths, entries = [], []
    for begin in range(0, len(graph.faces), step):
        faces = np.arange(begin, min(begin + step, len(graph.faces)))
        met = np.sort(caster.first_faces(faces, directions(caster.frames[faces], faces, rays)), axis=1)
        lengths.append((met >= 0).sum(axis=1))
        entries.append(met[met >= 0])
    begins = len(graph.faces) + 1 + np.concatenate([[0], np.cumsum(np.concatenate(lengths))])
    if begins[-1] >= 2**32:
        raise InputError(f"visibility_rays: {rays} rays from {len(graph.faces)} faces are more than a .qgraph can hold")
    return np.concatenate([begins, *entries]).astype("<u4")


def frames(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """(n_f, 3, 3) unit vectors t1 (along the first edge), t2 and the outward normal of (n_f, 3) faces."""
    corners = vertices[faces]
    first = corners[:, 1] - corners[:, 0]
    normal = np.cross(first, corners[:, 2] - corners[:, 0])
    t1 = first / np.linalg.norm(first, axis=1)[:, None]
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    return np.stack([t1, np.cross(normal, t1), normal], axis=1)


def directions(frames: np.ndarray, faces: np.ndarray, rays: int) -> np.ndarray:
    """(n, rays, 3) unit directions, cosine-weighted about the normals of (n, 3, 3) `frames` of faces number (n,)."""
    u = (np.arange(rays) + 0.5) / rays
    azimuth = 2 * np.pi * np.modf(_radical_inverse(rays) + faces[:, None] * _TURN)[0]
    along = np.stack([np.sqrt(u) * np.cos(azimuth), np.sqrt(u) * np.sin(azimuth)], axis=-1)
    return along @ frames[:, :2] + np.sqrt(1 - u)[:, None] * frames[:, None, 2]


def _radical_inverse(count: int) -> np.ndarray:
    """0 to count - 1 with their binary digits mirrored at the point."""
    index, inverse, digit = np.arange(count), np.zeros(count), 0.5
    while index.any():
        inverse += digit * (index & 1)
        index >>= 1
        digit /= 2
    return inverse


class _Caster:
    """First hits on the outside faces of a level.

    Embree decides in single precision, in coordinates about the middle of the body. Where its answer cannot be right
    it is decided in double precision: a ray that meets its own face, or a face from behind, has slipped between two
    faces or started too near.
    """

    def __init__(self, graph: Graph) -> None:
        used = graph.vertices[: graph.surface_vertex_count]
        low, high = used.min(axis=0), used.max(axis=0)
        corners = (used - (low + high) / 2)[graph.faces]
        self.frames = frames(graph.vertices, graph.faces)
        self.corner = corners[:, 0]
        self.edges = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        self.normal = np.cross(*self.edges)  # as long as twice the area
        self.origins = corners.mean(axis=1) + LIFT * np.linalg.norm(high - low) * self.frames[:, 2]
        self.scene, self.mesh = _scene(corners)

    def first_faces(self, faces: np.ndarray, directions: np.ndarray) -> np.ndarray:
        """(n, rays) face that each of (n, rays, 3) `directions` from (n,) `faces` meets from outside; -1: the sky."""
        own = np.repeat(faces, directions.shape[1])
        ways = directions.reshape(-1, 3)
        met = self.scene.run(self.origins[own].astype(np.float32), ways.astype(np.float32)).astype(np.int64)
        doubtful = np.flatnonzero((met == own) | ((met >= 0) & ~self._from_outside(met, ways)))
        step = max(1, _PAIRS_AT_ONCE // len(self.corner))
        for begin in range(0, len(doubtful), step):
            which = doubtful[begin : begin + step]
            met[which] = self._first_in_double_precision(own[which], ways[which])
        met[(met >= 0) & ~self._from_outside(met, ways)] = -1
        return met.reshape(directions.shape[:2])

    def _from_outside(self, met: np.ndarray, ways: np.ndarray) -> np.ndarray:
        return np.einsum("ij,ij->i", self.frames[met, 2], ways) < 0

    def _first_in_double_precision(self, own: np.ndarray, ways: np.ndarray) -> np.ndarray:
        """(n,) nearest face but the own one, edges included; -1: none (Moeller and Trumbore 1997)."""
        first, second = self.edges
        origins = self.origins[own]
        moments = np.cross(origins, ways)
        scale = -ways @ self.normal.T
        with np.errstate(divide="ignore", invalid="ignore"):
            u = (moments @ second.T - ways @ np.cross(second, self.corner).T) / scale
            v = -(moments @ first.T + ways @ np.cross(self.corner, first).T) / scale
            distance = (origins @ self.normal.T - (self.corner * self.normal).sum(axis=1)) / scale
        inside = (u >= -1e-12) & (v >= -1e-12) & (u + v <= 1 + 1e-12) & (distance > 0)
        inside[np.arange(len(own)), own] = False
        nearest = np.where(inside, distance, np.inf).argmin(axis=1)
        return np.where(inside[np.arange(len(own)), nearest], nearest, -1)


def _scene(corners: np.ndarray):
    """An Embree scene of triangles (n, 3, 3), and its mesh, which must live as long."""
    try:
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene
    except ImportError as error:
        raise ToolError(f"visibility_rays: the package embreex is missing ({error}); 0 rays bake without it") from None
    scene = EmbreeScene(robust=True)
    indices = np.arange(3 * len(corners), dtype=np.int32).reshape(-1, 3)
    return scene, TriangleMesh(scene, corners.reshape(-1, 3).astype(np.float32), indices)
