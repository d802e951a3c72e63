"""The grid on whose points a volume's coefficients are unknown: that of the material it becomes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from quadgraph.api.materials import VolumeMaterial


@dataclass(frozen=True)
class VolumeGrid:
    """Points of a regular grid, x fastest. low (3,): the first, mm; spacing, mm; size: of points along x, y, z."""

    low: tuple[float, float, float]
    spacing: float
    size: tuple[int, int, int]

    @staticmethod
    def around(points: np.ndarray, spacing: float) -> VolumeGrid:
        """The grid around (n, 3) points, mm, in their middle."""
        low, high = points.min(axis=0), points.max(axis=0)
        size = np.maximum(np.ceil((high - low) / spacing - 1e-6).astype(int) + 1, 2)
        first = (low + high) / 2 - spacing * (size - 1) / 2
        return VolumeGrid((float(first[0]), float(first[1]), float(first[2])), spacing, tuple(size.tolist()))

    @property
    def count(self) -> int:
        """Of points."""
        return int(np.prod(self.size))

    def points(self) -> np.ndarray:
        """(n, 3) mm."""
        axes = [low + self.spacing * np.arange(size) for low, size in zip(self.low, self.size, strict=True)]
        z, y, x = np.meshgrid(axes[2], axes[1], axes[0], indexing="ij")
        return np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)

    def weights(self, points: np.ndarray) -> sparse.csr_array:
        """(m, n) what each grid point counts at (m, 3) points: linear between them, as a material's are."""
        size = np.array(self.size)
        at = np.clip((points - np.array(self.low)) / self.spacing, 0, size - 1)
        first = np.minimum(at.astype(np.int64), size - 2)
        share = at - first
        rows, columns, values = [], [], []
        for corner in range(8):
            step = np.array([corner & 1, corner >> 1 & 1, corner >> 2])
            x, y, z = (first + step).T
            columns.append((z * size[1] + y) * size[0] + x)
            values.append(np.prod(np.where(step, share, 1 - share), axis=1))
            rows.append(np.arange(len(points)))
        entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
        return sparse.csr_array(entries, shape=(len(points), self.count))

    def differences(self) -> list[sparse.csr_array]:
        """Per axis (n, n): to the next point less this one, over the spacing, 1/mm; 0 at the last."""
        result = []
        for axis in range(3):
            factors = [sparse.eye_array(size) for size in self.size]
            size = self.size[axis]
            factors[axis] = sparse.diags_array(
                [np.append(-np.ones(size - 1), 0.0), np.ones(size - 1)], offsets=[0, 1], shape=(size, size)
            )
            product = sparse.kron(factors[2], sparse.kron(factors[1], factors[0]))
            result.append(sparse.csr_array(product) / self.spacing)
        return result

    def material(
        self,
        coefficients: np.ndarray,
        eta: float,
        deviations: np.ndarray | None = None,
        resolution: np.ndarray | None = None,
    ) -> VolumeMaterial:
        """The volume of sigma_a and sigma_s_prime, (2, n, 3) 1/mm, of the deviations of their logarithms, and of their
        resolution lengths, mm.
        """
        shape = (*self.size[::-1], 3)
        absorption, scattering = (each.reshape(shape) for each in coefficients)
        stated = []
        for known in (deviations, resolution):
            stated += [None, None] if known is None else [each.reshape(shape) for each in known[::-1]]
        return VolumeMaterial(scattering, absorption, self.spacing, self.low, eta, *stated)
