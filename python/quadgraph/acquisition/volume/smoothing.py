"""What is taken of a volume where the photographs leave it open: as little total variation as can be, or slopes.

Total variation of the logarithms of each coefficient, over red, green and blue together (vectorial), with Huber's
threshold. It is weighed by how much the photographs tell of a place, or what lies deep would be smoothed away while
what lies at the surface took its part [Arridge and Lionheart 1998, Harrach 2009 on why steps and not slopes].
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import sparse

from quadgraph.acquisition.volume.volume_grid import VolumeGrid

LEAST_SHARE = 0.1  # of the largest volume that a point stands for, what others count at least


class Smoothing:
    """Huber's total variation of logarithms (2, n, 3) on a grid, or the square of their H1 seminorm."""

    def __init__(
        self, grid: VolumeGrid, inside: np.ndarray, weight: np.ndarray, threshold: float, edges: bool = True
    ) -> None:
        """inside (n,): volume of the body that each point stands for, mm^3; weight (2, n), of each coefficient;
        threshold: of a slope, 1/mm, below which it counts as its square; edges: False: every slope does (H1).
        """
        self._differences = grid.differences()
        self._volume = np.maximum(inside, LEAST_SHARE * inside.max())
        self._weight, self._threshold, self._edges = weight, threshold, edges

    def _slopes(self, logs: np.ndarray, coefficient: int) -> np.ndarray:
        """(n,) of all axes and channels together, 1/mm."""
        parts = [each @ logs[coefficient] for each in self._differences]
        return np.sqrt(sum((part**2).sum(axis=1) for part in parts))

    def cost(self, logs: np.ndarray) -> float:
        """Half of it is what is added to half the sum of squares."""
        total = 0.0
        for coefficient in range(2):
            slope = self._slopes(logs, coefficient)
            small = (slope <= self._threshold) | (not self._edges)
            value = np.where(small, slope**2 / self._threshold, 2 * slope - self._threshold)
            total += float((self._volume * self._weight[coefficient] * value).sum())
        return total

    def matrices(self, logs: np.ndarray) -> Sequence[sparse.csr_array]:
        """Two matrices (n, n), of each coefficient's channels: the quadratic that touches the cost at `logs`."""
        result = []
        for coefficient in range(2):
            slope = self._slopes(logs, coefficient) if self._edges else 0.0
            held = np.maximum(slope, self._threshold)
            scale = sparse.diags_array(self._volume * self._weight[coefficient] / held)
            result.append(sparse.csr_array(sum(each.T @ scale @ each for each in self._differences)))
        return result
