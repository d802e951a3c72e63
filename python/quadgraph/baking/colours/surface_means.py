"""Mean colours of a surface about places of it: sampled densely once, added up in small bins, weighed by distance.

Averages are of linear light, and over the surface alone: what a texture holds between the pieces of a mesh never
counts, nor the other side of a thin wall.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from quadgraph.baking.colours.placed_mesh import PlacedMesh

MOST_SAMPLES = 2_000_000
_PER_BIN = 2  # bins along a cell
_NEAR = 24  # bins that are weighed: those within about a cell of a place on a plane are 13
_AT_ONCE = 100_000
_SEQUENCE = (0.7548776662466927, 0.5698402909980532)  # even in a square [Roberts 2018, R2]


@dataclass(frozen=True, eq=False)
class SurfaceMeans:
    """Bins of a surface. points, normals: (b, 3) mm and unit; areas: (b,) mm²; values: (b, k), means over the bin;
    reach: standard deviation of the weights by distance, mm.
    """

    points: np.ndarray
    normals: np.ndarray
    areas: np.ndarray
    values: np.ndarray
    reach: float

    def about(self, places: np.ndarray, normals: np.ndarray) -> np.ndarray:
        """Mean values (n, k) about places (n, 3) of the surface with unit normals (n, 3)."""
        tree, near = cKDTree(self.points), min(_NEAR, len(self.points))
        found = np.empty((len(places), self.values.shape[1]))
        for begin in range(0, len(places), _AT_ONCE):
            rows = slice(begin, begin + _AT_ONCE)
            distance, index = (each.reshape(-1, near) for each in tree.query(places[rows], k=near))
            facing = np.einsum("nkj,nj->nk", self.normals[index], normals[rows])
            # The nearest always counts a little: at sharp tips nothing else may face the same way.
            closeness = np.exp(-0.5 * ((distance**2 - distance[:, :1] ** 2) / self.reach**2))
            weight = self.areas[index] * closeness * np.maximum(facing, 1e-6)
            found[rows] = np.einsum("nk,nkj->nj", weight, self.values[index]) / weight.sum(axis=1, keepdims=True)
        return found


def surface_means(placed: PlacedMesh, cell: float) -> SurfaceMeans:
    """Bins for cells of that width, mm: their values are red, green, blue (linear), the share that has a medium of its
    own, and that medium's sigma_s_prime and sigma_a (1/mm) times the share, 10 in all.
    """
    triangle, weights, area = _samples(placed, cell / (2 * _PER_BIN))
    points = np.einsum("kc,kcj->kj", weights, placed.surface.corners[triangle])
    normals = placed.surface.doubled_normals[triangle]
    normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), np.finfo(float).tiny)
    media = _media(placed)[placed.looks.part_of(triangle)]
    values = np.column_stack([placed.looks.colour_at(triangle, weights), media])
    side = np.abs(normals).argmax(axis=1)
    side = 2 * side + (np.take_along_axis(normals, side[:, None], axis=1)[:, 0] < 0)
    steps = np.floor((points - points.min(axis=0)) / (cell / _PER_BIN)).astype(np.int64)
    counts = steps.max(axis=0) + 1
    key = ((steps[:, 0] * counts[1] + steps[:, 1]) * counts[2] + steps[:, 2]) * 6 + side
    _, bin_of = np.unique(key, return_inverse=True)

    def added(rows: np.ndarray) -> np.ndarray:
        return np.column_stack([np.bincount(bin_of, area * column) for column in rows.T])

    total = np.bincount(bin_of, area)[:, None]
    direction = added(normals)
    direction /= np.maximum(np.linalg.norm(direction, axis=1, keepdims=True), np.finfo(float).tiny)
    return SurfaceMeans(added(points) / total, direction, total[:, 0], added(values) / total, cell / _PER_BIN)


def _media(placed: PlacedMesh) -> np.ndarray:
    """For each part whether it has a medium, and that medium per mm, (parts, 7)."""
    rows = np.zeros((len(placed.looks.parts), 7))
    for row, part in zip(rows, placed.looks.parts, strict=True):
        if part.look.medium is not None:
            row[0] = 1
            row[1:] = np.array([*part.look.medium.sigma_s_prime, *part.look.medium.sigma_a]) / placed.unit_mm
    return rows


def _samples(placed: PlacedMesh, apart: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places on the surface about `apart` mm from each other: triangle (k,), weights (k, 3), area of each, mm² (k,).

    The same each time; farther apart where there would be more than MOST_SAMPLES.
    """
    areas = placed.areas
    each = max(apart**2, float(areas.sum()) / MOST_SAMPLES, np.finfo(float).tiny)
    counts = np.maximum(np.ceil(areas / each), 1).astype(np.int64)
    triangle = np.repeat(np.arange(len(areas)), counts)
    turn = np.arange(len(triangle)) - np.repeat(np.cumsum(counts) - counts, counts)
    u, v = (np.mod(0.5 + turn * step, 1.0) for step in _SEQUENCE)
    alone = counts[triangle] == 1
    u, v = np.where(alone, 1 / 3, u), np.where(alone, 1 / 3, v)
    beyond = u + v > 1
    u, v = np.where(beyond, 1 - u, u), np.where(beyond, 1 - v, v)
    # Triangles without an area count too, next to nothing, where all about them are so.
    area = np.maximum(areas / counts, np.finfo(float).tiny ** 0.5)[triangle]
    return triangle, np.column_stack([1 - u - v, u, v]), area
