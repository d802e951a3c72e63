"""Weights of the Laplacian at the nodes of a polygrid (Wang et al. 2008, Appendix B).

With d_j the offsets to a node's six neighbours in a local frame along its links, the weights w_j satisfy
sum_j w_j d_j = 0 and sum_j w_j d_jk^2 = 2 for each axis k; mixed terms are left out, as published. Where a link is
missing (under a corner of the polycube) the two axes across it share one equation. Where a weight would not be positive
(the frame is far from the links) the formula for a straight line is taken for each pair of links, whose weights are.
"""

from __future__ import annotations

import numpy as np

_LEAST = 1e-3  # of the largest weight


def frames(offsets: np.ndarray) -> np.ndarray:
    """(n, 3, 3) orthonormal columns nearest to the directions of the pairs of links, from (n, 6, 3) offsets."""
    length = np.linalg.norm(offsets, axis=2, keepdims=True)
    unit = offsets / np.where(length > 0, length, 1)
    axes = unit[:, 1::2] - unit[:, ::2]
    axes /= np.maximum(np.linalg.norm(axes, axis=2, keepdims=True), 1e-12)
    left, _, right = np.linalg.svd(axes.transpose(0, 2, 1))
    return left @ right


def laplacian(offsets: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Weights (n, 6), 1/mm^2, for (n, 6, 3) offsets, mm, zero for a missing link 5; and where they are the formula of
    a straight line, (n,) bool.
    """
    exact = _exact(offsets)
    missing = np.logical_not(offsets[:, 5].any(axis=1))
    used = np.where(missing[:, None], exact[:, :5].min(axis=1, initial=np.inf)[:, None], exact.min(axis=1)[:, None])
    with np.errstate(invalid="ignore"):
        bad = ~(used[:, 0] > _LEAST * exact.max(axis=1))
    return np.where(bad[:, None], straight(offsets), exact), bad


def _exact(offsets: np.ndarray) -> np.ndarray:
    size = np.linalg.norm(offsets, axis=2).mean(axis=1)
    local = np.einsum("ijk,ikl->ijl", offsets, frames(offsets)) / size[:, None, None]
    # Rows: the equations of x, x^2 / 2, y, y^2 / 2, z, z^2 / 2; columns: links.
    matrix = np.empty((len(offsets), 6, 6))
    matrix[:, ::2], matrix[:, 1::2] = local.transpose(0, 2, 1), 0.5 * local.transpose(0, 2, 1) ** 2
    right = np.tile([0.0, 1, 0, 1, 0, 1], (len(offsets), 1))
    missing = np.logical_not(offsets[:, 5].any(axis=1))
    matrix[missing, 3] += matrix[missing, 5]
    matrix[missing, 5] = np.eye(6)[5]
    right[missing, 3], right[missing, 5] = 2, 0
    singular = np.abs(np.linalg.det(matrix)) < 1e-9
    matrix[singular] = np.eye(6)
    weights = np.linalg.solve(matrix, right[..., None])[..., 0] / size[:, None] ** 2
    weights[singular] = np.nan
    return weights


def straight(offsets: np.ndarray) -> np.ndarray:
    """Weights (n, 6), 1/mm^2, as if both links of each pair lay on a straight line."""
    length = np.linalg.norm(offsets, axis=2)
    both = length.reshape(-1, 3, 2).sum(axis=2).repeat(2, axis=1)
    missing = np.logical_not(offsets[:, 5].any(axis=1))
    with np.errstate(divide="ignore"):
        weights = 2 / (length * both)
        # Three links of a plane at equal angles.
        weights[missing, 2:5] = 4 / (3 * length[missing, 2:5] ** 2)
    weights[missing, 5] = 0
    return weights


def skew(offsets: np.ndarray) -> np.ndarray:
    """(n, 6) angles, degrees, between each link and its axis of the frame; 0 for a missing link."""
    local = np.einsum("ijk,ikl->ijl", offsets, frames(offsets))
    along = np.abs(np.stack([local[:, k, k // 2] for k in range(6)], axis=1))
    length = np.linalg.norm(offsets, axis=2)
    across = np.sqrt(np.maximum(length**2 - along**2, 0))
    return np.degrees(np.arctan2(across, along))
