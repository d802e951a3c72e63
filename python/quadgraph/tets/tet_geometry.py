"""Faces and volumes of tets."""

from __future__ import annotations

import numpy as np

# Vertices of the face opposite to vertex k of a positively oriented tet, counter-clockwise seen from outside.
FACE_CORNERS = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])


def determinants(vertices: np.ndarray, tets: np.ndarray) -> np.ndarray:
    """Six times the volume of each tet, mm^3, (n_t,) in double precision from (n_v, 3) and (n_t, 4)."""
    corners = np.asarray(vertices, np.float64)[tets]
    a, b, c = (corners[:, k] - corners[:, 0] for k in (1, 2, 3))
    return np.einsum("ij,ij->i", a, np.cross(b, c))
