"""The rules of a `.qgraph` file that hold sections against each other by where things lie.

The same as in engine/file/validate_geometry.cpp, with the same numbers.
"""

from __future__ import annotations

import numpy as np

from quadgraph.base.errors import FormatError
from quadgraph.base.units import SIZES_MM
from quadgraph.tets.tet_geometry import FACE_CORNERS

NODE_TOLERANCE = 1e-5  # of the body's size: single precision, and its sums
LARGEST_GAP = 0.5  # the same, from a display vertex to its place in a face
GAP_TOLERANCE = 1e-4  # the same
LARGEST_OPEN = 1e-6  # of the area: a hole in a surface that bakes close
MOST_HELD = 16  # display vertices that are held against all faces
MOST_AVERAGED = 1024  # vertices and triangles whose normals are averaged
LEAST_AGREEMENT = 0.1  # mean cosine of normals that belong together


def _require(condition: bool, where: str, what: str) -> None:
    if not condition:
        raise FormatError(f"{where}: {what}")


def check_size(vertices: np.ndarray, where: str) -> None:
    """The box around (n, 3) vertices is neither too small nor too large for single precision."""
    low, high = vertices.min(axis=0).astype(np.float64), vertices.max(axis=0).astype(np.float64)
    longest, far = float((high - low).max()), float(max(abs(low).max(), abs(high).max()))
    _require(
        SIZES_MM[0] <= longest <= SIZES_MM[1] and far <= SIZES_MM[1],
        where,
        f"longest side {longest:.6g} mm, at most {far:.6g} mm from 0 found, "
        f"allowed are {SIZES_MM[0]:g} to {SIZES_MM[1]:g} mm",
    )


def check_level(level: dict[str, np.ndarray], where: str) -> None:
    """Sizes; inner nodes lie in their tets, surface nodes at the centroids of their faces."""
    check_size(level["vertices"], f"{where}/vertices")
    vertices, tets, nodes = level["vertices"].astype(np.float64), level["tets"], level["nodes"].astype(np.float64)
    allowed = NODE_TOLERANCE * _size(vertices)
    for tet in np.flatnonzero(~_inside(vertices, tets, nodes[: len(tets)])):
        faces = vertices[tets[tet][FACE_CORNERS]]
        vectors = _face_vectors(faces)
        outside = np.einsum("ij,ij->i", vectors, nodes[tet] - faces[:, 0]) / np.linalg.norm(vectors, axis=1)
        _require(bool((outside <= allowed).all()), f"{where}/nodes", f"row {tet}: lies outside of its tet")
    off = nodes[len(tets) :] - vertices[level["faces"]].mean(axis=1)
    square = np.einsum("ij,ij->i", off, off)
    worst = int(square.argmax())
    _require(
        bool(square[worst] <= allowed**2),
        f"{where}/nodes",
        f"row {len(tets) + worst}: {square[worst] ** 0.5:.6g} mm from the centroid of its face",
    )


def _inside(vertices: np.ndarray, tets: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Whether each of (n, 3) points lies on the inner side of all faces of its positive tet.

    By components, each contiguous: several times faster than rows of three.
    """
    places, own = np.ascontiguousarray(vertices.T), np.ascontiguousarray(points.T)
    a, b, c, d = ([places[k][tets[:, corner]] - own[k] for k in range(3)] for corner in range(4))
    ab, cd = _cross(a, b), _cross(c, d)
    return (_dot(b, cd) >= 0) & (_dot(a, cd) <= 0) & (_dot(d, ab) >= 0) & (_dot(c, ab) <= 0)


def _cross(a: list[np.ndarray], b: list[np.ndarray]) -> list[np.ndarray]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def _dot(a: list[np.ndarray], b: list[np.ndarray]) -> np.ndarray:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def check_display(sections: dict[str, np.ndarray], name: str) -> None:
    """Vertices of the display mesh lie where their faces are, and nothing is inside out."""
    vertices = sections["display/vertices"].astype(np.float64)
    finest, faces = sections["level0/vertices"].astype(np.float64), sections["level0/faces"]
    corners = finest[faces[sections["display/face"]]]
    weights = sections["display/barycentric"].astype(np.float64)
    away = vertices - sum(weights[:, [k]] * corners[:, k] for k in range(3))
    gap, size = np.sqrt(np.einsum("ij,ij->i", away, away)), _size(finest)
    worst = int(gap.argmax())
    _require(
        bool(gap[worst] <= LARGEST_GAP * size),
        f"{name}: display/vertices",
        f"row {worst}: {gap[worst]:.6g} mm from its place in its face, allowed are {LARGEST_GAP * size:.6g} mm",
    )
    along = _along_faces(corners, vertices - away, away, NODE_TOLERANCE * size)
    worst = int(along.argmax())
    _require(
        bool(along[worst] <= NODE_TOLERANCE * size),
        f"{name}: display/vertices",
        f"row {worst}: its place is not the nearest in its face, which goes on for {along[worst]:.6g} mm towards it",
    )
    nodes = np.ascontiguousarray(sections["level0/nodes"][-len(faces) :].T.astype(np.float64))
    for i in range(0, len(vertices), _step(len(vertices), MOST_HELD)):
        nearest = float(np.sqrt(sum((nodes[k] - vertices[i, k]) ** 2 for k in range(3)).min()))
        _require(
            bool(gap[i] <= nearest + GAP_TOLERANCE * size),
            f"{name}: display/face",
            f"row {i}: {gap[i]:.6g} mm from the vertex, a face lies within {nearest:.6g} mm",
        )
    _check_closed(sections, name)
    _check_agreement(sections, vertices, corners, name)


def _along_faces(corners: np.ndarray, places: np.ndarray, away: np.ndarray, least: float) -> np.ndarray:
    """How far each of (n, 3) `away` from places in faces leads along the face, mm: towards one of its (n, 3, 3) corners
    that is farther from the place than `least`. None of places that are nearest.
    """
    sides = corners - places[:, None]
    lengths = np.sqrt(np.einsum("ijk,ijk->ij", sides, sides))
    lengths[lengths <= least] = np.inf
    return np.maximum(np.einsum("ijk,ik->ij", sides, away) / lengths, 0).max(axis=1)


def _step(count: int, samples: int) -> int:
    """Rows from one to the next of some of many, spread evenly."""
    return max(count // samples, 1)


def _check_closed(sections: dict[str, np.ndarray], name: str) -> None:
    """The display mesh that a body is in is closed: its area vectors add up to 0."""
    twice = _face_vectors(sections["display/vertices"].astype(np.float64)[sections["display/triangles"]])
    area = float(np.sqrt(np.einsum("ij,ij->i", twice, twice)).sum())
    share = float(np.linalg.norm(twice.sum(axis=0))) / area if area > 0 else 0.0
    _require(
        share <= LARGEST_OPEN,
        f"{name}: display/triangles",
        f"do not close: the sum of their area vectors is {share:.6g} of their area, allowed is {LARGEST_OPEN:g}",
    )


def _check_agreement(sections: dict[str, np.ndarray], vertices: np.ndarray, corners: np.ndarray, name: str) -> None:
    some = slice(None, None, _step(len(vertices), MOST_AVERAGED))
    normals = float(
        np.einsum("ij,ij->i", sections["display/normals"][some], _unit(_face_vectors(corners[some]))).mean()
    )
    triangles = sections["display/triangles"]
    triangles = triangles[:: _step(len(triangles), MOST_AVERAGED)]
    twice, outward = _face_vectors(vertices[triangles]), _unit(_face_vectors(corners[triangles[:, 0]]))
    area = float(np.linalg.norm(twice, axis=1).sum())
    turned = float(np.einsum("ij,ij->i", twice, outward).sum()) / area if area > 0 else 0.0
    for section, agreement in (("normals", normals), ("triangles", turned)):
        _require(
            agreement >= LEAST_AGREEMENT,
            f"{name}: display/{section}",
            f"on average at a cosine of {agreement:.3g} to the outward normals of the faces, allowed are 0.1 or more",
        )


def _face_vectors(corners: np.ndarray) -> np.ndarray:
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _unit(vectors: np.ndarray) -> np.ndarray:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0)


def _size(vertices: np.ndarray) -> float:
    """Of the box around points, and how far it reaches from 0: what single precision is relative to."""
    reach = np.linalg.norm(np.abs(vertices).max(axis=0))
    return float(max(np.linalg.norm(np.ptp(vertices, axis=0)), reach))
