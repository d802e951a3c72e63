"""Interpolation from a coarser level to a finer one: fixed numbers of (index, weight) per row."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from quadgraph.tets.graph import Graph, barycentric_gradients
from quadgraph.tets.graph import barycentric as coordinates_of

INNER_NODES = 8
SURFACE_NODES = 4
_CANDIDATES = 16  # nearest tets tried before walking
_MAX_STEPS = 200  # of the walk through links
_COINCIDENT = 1e-6  # of the typical node distance: closer counts as the same point
_INSIDE = 1e-12  # smallest barycentric coordinate of a point inside, up to rounding


@dataclass(frozen=True, eq=False)
class Transfer:
    """Row r of the finer level is the sum over k of weight[r, k] * coarse[index[r, k]].

    index: (n, width) int64; weight: (n, width) float64, >= 0, rows sum to 1.
    """

    index: np.ndarray
    weight: np.ndarray


def inverse_distance(fine: np.ndarray, coarse: np.ndarray, width: int) -> Transfer:
    """Weights proportional to the inverse squared distance of the `width` nearest points (paper, Eq. 10; Shepard).

    fine: (n, 3), coarse: (m, 3), mm. A coincident point takes all the weight. With fewer than `width` coarse points,
    the row ends with the nearest one repeated at weight 0.
    """
    from scipy.spatial import cKDTree  # here, as programs that only read bodies would take twice as long to start

    present = min(width, len(coarse))
    distance, index = cKDTree(coarse).query(fine, k=present)
    distance, index = distance.reshape(-1, present), index.reshape(-1, present)
    scale = np.ptp(coarse, axis=0).max(initial=0.0) * _COINCIDENT
    with np.errstate(divide="ignore", invalid="ignore"):
        weight = (distance[:, :1] / distance) ** 2
    weight[distance[:, 0] <= scale] = np.eye(1, present)
    weight /= weight.sum(axis=1, keepdims=True)
    missing = width - present
    index = np.concatenate([index, np.repeat(index[:, :1], missing, axis=1)], axis=1)
    return Transfer(index.astype(np.int64), np.pad(weight, ((0, 0), (0, missing))))


def barycentric(points: np.ndarray, coarse: Graph) -> Transfer:
    """Linear interpolation at (n, 3) `points`, mm, in the tets of `coarse`; width 4, indices are its vertices.

    Linear functions are reproduced inside. A point outside gets the tet in which clamping its negative coordinates
    and renormalising moves it least.
    """
    locator = _Locator(points, coarse)
    locator.try_nearest()
    locator.walk()
    weight = _clamped(locator.coordinates)
    return Transfer(coarse.tets[locator.tet], weight)


def _clamped(coordinates: np.ndarray) -> np.ndarray:
    weight = np.maximum(coordinates, 0)
    return weight / weight.sum(axis=-1, keepdims=True)


class _Locator:
    """Best tet so far for each point: the one whose clamped coordinates reproduce the point most closely."""

    def __init__(self, points: np.ndarray, graph: Graph) -> None:
        self.points, self.graph = points, graph
        corners = graph.vertices[graph.tets]
        self.origin = corners[:, 0]
        self.gradients = barycentric_gradients(corners)
        self.tet = np.zeros(len(points), np.int64)
        self.coordinates = np.zeros((len(points), 4))
        self.error = np.full(len(points), np.inf)  # mm^2

    def offer(self, rows: np.ndarray, tets: np.ndarray) -> np.ndarray:
        """Take `tets` for the points `rows` where they are better; returns the coordinates in them."""
        coordinates = coordinates_of(self.gradients[tets], self.points[rows] - self.origin[tets])
        reached = np.einsum("ij,ijk->ik", _clamped(coordinates), self.graph.vertices[self.graph.tets[tets]])
        error = ((reached - self.points[rows]) ** 2).sum(axis=1)
        error[coordinates.min(axis=1) >= -_INSIDE] = 0
        better = error < self.error[rows]
        chosen = rows[better]
        self.tet[chosen], self.coordinates[chosen], self.error[chosen] = (
            tets[better],
            coordinates[better],
            error[better],
        )
        return coordinates

    def try_nearest(self) -> None:
        from scipy.spatial import cKDTree

        centroids = self.graph.vertices[self.graph.tets].mean(axis=1)
        count = min(_CANDIDATES, len(centroids))
        nearest = cKDTree(centroids).query(self.points, k=count)[1].reshape(-1, count)
        for k in range(count):
            rows = np.flatnonzero(self.error > 0)
            self.offer(rows, nearest[rows, k])

    def walk(self) -> None:
        """Step through the face of the most negative coordinate until inside or outside the mesh."""
        rows = np.flatnonzero(self.error > 0)
        tets, coordinates = self.tet[rows], self.coordinates[rows]
        for _ in range(_MAX_STEPS):
            if not len(rows):
                return
            following = self.graph.links[tets, coordinates.argmin(axis=1)]
            inside = following < len(self.graph.tets)
            rows, tets = rows[inside], following[inside]
            coordinates = self.offer(rows, tets)
            going = self.error[rows] > 0
            rows, tets, coordinates = rows[going], tets[going], coordinates[going]
