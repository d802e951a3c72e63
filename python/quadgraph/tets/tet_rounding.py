"""Tetrahedra that stay positive when their vertices are stored as float32."""

from __future__ import annotations

import numpy as np
from scipy.optimize import linprog

from quadgraph.base.errors import ToolError
from quadgraph.tets.tet_geometry import determinants

_ROUNDS = 20
_MANY, _PATIENCE = 100, 3  # flat tets, and rounds that leave no fewer: more rounds take minutes and mend nothing


def _round(points: np.ndarray) -> np.ndarray:
    return points.astype(np.float32).astype(np.float64)


def orient(vertices: np.ndarray, tets: np.ndarray) -> np.ndarray:
    """The tets with every determinant turned positive (zero stays zero)."""
    turned = tets.copy()
    negative = determinants(vertices, tets) < 0
    turned[negative, 2:] = tets[negative, :1:-1]
    return turned


def round_to_float32(vertices: np.ndarray, tets: np.ndarray, fixed: int) -> np.ndarray:
    """Round vertices to float32 so that every positively oriented tet stays positive in double precision.

    vertices: (n, 3) mm, the first `fixed` of them exactly representable and never moved; tets: (m, 4). Interior
    vertices of tets that rounding has flattened are moved to the middle of their stars. Raises ToolError where that
    does not help, naming the place.
    """
    rounded = _round(vertices)
    least, waited = len(tets) + 1, 0
    for _ in range(_ROUNDS):
        flat = np.flatnonzero(determinants(rounded, tets) <= 0)
        if not len(flat):
            return rounded
        waited = 0 if len(flat) < least else waited + 1
        if waited >= _PATIENCE and len(flat) > _MANY:
            break
        least = min(least, len(flat))
        free = np.unique(tets[flat])
        for vertex in free[free >= fixed]:
            _centre(rounded, tets[(tets == vertex).any(axis=1)], vertex)
        if not (free >= fixed).any():
            break
    x, y, z = rounded[tets[flat[0]]].mean(axis=0)
    raise ToolError(
        f"{len(flat)} tetrahedra have no volume in single precision, the first at ({x:.6g}, {y:.6g}, {z:.6g}) mm; "
        "simplify or smooth the surface there"
    )


def _centre(vertices: np.ndarray, star: np.ndarray, vertex: int) -> None:
    """Move a vertex as far inside its star of tets as it can be: to the Chebyshev centre of the star's kernel.

    A determinant is linear in one corner, gradient times (x - opposite face), so the centre is a linear program.
    """
    corner = np.argmax(star == vertex, axis=1)
    # The face opposite to each corner, ordered so that its normal points to the corner.
    faces = np.take_along_axis(star, np.array([[1, 3, 2], [0, 2, 3], [0, 3, 1], [0, 1, 2]])[corner], axis=1)
    here = vertices[vertex].copy()
    a, b, c = (vertices[faces[:, k]] - here for k in range(3))
    inward = np.cross(b - a, c - a)
    area = np.linalg.norm(inward, axis=1)
    usable = area > 0
    unit = inward[usable] / area[usable, None]
    bounds = [(None, None)] * 3 + [(None, np.abs(a).max())]
    found = linprog(
        [0, 0, 0, -1],
        A_ub=np.column_stack([-unit, np.ones(len(unit))]),
        b_ub=-np.einsum("ij,ij->i", unit, a[usable]),
        bounds=bounds,
    )
    if found.success:
        vertices[vertex] = _round(here + found.x[:3])
