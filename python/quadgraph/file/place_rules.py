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
MOST_SAMPLES = 32  # display vertices that are held against all faces
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
    for corners in FACE_CORNERS:
        face = vertices[tets[:, corners]]
        vector = _face_vectors(face)
        outside = np.einsum("ij,ij->i", vector, nodes[: len(tets)] - face[:, 0])
        wrong = np.flatnonzero(~(outside <= allowed * np.linalg.norm(vector, axis=1)))
        _require(not len(wrong), f"{where}/nodes", f"row {wrong[0] if len(wrong) else 0}: lies outside of its tet")
    off = np.linalg.norm(nodes[len(tets) :] - vertices[level["faces"]].mean(axis=1), axis=1)
    worst = int(off.argmax())
    _require(
        bool(off[worst] <= allowed),
        f"{where}/nodes",
        f"row {len(tets) + worst}: {off[worst]:.6g} mm from the centroid of its face",
    )


def check_display(sections: dict[str, np.ndarray], name: str) -> None:
    """Vertices of the display mesh lie where their faces are, and nothing is inside out."""
    vertices = sections["display/vertices"].astype(np.float64)
    finest, faces = sections["level0/vertices"].astype(np.float64), sections["level0/faces"]
    corners = finest[faces[sections["display/face"]]]
    gap = np.linalg.norm(vertices - np.einsum("ij,ijk->ik", sections["display/barycentric"], corners), axis=1)
    size = _size(finest)
    worst = int(gap.argmax())
    _require(
        bool(gap[worst] <= LARGEST_GAP * size),
        f"{name}: display/vertices",
        f"row {worst}: {gap[worst]:.6g} mm from its place in its face, allowed are {LARGEST_GAP * size:.6g} mm",
    )
    centroids = finest[faces].mean(axis=1)
    for i in range(0, len(vertices), max(len(vertices) // MOST_SAMPLES, 1)):
        nearest = float(np.sqrt(((centroids - vertices[i]) ** 2).sum(axis=1).min()))
        _require(
            bool(gap[i] <= nearest + GAP_TOLERANCE * size),
            f"{name}: display/face",
            f"row {i}: {gap[i]:.6g} mm from the vertex, a face lies within {nearest:.6g} mm",
        )
    _check_agreement(sections, vertices, _unit(_face_vectors(corners)), name)


def _check_agreement(sections: dict[str, np.ndarray], vertices: np.ndarray, outward: np.ndarray, name: str) -> None:
    triangles = sections["display/triangles"]
    twice = _face_vectors(vertices[triangles])
    area = float(np.linalg.norm(twice, axis=1).sum())
    normals = float(np.einsum("ij,ij->i", sections["display/normals"], outward).mean())
    turned = float(np.einsum("ij,ij->i", twice, outward[triangles[:, 0]]).sum()) / area if area > 0 else 0.0
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
