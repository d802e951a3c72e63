"""The display mesh: normals, and where each of its vertices lies on the simulation surface."""

from __future__ import annotations

import numpy as np

from quadgraph.mesh.surface import Surface

_NEAR_FACES = 12  # nearest face centroids tried per point
_NEAR_VERTICES = 3  # nearest vertices, all of whose faces are tried
_POINTS_AT_ONCE = 100_000  # points that are searched together: some 2 kB each
_ASIDE = 0.5  # cosine of a face's normal to a point's, below which another face at the same corner is tried


def vertex_normals(surface: Surface) -> np.ndarray:
    """(n, 3) unit normals, the mean of the adjacent faces weighted by area; +z where they cancel or there are none."""
    normals = np.zeros_like(surface.vertices)
    for corner in range(3):
        np.add.at(normals, surface.triangles[:, corner], surface.doubled_normals)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.where(length > 0, normals / np.where(length > 0, length, 1), [0.0, 0.0, 1.0])


def nearest_faces(points: np.ndarray, surface: Surface) -> tuple[np.ndarray, np.ndarray]:
    """Nearest face of each of (n, 3) `points`, mm: face index (n,) int64 and barycentric coordinates (n, 3).

    Points that are vertices of `surface` are matched exactly; for the others the closest point of the faces around
    the nearest vertices and the nearest face centroids is taken.
    """
    from scipy.spatial import cKDTree  # here, as programs that only read bodies would take twice as long to start

    face, coordinates = np.zeros(len(points), np.int64), np.zeros((len(points), 3))
    distance, vertex = cKDTree(surface.vertices).query(points)
    same = distance == 0
    incident_face, corner = _a_face_of_each_vertex(surface)
    face[same] = incident_face[vertex[same]]
    coordinates[same, corner[vertex[same]]] = 1
    rest = np.flatnonzero(~same)
    if len(rest):
        nearby = _Nearby(surface)
    for begin in range(0, len(rest), _POINTS_AT_ONCE):
        rows = rest[begin : begin + _POINTS_AT_ONCE]
        face[rows], coordinates[rows] = _search(points[rows], nearby)
    return face, coordinates


def faces_of_sides(
    face: np.ndarray, coordinates: np.ndarray, normals: np.ndarray, surface: Surface
) -> tuple[np.ndarray, np.ndarray]:
    """As `nearest_faces` found, but for points at corners of faces that look elsewhere than their (n, 3) unit normals.

    There another face at the corner is taken, whose normal is nearest: sharp edges part display vertices, of which
    each belongs to one side.
    """
    face, coordinates = face.copy(), coordinates.copy()
    doubled = surface.doubled_normals
    unit = doubled / np.maximum(np.linalg.norm(doubled, axis=1, keepdims=True), np.finfo(float).tiny)
    agreement = np.einsum("ij,ij->i", unit[face], normals)
    some = np.flatnonzero((agreement < _ASIDE) & (coordinates.max(axis=1) == 1))
    if not len(some):
        return face, coordinates
    vertex = surface.triangles[face[some], coordinates[some].argmax(axis=1)]
    best = agreement[some]
    for place in _places_around(vertex, surface).T:
        found = np.einsum("ij,ij->i", unit[place // 3], normals[some])
        better = found > best
        best[better], face[some[better]] = found[better], place[better] // 3
        coordinates[some[better]] = np.eye(3)[place[better] % 3]
    return face, coordinates


def _places_around(vertex: np.ndarray, surface: Surface) -> np.ndarray:
    """(n, most) places in the flat list of triangles where each of (n,) vertices is a corner, repeated to fill rows."""
    flat = surface.triangles.ravel()
    order = np.argsort(flat, kind="stable")
    degree = np.bincount(flat, minlength=len(surface.vertices))
    start = np.concatenate([[0], np.cumsum(degree)])
    turns = np.arange(int(degree[vertex].max()))
    return order[start[vertex][:, None] + turns % degree[vertex][:, None]]


def _a_face_of_each_vertex(surface: Surface) -> tuple[np.ndarray, np.ndarray]:
    flat = surface.triangles.ravel()
    where = np.zeros(len(surface.vertices), np.int64)
    where[flat[::-1]] = np.arange(len(flat))[::-1]
    return where // 3, where % 3


class _Nearby:
    """Which faces of a surface may be the nearest to a point."""

    def __init__(self, surface: Surface) -> None:
        from scipy.spatial import cKDTree

        self.surface = surface
        self._used = np.unique(surface.triangles)
        self._centroids = cKDTree(surface.corners.mean(axis=1))
        self._vertices = cKDTree(surface.vertices[self._used])

    def candidates(self, points: np.ndarray) -> np.ndarray:
        """Faces (n, m) to try for each point, some more than once."""
        count = min(_NEAR_FACES, len(self.surface.triangles))
        faces = self._centroids.query(points, k=count)[1].reshape(-1, count)
        near = min(_NEAR_VERTICES, len(self._used))
        vertices = self._used[self._vertices.query(points, k=near)[1].reshape(-1, near)]
        around = [places // 3 for k in range(near) for places in _places_around(vertices[:, k], self.surface).T]
        return np.stack([*faces.T, *around], axis=1)


def _search(points: np.ndarray, nearby: _Nearby) -> tuple[np.ndarray, np.ndarray]:
    best = np.full(len(points), np.inf)
    face, coordinates = np.zeros(len(points), np.int64), np.zeros((len(points), 3))
    candidates = nearby.candidates(points)
    for tried, new in zip(candidates.T, _first_of_each(candidates).T, strict=True):
        rows = np.flatnonzero(new)
        corners = nearby.surface.corners[tried[rows]]
        found = closest_point_coordinates(points[rows], corners)
        distance = _squared_distance(points[rows], corners, found)
        better = distance < best[rows]
        chosen = rows[better]
        best[chosen], face[chosen], coordinates[chosen] = distance[better], tried[chosen], found[better]
    return face, coordinates


def _first_of_each(rows: np.ndarray) -> np.ndarray:
    """Of each number (n, m) whether it is not further left in its row."""
    order = np.argsort(rows, axis=1, kind="stable")
    ranked = np.take_along_axis(rows, order, axis=1)
    first = np.ones(rows.shape, bool)
    np.put_along_axis(first, order[:, 1:], ranked[:, 1:] != ranked[:, :-1], axis=1)
    return first


def closest_point_coordinates(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Barycentric coordinates (n, 3) of the point of each triangle (n, 3, 3) closest to each of (n, 3) `points`."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    inside = _plane_coordinates(points - a, b - a, c - a)
    best = np.where((inside >= 0).all(axis=1), _squared_distance(points, corners, inside), np.inf)
    coordinates = inside.copy()
    for start in range(3):
        end = (start + 1) % 3
        edge = corners[:, end] - corners[:, start]
        length = np.maximum((edge**2).sum(axis=1), np.finfo(float).tiny)
        along = np.clip(((points - corners[:, start]) * edge).sum(axis=1) / length, 0, 1)
        on_edge = np.zeros_like(inside)
        on_edge[:, start], on_edge[:, end] = 1 - along, along
        distance = _squared_distance(points, corners, on_edge)
        better = distance < best
        best[better], coordinates[better] = distance[better], on_edge[better]
    return coordinates


def _plane_coordinates(offset: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    normal = np.cross(u, v)
    area = np.maximum((normal**2).sum(axis=1), np.finfo(float).tiny)
    second = (np.cross(offset, v) * normal).sum(axis=1) / area
    third = (np.cross(u, offset) * normal).sum(axis=1) / area
    return np.stack([1 - second - third, second, third], axis=1)


def _squared_distance(points: np.ndarray, corners: np.ndarray, coordinates: np.ndarray) -> np.ndarray:
    return ((points - np.einsum("ij,ijk->ik", coordinates, corners)) ** 2).sum(axis=1)
