"""A surface in compact patches of about the same area, over which what is sampled is a number worth comparing."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from quadgraph.mesh.surface import Surface

PATCHES = 250
_ROUNDS = 12
_APART = 2.0  # patch radii by which triangles that face opposite ways count as apart: walls have two sides


def patches_of(surface: Surface, count: int = PATCHES) -> np.ndarray:
    """(m,) patch of each triangle, every one from 0 on used. Lloyd's rounds over middles and normals."""
    area = np.linalg.norm(surface.doubled_normals, axis=1) / 2
    radius = np.sqrt(area.sum() / count / np.pi)
    normal = surface.doubled_normals / (2 * area[:, None])
    places = np.concatenate([surface.corners.mean(axis=1), _APART * radius / 2 * normal], axis=1)
    chosen = places[_spread(places, count)]
    for _ in range(_ROUNDS):
        patch = cKDTree(chosen).query(places)[1]
        weight = np.bincount(patch, area, len(chosen))
        sums = np.stack([np.bincount(patch, area * column, len(chosen)) for column in places.T], axis=1)
        chosen = sums[weight > 0] / weight[weight > 0, None]
    return np.unique(cKDTree(chosen).query(places)[1], return_inverse=True)[1]


def _spread(places: np.ndarray, count: int) -> np.ndarray:
    """Triangles far from each other: each the farthest from those before."""
    found = [0]
    nearest = np.linalg.norm(places - places[0], axis=1)
    while len(found) < min(count, len(places)):
        found.append(int(nearest.argmax()))
        nearest = np.minimum(nearest, np.linalg.norm(places - places[found[-1]], axis=1))
    return np.array(found)
