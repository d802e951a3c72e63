"""The QuadGraph of a tet mesh (QuadGraph paper, section 4.1): inner nodes, surface nodes, four links.

Every tet is an inner node at its centroid, every outside face a surface node. The surface node lies where the ray from
the inner node through the face's centroid meets the surface, which is that centroid.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph.mesh.surface import Surface, TetMesh
from quadgraph.tets.tet_geometry import FACE_CORNERS, determinants

# The four tets around an inner point replace vertex k of the tet by it.
_POINT = 4
_SPLIT = np.array([[_POINT, 1, 2, 3], [0, _POINT, 2, 3], [0, 1, _POINT, 3], [0, 1, 2, _POINT]])
# Where to put the point when the centroid, rounded to float32, falls out of a very flat tet.
_SPLIT_TRIALS = 64

# Kinds of outside faces: light passes an open one, a reflecting one is a perfect mirror.
OPEN, REFLECTING = 0, 1


@dataclass(frozen=True, eq=False)
class Graph:
    """One level of detail as arrays in the order of docs/qgraph-format.md.

    vertices: (n_v, 3) float64, exactly representable in float32, mm; those on the surface come first;
    tets: (n_t, 4) int64, positively oriented, at most one outside face each; faces: (n_f, 3) int64, counter-clockwise
    from outside; face_tets: (n_f,) int64; links: (n_t, 4) int64, entry k across the face opposite to vertex k, n_t + f
    for outside face f; inner: (n_t, 3) and surface: (n_f, 3) float64, node positions, mm; face_kinds: (n_f,) int64 of
    OPEN and REFLECTING, None if all faces are open; grid_links: (n_v - n_s, 6) int64, the six links of each vertex
    below the surface in a polygrid (tets/polygrid/lattice.py), its own number where one is missing; None if the
    vertices are no polygrid's; regions: (n_t,) int64, as of TetMesh.
    """

    vertices: np.ndarray
    tets: np.ndarray
    faces: np.ndarray
    face_tets: np.ndarray
    links: np.ndarray
    inner: np.ndarray
    surface: np.ndarray
    face_kinds: np.ndarray | None = None
    grid_links: np.ndarray | None = None
    regions: np.ndarray | None = None

    @property
    def nodes(self) -> np.ndarray:
        """(n_t + n_f, 3) positions of the inner nodes, then of the surface nodes, mm."""
        return np.concatenate([self.inner, self.surface])

    @property
    def volume(self) -> float:
        """Sum of the tets' volumes, mm^3."""
        return float(determinants(self.vertices, self.tets).sum() / 6)

    @property
    def boundary(self) -> Surface:
        """The outside faces."""
        return Surface(self.vertices, self.faces)

    @property
    def surface_vertex_count(self) -> int:
        """How many vertices lie on the surface."""
        return int(self.faces.max()) + 1


def build(mesh: TetMesh) -> Graph:
    """Split tets with several outside faces (paper, Figure 4) and link what remains.

    Raises InputError if the boundary is no closed manifold, if three tets share a face, or if a tet is so flat that
    no float32 point lies inside.
    """
    vertices, tets = np.asarray(mesh.vertices, np.float64), np.asarray(mesh.tets, np.int64)
    regions, neighbours = mesh.regions, neighbours_of(tets)
    several = (neighbours < 0).sum(axis=1) > 1
    if several.any():
        vertices, tets, regions = _split(vertices, tets, several, regions)
        neighbours = neighbours_of(tets)
    face_tets, corner = np.nonzero(neighbours < 0)
    faces = tets[face_tets[:, None], FACE_CORNERS[corner]]
    if not Surface(vertices, faces).is_closed_manifold:
        raise InputError("tet mesh: its boundary is not a closed manifold (an edge or vertex where the solid pinches)")
    links = neighbours
    links[face_tets, corner] = len(tets) + np.arange(len(faces))
    vertices, (tets, faces) = first_use(vertices, faces, tets, faces)
    inner, surface = vertices[tets].mean(axis=1), vertices[faces].mean(axis=1)
    return Graph(vertices, tets, faces, face_tets, links, inner, surface, regions=regions)


def neighbours_of(tets: np.ndarray) -> np.ndarray:
    """(n_t, 4) tet across the face opposite to each vertex; -1 outside."""
    corners = np.sort(tets[:, FACE_CORNERS].reshape(-1, 3), axis=1)
    order = np.lexsort((corners[:, 2], corners[:, 1], corners[:, 0]))
    ranked = corners[order]
    same = (ranked[1:] == ranked[:-1]).all(axis=1)
    if (same[1:] & same[:-1]).any():
        raise InputError("tet mesh: three tets share a face")
    first = np.flatnonzero(same)
    a, b = order[first], order[first + 1]
    neighbours = np.full(tets.size, -1, np.int64)
    neighbours[a], neighbours[b] = b // 4, a // 4
    return neighbours.reshape(-1, 4)


def _split(
    vertices: np.ndarray, tets: np.ndarray, several: np.ndarray, regions: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
    """Cut the tets of (n_t,) `several` in four around a point inside; with the regions that those lie in."""
    corners = vertices[tets[several]]
    points = _points_inside(corners)
    numbers = len(vertices) + np.arange(len(points))
    extended = np.concatenate([tets[several], numbers[:, None]], axis=1)
    pieces = extended[:, _SPLIT].reshape(-1, 4)
    if regions is not None:
        regions = np.concatenate([regions[~several], np.repeat(regions[several], len(_SPLIT))])
    return np.concatenate([vertices, points]), np.concatenate([tets[~several], pieces]), regions


def _points_inside(corners: np.ndarray) -> np.ndarray:
    """A point that float32 can hold strictly inside each tet (n, 4, 3): the centroid wherever that rounds well."""
    points = _rounded(corners.mean(axis=1))
    bad = np.flatnonzero(_smallest_piece(corners, points) <= 0)
    generator = np.random.default_rng(0)
    for _ in range(_SPLIT_TRIALS):
        if not len(bad):
            return points
        weights = generator.dirichlet(np.full(4, 3.0), len(bad))
        points[bad] = _rounded(np.einsum("ij,ijk->ik", weights, corners[bad]))
        bad = bad[_smallest_piece(corners[bad], points[bad]) <= 0]
    if len(bad):
        x, y, z = corners[bad[0]].mean(axis=0)
        raise InputError(f"tet mesh: a tet at ({x:.4g}, {y:.4g}, {z:.4g}) mm is too flat to be split in float32")
    return points


def _rounded(points: np.ndarray) -> np.ndarray:
    return points.astype(np.float32).astype(np.float64)


def _smallest_piece(corners: np.ndarray, points: np.ndarray) -> np.ndarray:
    """(n,) six times the smallest signed volume of the four tets around each point, mm^3."""
    everything = np.concatenate([corners, points[:, None]], axis=1)
    count = len(corners)
    pieces = (np.arange(count)[:, None, None] * 5 + _SPLIT).reshape(-1, 4)
    return determinants(everything.reshape(-1, 3), pieces).reshape(count, 4).min(axis=1, initial=np.inf)


def first_use(vertices: np.ndarray, leading: np.ndarray, *indices: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
    """Number vertices by first use, first in `leading`, then in `indices`; returns them and the new indices."""
    stream = np.concatenate([leading.ravel(), *(index.ravel() for index in indices)])
    used, first = np.unique(stream, return_index=True)
    order = used[np.argsort(first, kind="stable")]
    number = np.empty(len(vertices), np.int64)
    number[order] = np.arange(len(order))
    return vertices[order], [number[index] for index in indices]


def barycentric_gradients(corners: np.ndarray) -> np.ndarray:
    """(n, 3, 3) gradients, 1/mm, of the barycentric coordinates 1, 2, 3 in positive tets with corners (n, 4, 3), mm."""
    u, v, w = (corners[:, k] - corners[:, 0] for k in (1, 2, 3))
    normals = np.stack([np.cross(v, w), np.cross(w, u), np.cross(u, v)], axis=1)
    return normals / np.einsum("ij,ij->i", u, normals[:, 0])[:, None, None]


def barycentric(gradients: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """Coordinates (n, 4) of points at (n, 3) `offsets` from corner 0 of tets with these `barycentric_gradients`."""
    last = np.einsum("ijk,ik->ij", gradients, offsets)
    return np.concatenate([1 - last.sum(axis=1, keepdims=True), last], axis=1)
