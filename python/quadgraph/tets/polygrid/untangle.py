"""Moves vertices so that no tet is inverted and all are near their reference shapes.

Minimises the regularised distortion of Garanzha et al. 2021 ("Foldover-free maps in 50 lines of code"): with J the
gradient of the map from the reference, |J|^2 / chi^(2/3) for shape and (1 + det^2 J) / chi for volume, where chi is
det J kept positive by an epsilon that shrinks with the worst tet. Inverted tets are pulled out, good ones stay good.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.optimize import minimize

_VOLUME = 0.3  # weight of the volume's term
_ROUNDS = 12
_MOST_RINGS = 6  # of cells around an inverted one that move with it
_STEPS = 60  # of L-BFGS in a round
_FLAT = 1e-3  # of a cell's sixth: reference tets below this are replaced by regular ones
_GOOD = 1e-3  # determinant, of the reference's, that every tet is to have


@dataclass(frozen=True, eq=False)
class Pull:
    """Springs that draw `nodes` (k,) to `targets` (k, 3), mm; weight per cell of the mesh and square of its size."""

    nodes: np.ndarray
    targets: np.ndarray
    weight: float


class Distortion:
    """Distortion of (m, 4) `tets` against reference positions (n, 3), mm, as a function of the positions."""

    def __init__(self, reference: np.ndarray, tets: np.ndarray) -> None:
        self.tets = tets
        edges = _edges(reference[tets])
        size = np.abs(np.linalg.det(edges)).mean() ** (1 / 3)
        flat = np.linalg.det(edges) < _FLAT * size**3
        edges[flat] = size * _REGULAR
        self.inverse = np.linalg.inv(edges)
        self.size = size
        self.scatter = _scatter(tets, len(reference))

    def around(self, nodes: np.ndarray) -> Distortion:
        """The distortion of the tets alone that have one of the (n,) bool `nodes`."""
        kept = nodes[self.tets].any(axis=1)
        part = copy(self)
        part.tets, part.inverse = self.tets[kept], self.inverse[kept]
        part.scatter = _scatter(part.tets, len(nodes))
        return part

    def determinants(self, positions: np.ndarray) -> np.ndarray:
        """(m,) volume of each tet over that of its reference."""
        return np.linalg.det(_edges(positions[self.tets]) @ self.inverse)

    def value(self, positions: np.ndarray, epsilon: float) -> tuple[float, np.ndarray]:
        """Sum over all tets, and its gradient (n, 3), 1/mm."""
        jacobian = _edges(positions[self.tets]) @ self.inverse
        cofactor = _cofactor(jacobian)
        det = np.einsum("ij,ij->i", jacobian[:, 0], cofactor[:, 0])
        root = np.sqrt(epsilon**2 + det**2)
        chi = np.where(det > 0, 0.5 * (det + root), 0.5 * epsilon**2 / np.maximum(root - det, 1e-300))
        slope = 0.5 * (1 + det / root)
        square = np.einsum("ijk,ijk->i", jacobian, jacobian)
        shape = chi ** (-2 / 3)
        total = (1 - _VOLUME) * square * shape / 3 + _VOLUME * (1 + det**2) / chi / 2
        of_det = -(1 - _VOLUME) * 2 / 9 * square * shape / chi * slope
        of_det += _VOLUME * (det / chi - 0.5 * (1 + det**2) * slope / chi**2)
        gradient = (1 - _VOLUME) * 2 / 3 * shape[:, None, None] * jacobian + of_det[:, None, None] * cofactor
        of_edges = gradient @ self.inverse.transpose(0, 2, 1)
        corners = np.concatenate([-of_edges.sum(axis=2, keepdims=True), of_edges], axis=2).transpose(0, 2, 1)
        return float(total.sum()), self.scatter @ corners.reshape(-1, 3)


def improve(
    distortion: Distortion, positions: np.ndarray, free: np.ndarray, pull: Pull | None = None, steps: int = _STEPS
) -> np.ndarray:
    """One round of L-BFGS over the (n,) bool `free` nodes."""
    worst = float(distortion.determinants(positions).min())
    epsilon = np.sqrt(1e-8 + 0.04 * min(worst, 0.0) ** 2)

    def objective(x: np.ndarray) -> tuple[float, np.ndarray]:
        here = positions.copy()
        here[free] = x.reshape(-1, 3)
        value, gradient = distortion.value(here, epsilon)
        if pull is not None:
            offset = (here[pull.nodes] - pull.targets) / distortion.size
            value += pull.weight * float((offset**2).sum())
            gradient[pull.nodes] += 2 * pull.weight * offset / distortion.size
        return value, gradient[free].ravel()

    found = minimize(
        objective, positions[free].ravel(), jac=True, method="L-BFGS-B", options={"maxiter": steps, "maxcor": 8}
    )
    result = positions.copy()
    result[free] = found.x.reshape(-1, 3)
    return result


def untangle(distortion: Distortion, positions: np.ndarray, movable: np.ndarray) -> np.ndarray:
    """Positions without inverted tets where that is found by moving (n,) bool `movable` nodes near those that are."""
    for rings in range(2, 2 + _ROUNDS):
        bad = distortion.determinants(positions) <= _GOOD
        if not bad.any():
            break
        near = np.zeros(len(positions), bool)
        near[distortion.tets[bad]] = True
        for _ in range(min(rings, _MOST_RINGS)):
            near[distortion.tets[near[distortion.tets].any(axis=1)]] = True
        free = near & movable
        if free.any():
            positions = improve(distortion.around(free), positions, free)
    return positions


def _scatter(tets: np.ndarray, count: int) -> sparse.csr_matrix:
    """(count, 4 m) sums over the corners of tets at each node."""
    return sparse.csr_matrix((np.ones(tets.size), (tets.ravel(), np.arange(tets.size))), shape=(count, tets.size))


def _edges(corners: np.ndarray) -> np.ndarray:
    """(m, 3, 3) edges from corner 0 as columns."""
    return (corners[:, 1:] - corners[:, :1]).transpose(0, 2, 1)


def _cofactor(matrix: np.ndarray) -> np.ndarray:
    rows = [np.cross(matrix[:, (k + 1) % 3], matrix[:, (k + 2) % 3]) for k in range(3)]
    return np.stack(rows, axis=1)


# Edges of a regular tet as columns, determinant 1.
_REGULAR = np.array([[0.0, 1, 1], [1, 0, 1], [1, 1, 0]]) * 0.5 ** (1 / 3)
