"""Test geometries as QuadGraphs: columns, blocks, balls and cylinders, with walls of symmetry where they stand in."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise, permutations
from typing import TYPE_CHECKING

import numpy as np
import trimesh

from quadgraph.mesh.surface import Surface
from quadgraph.tets import graph, refine
from quadgraph.tets.graph import Graph
from quadgraph.tets.refine import oriented_graph
from quadgraph.tets.tetrahedralise import tetrahedralise

if TYPE_CHECKING:
    from quadgraph.core import Level

OPEN, REFLECTING = 0, 1

# Three tets of a prism with corners 0 1 2 below and 3 4 5 above them.
_PRISM = np.array([[0, 1, 2, 5], [0, 1, 4, 5], [0, 3, 4, 5]])


def box(x: np.ndarray, y: np.ndarray, z: np.ndarray, is_wall: Callable[[np.ndarray], np.ndarray]) -> Graph:
    """Cells between the given coordinates, mm, cut into six tets each around the same diagonal.

    is_wall: from outward unit normals (n, 3) of the outside faces to (n,) bool: those that reflect.
    """
    shape = len(x), len(y), len(z)
    grid = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).reshape(-1, 3)
    cells = np.stack(np.meshgrid(*(np.arange(n - 1) for n in shape), indexing="ij"), axis=-1).reshape(-1, 3)
    tets = []
    for axes in permutations(range(3)):
        corner = cells.copy()
        path = [np.ravel_multi_index(corner.T, shape)]
        for axis in axes:
            corner[:, axis] += 1
            path.append(np.ravel_multi_index(corner.T, shape))
        tets.append(np.column_stack(path))
    return with_walls(oriented_graph(grid, np.concatenate(tets)), is_wall)


def column(thicknesses: np.ndarray, width: float, across: int = 2) -> Graph:
    """A slab's stand-in: layers of (n,) `thicknesses` mm from z = 0, width x width mm, side walls reflecting.

    across: cells along the width.
    """
    z = np.concatenate([[0.0], np.cumsum(thicknesses)])
    side = np.linspace(0, width, across + 1)
    return box(side, side, z, lambda normal: np.abs(normal[:, 2]) < 0.5)


def half_period(wavelength: float, across: int, thicknesses: np.ndarray) -> Graph:
    """A half-space's stand-in under q = cos(2 pi x / wavelength): x from 0 to half of it, all but z = 0 reflecting.

    across: cells along x; one cell deep in y, as wide as along x; layers of (n,) `thicknesses` mm from z = 0.
    """
    x = np.linspace(0, wavelength / 2, across + 1)
    z = np.concatenate([[0.0], np.cumsum(thicknesses)])
    return box(x, x[:2], z, lambda normal: normal[:, 2] > -0.5)


def graded(first: float, ratio: float, total: float) -> np.ndarray:
    """Thicknesses, mm, that grow by `ratio` from about `first` and sum to `total`."""
    count = 1
    while first * (ratio**count - 1) / (ratio - 1) < total:
        count += 1
    layers = first * ratio ** np.arange(count)
    return layers * total / layers.sum()


def ball(radius: float, refinements: int, subdivisions: int = 3) -> Graph:
    """A ball about the origin: an icosphere of 20 * 4^subdivisions triangles filled by TetGen, each tet cut into eight
    `refinements` times.
    """
    surface = trimesh.creation.icosphere(subdivisions=subdivisions, radius=radius)
    shape = Surface(np.array(surface.vertices, np.float64), np.array(surface.faces, np.int64)).rounded()
    mesh = graph.build(tetrahedralise(shape, mesher="tetgen"))
    for _ in range(refinements):
        mesh = refine.refined(mesh, lambda p: radius * p / np.linalg.norm(p, axis=1)[:, None])
    return mesh


def two_layer_ball(core_radius: float, radius: float, refinements: int, layers: int = 4) -> Graph:
    """A ball whose tets respect a concentric sphere of `core_radius`: a ball of that size in prisms cut into tets.

    layers: of prisms before refinement; the element size halves with every refinement.
    """
    core = ball(core_radius, refinements, subdivisions=2)
    used = core.surface_vertex_count
    steps = np.linspace(1, radius / core_radius, layers * 2**refinements + 1)
    shells = [core.vertices[:used] * step for step in steps[1:]]
    vertices = np.concatenate([core.vertices, *shells])
    starts = [0, *(len(core.vertices) + used * np.arange(len(shells)))]
    triangles = np.sort(core.faces, axis=1)
    tets = [_prisms(triangles + low, triangles + high) for low, high in pairwise(starts)]
    return oriented_graph(vertices, np.concatenate([core.tets, *tets]))


def shell(inner: float, outer: float, layers: int, subdivisions: int = 2) -> Graph:
    """The body between two concentric spheres, mm: icospheres of 20 * 4^subdivisions triangles with prisms between."""
    sphere = trimesh.creation.icosphere(subdivisions=subdivisions, radius=1)
    triangles = np.sort(np.array(sphere.faces, np.int64), axis=1)
    radii = np.linspace(inner, outer, layers + 1)
    vertices = np.concatenate([radius * np.array(sphere.vertices) for radius in radii])
    starts = len(sphere.vertices) * np.arange(layers + 1)
    return oriented_graph(
        vertices, np.concatenate([_prisms(triangles + a, triangles + b) for a, b in pairwise(starts)])
    )


def facing_plates(edge: float, thickness: float, gap: float, across: int) -> Graph:
    """Two square plates, edge x edge x thickness mm, that face each other across `gap` mm in z; `across` cells along x
    and y.
    """
    side = np.linspace(-edge / 2, edge / 2, across + 1)
    plates = [box(side, side, z + np.array([0, thickness]), no_wall) for z in (gap / 2, -gap / 2 - thickness)]
    start = len(plates[0].vertices)
    vertices = np.concatenate([plate.vertices for plate in plates])
    return oriented_graph(vertices, np.concatenate([plates[0].tets, plates[1].tets + start]))


def cylinder(radius: float, rings: int) -> Graph:
    """A segment of an infinite cylinder about z, as high as a ring is wide, its end caps reflecting."""
    points, triangles = _disc(radius, rings)
    heights = np.array([0.0, radius / rings])
    vertices = np.concatenate([np.column_stack([points, np.full(len(points), z)]) for z in heights])
    triangles = np.sort(triangles, axis=1)
    tets = _prisms(triangles, triangles + len(points))
    return with_walls(oriented_graph(vertices, tets), lambda normal: np.abs(normal[:, 2]) > 0.99)


def with_walls(mesh: Graph, is_wall: Callable[[np.ndarray], np.ndarray]) -> Graph:
    """The graph with those outside faces reflecting whose outward unit normals (n, 3) `is_wall` picks."""
    _, normal, _ = face_frames(mesh)
    return replace(mesh, face_kinds=np.where(is_wall(normal), REFLECTING, OPEN).astype(np.int64))


def face_frames(level: Graph | Level) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Centroid (n, 3) mm, outward unit normal (n, 3) and area (n,) mm^2 of a level's outside faces."""
    corners = np.asarray(level.vertices, np.float64)[level.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1)
    return corners.mean(axis=1), normal / length[:, None], length / 2


def moved(mesh: Graph, shape: Callable[[np.ndarray], np.ndarray]) -> Graph:
    """The graph with its vertices where `shape` puts points (n, 3), mm, and nodes at centroids; nothing is checked."""
    vertices = shape(mesh.vertices).astype(np.float32).astype(np.float64)
    inner, surface = vertices[mesh.tets].mean(axis=1), vertices[mesh.faces].mean(axis=1)
    return replace(mesh, vertices=vertices, inner=inner, surface=surface)


def no_wall(normal: np.ndarray) -> np.ndarray:
    """For `box`: none reflects."""
    return np.zeros(len(normal), bool)


def _prisms(lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """Three tets (3 n, 4) per prism between triangles (n, 3), each row in ascending order.

    The order makes neighbouring prisms agree on the diagonal of the side between them.
    """
    return np.hstack([lower, upper])[:, _PRISM].reshape(-1, 4)


def _disc(radius: float, rings: int) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 2) and triangles (m, 3) of a disc: ring i holds 6 i points."""
    points = [np.zeros((1, 2))]
    triangles = []
    start = np.array([0] + [1 + 3 * i * (i - 1) for i in range(1, rings + 1)])
    for i in range(1, rings + 1):
        angle = np.arange(6 * i) * np.pi / (3 * i)
        points.append(radius * i / rings * np.column_stack([np.cos(angle), np.sin(angle)]))
        sector, step = np.divmod(np.arange(6 * i), i)
        outer = start[i] + np.arange(6 * i)
        following = start[i] + (np.arange(6 * i) + 1) % (6 * i)
        inner = start[i - 1] + (sector * (i - 1) + step) % max(6 * (i - 1), 1)
        triangles.append(np.column_stack([inner, outer, following]))
        between = step < i - 1
        next_inner = start[i - 1] + (sector * (i - 1) + step + 1) % max(6 * (i - 1), 1)
        triangles.append(np.column_stack([inner, following, next_inner])[between])
    return np.concatenate(points), np.concatenate(triangles)
