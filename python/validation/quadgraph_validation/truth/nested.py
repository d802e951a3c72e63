"""Faces of a surface that were cut out of the faces of another: which came from which, and where they lie in it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree


@dataclass(frozen=True)
class Nested:
    """parent: (n,) face of the coarse surface that each fine face lies in; weight: (n, 3) barycentric coordinates of
    its middle there.
    """

    parent: np.ndarray
    weight: np.ndarray

    def at_middles(self, faces: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Values (m, c) at the vertices of coarse faces (n_f, 3), linear over each, in the middles of the fine ones."""
        return np.einsum("ij,ijc->ic", self.weight, values[faces[self.parent]])

    def means(self, area: np.ndarray, values: np.ndarray, count: int) -> np.ndarray:
        """Values (n, c) on fine faces of areas (n,), averaged over each of `count` coarse ones."""
        sums = [np.bincount(self.parent, area * column, count) for column in values.T]
        return np.column_stack(sums) / np.bincount(self.parent, area, count)[:, None]


def nested(
    coarse_vertices: np.ndarray, coarse_faces: np.ndarray, fine_vertices: np.ndarray, fine_faces: np.ndarray
) -> Nested:
    """Find where faces lie that meshes.refined cut in four, without a change of shape, whatever their order is now.

    Vertices (n, 3) in mm as single precision holds them; each corner of a fine face is a corner or the middle of an
    edge of a coarse one. Raises ValueError if they are not.
    """
    edges = np.unique(np.sort(coarse_faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
    used = np.unique(coarse_faces)
    ends = np.concatenate([np.repeat(used[:, None], 2, axis=1), edges])
    middles = coarse_vertices[ends].mean(axis=1).astype(np.float32).astype(np.float64)
    corners, inverse = np.unique(fine_faces, return_inverse=True)
    distance, found = cKDTree(middles).query(fine_vertices[corners])
    pairs = ends[found[inverse.reshape(-1)]].reshape(-1, 6)
    low, high = pairs.min(axis=1), pairs.max(axis=1)
    between = np.where((pairs > low[:, None]) & (pairs < high[:, None]), pairs, -1).max(axis=1)
    wanted = np.column_stack([low, between, high])
    parent = _lookup(coarse_faces, wanted)
    if distance.max() > 0 or (np.sort(coarse_faces[parent], axis=1) != wanted).any():
        raise ValueError("the fine faces were not cut out of the coarse ones")
    weight = (pairs[:, :, None] == coarse_faces[parent][:, None, :]).mean(axis=1)
    return Nested(parent, weight)


def _lookup(faces: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Which of `faces` has the corners of each of `wanted`, whose rows ascend; any one where none has."""
    size = int(faces.max()) + 1

    def code(triples: np.ndarray) -> np.ndarray:
        return (triples[:, 0] * size + triples[:, 1]) * size + triples[:, 2]

    codes = code(np.sort(faces.astype(np.int64), axis=1))
    order = np.argsort(codes)
    found = np.searchsorted(codes, code(wanted.astype(np.int64)), sorter=order)
    return order[np.minimum(found, len(order) - 1)]
