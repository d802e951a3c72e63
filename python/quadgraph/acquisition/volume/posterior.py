"""How certain a volume's coefficients are: Laplace's approximation, of low rank in what the photographs tell.

Around the fit the inverse covariance of the logarithms is H + L: H is the matrix of Gauss and Newton, L the smoothing.
Its covariance is that of L alone less what the leading pairs of H v = k L v take away [Flath et al. 2011],
which random vectors find [Halko et al. 2011]. Pairs that are not found leave deviations too large, not too small.

What is found of a true difference beside the fit is that difference times the matrix 1 - C L, with C the covariance
[Backus and Gilbert 1968]. Its diagonal is the share of a point's own that reaches it, and one over it is how many
points have one number together: the edge of a cube of these is the resolution length.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy import linalg, sparse

RANK = 40  # random vectors
_LEAST = 1e-6  # of the smoothing's diagonal, what every point has of a prior: constants cost the smoothing nothing


class Known(NamedTuple):
    """What is known of logarithms, (2, n, 3) each. deviations: standard ones; resolved: the diagonal of 1 - C L, from
    0, all of it from the smoothing, to 1, all of it from the photographs.
    """

    deviations: np.ndarray
    resolved: np.ndarray

    def lengths(self, spacing: float) -> np.ndarray:
        """(2, n, 3) resolution lengths on a grid of that spacing, in its unit; at most of all n points together."""
        return spacing / np.cbrt(np.maximum(self.resolved, 1 / self.resolved.shape[1]))


def known(
    told: Callable[[np.ndarray], np.ndarray], smoothing: Sequence[sparse.csr_array], shape: tuple[int, ...]
) -> Known:
    """What is known of logarithms of that shape, (2, n, 3).

    told: H times a direction of that shape; channels do not mix; smoothing: L of each coefficient, of all channels.
    Takes RANK products with H and a dense inverse of n x n.
    """
    count = shape[1]
    factors = []
    for matrix in smoothing:
        dense = matrix.toarray()
        factors.append(np.linalg.cholesky(dense + _LEAST * dense.diagonal().max() * np.eye(count)))
    variance = np.stack([_diagonal_of_inverse(factor) for factor in factors])
    random = np.random.default_rng(0)
    directions = random.normal(size=(RANK, *shape))
    # Of C^-1 H C^-T, which is symmetric, where L = C C^T.
    images = _whitened(told, factors, directions)
    spread, resolved = np.empty((2, *shape))
    for channel in range(3):
        first = directions[..., channel].reshape(RANK, -1).T
        second = images[..., channel].reshape(RANK, -1).T
        values, vectors = _nystrom(first, second)
        parts = list(zip(factors, np.split(vectors, 2), strict=True))
        unwhitened = np.concatenate([linalg.solve_triangular(factor.T, part) for factor, part in parts])
        smoothed = np.concatenate([factor @ part for factor, part in parts])  # L times the unwhitened
        share = values / (1 + values)
        taken = (unwhitened**2 @ share).reshape(2, count)
        spread[..., channel] = np.sqrt(np.maximum(variance - taken, 0))
        resolved[..., channel] = ((unwhitened * smoothed) @ share).reshape(2, count)
    return Known(spread, np.clip(resolved, 0, 1))


def _diagonal_of_inverse(factor: np.ndarray) -> np.ndarray:
    """(n,) of the inverse of C C^T."""
    inverse = linalg.solve_triangular(factor, np.eye(len(factor)), lower=True)
    return (inverse**2).sum(axis=0)


def _whitened(
    told: Callable[[np.ndarray], np.ndarray], factors: Sequence[np.ndarray], directions: np.ndarray
) -> np.ndarray:
    images = np.empty_like(directions)
    for number, direction in enumerate(directions):
        inner = np.stack([linalg.solve_triangular(f.T, part) for f, part in zip(factors, direction, strict=True)])
        outer = told(inner)
        images[number] = np.stack(
            [linalg.solve_triangular(f, part, lower=True) for f, part in zip(factors, outer, strict=True)]
        )
    return images


def _nystrom(directions: np.ndarray, images: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues and orthonormal vectors of a positive matrix from its products with random directions (m, k).

    The approximation is below the matrix [Tropp et al. 2017].
    """
    shift = 1e-12 * np.linalg.norm(images)
    shifted = images + shift * directions
    middle = directions.T @ shifted
    factor = np.linalg.cholesky((middle + middle.T) / 2)
    half = linalg.solve_triangular(factor, shifted.T, lower=True).T
    vectors, sizes, _ = np.linalg.svd(half, full_matrices=False)
    return np.maximum(sizes**2 - shift, 0), vectors
