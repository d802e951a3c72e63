"""Which of the closed surfaces that tets meet with their faces each tet lies in."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from quadgraph.base.errors import ToolError
from quadgraph.mesh.surface import Surface, TetMesh
from quadgraph.mesh.winding import winding_number
from quadgraph.tets.graph import neighbours_of
from quadgraph.tets.tet_geometry import FACE_CORNERS


def of(mesh: TetMesh, first: int, inner: Sequence[Surface]) -> np.ndarray:
    """(m,) int64: of each tet the innermost of the surfaces that it lies in, counted from 1, and 0 in none.

    inner: closed surfaces, mm, apart from each other, whose vertices are those of the mesh from `first` on, one surface
    after the other. Raises ToolError where a triangle of theirs is no face of two tets.
    """
    begins = first + np.cumsum([0, *(len(surface.vertices) for surface in inner)])
    walls = np.concatenate([each.triangles + begin for each, begin in zip(inner, begins, strict=False)])
    piece = _pieces(mesh.tets, walls)
    size = mesh.determinants
    region = np.zeros(piece.max() + 1, np.int64)
    for number in range(len(region)):
        tets = np.flatnonzero(piece == number)
        place = mesh.vertices[mesh.tets[tets[size[tets].argmax()]]].mean(axis=0)
        region[number] = _innermost(place, inner)
    return region[piece]


def _pieces(tets: np.ndarray, walls: np.ndarray) -> np.ndarray:
    """(m,) numbers of the pieces into which walls (w, 3) cut the tets."""
    faces = np.sort(tets[:, FACE_CORNERS].reshape(-1, 3), axis=1)
    count = int(tets.max()) + 1
    barred = np.isin(_keys(faces, count), _keys(np.sort(walls, axis=1), count)).reshape(-1, 4)
    neighbours = neighbours_of(tets)
    if barred.sum() != 2 * len(walls) or (neighbours[barred] < 0).any():
        raise ToolError(
            "tetgen: the tetrahedra do not meet the surface of a body within another; leave more room between the two "
            "surfaces, or smooth them where they are nearest"
        )
    tet, corner = np.nonzero((neighbours >= 0) & ~barred)
    joins = sparse.coo_matrix((np.ones(len(tet), bool), (tet, neighbours[tet, corner])), shape=(len(tets), len(tets)))
    return connected_components(joins, directed=False)[1]


def _keys(faces: np.ndarray, count: int) -> np.ndarray:
    """A number for each face of ascending vertices below `count`, as TetMesh.boundary has them."""
    return (faces[:, 0] * count + faces[:, 1]) * count + faces[:, 2]


def _innermost(place: np.ndarray, inner: Sequence[Surface]) -> int:
    """The surface around a place that encloses least, counted from 1; 0 for none."""
    around = [k for k, surface in enumerate(inner) if round(winding_number(surface, place)) > 0]
    return 1 + min(around, key=lambda k: inner[k].volume) if around else 0
