"""Whether a surface goes around a point."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from quadgraph.mesh.surface import Surface

_AT_ONCE = 4096  # triangles whose solid angles are added up together


def winding_number(surface: Surface, point: np.ndarray) -> float:
    """How often a surface goes around a point (3,): its solid angle over 4 pi [van Oosterom and Strackee 1983].

    Of a closed one that looks outward 1 inside, 0 outside; where it looks inward, -1.
    """
    total = 0.0
    edges = [*range(0, len(surface.triangles), _AT_ONCE), len(surface.triangles)]
    for begin, end in pairwise(edges):
        a, b, c = np.moveaxis(surface.vertices[surface.triangles[begin:end]] - point, 1, 0)
        la, lb, lc = (np.linalg.norm(side, axis=1) for side in (a, b, c))
        volume = np.einsum("ij,ij->i", a, np.cross(b, c))
        rest = la * lb * lc + (a * b).sum(axis=1) * lc + (b * c).sum(axis=1) * la + (c * a).sum(axis=1) * lb
        total += float(2 * np.arctan2(volume, rest).sum())
    return total / (4 * math.pi)
