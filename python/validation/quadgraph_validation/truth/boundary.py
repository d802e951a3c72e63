"""Boundary conditions of the diffusion and SP3 equations (docs/physics.md, "Diffusion" and "Boundary matrix")."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from quadgraph_validation.truth.fresnel import moment

# (phi1, phi2) = _TO_KLOSE (phi, phi2): Klose and Larsen's unknowns from the collided fluence and the second moment.
_TO_KLOSE = np.array([[1, 2 / 3], [0, 1]])


@dataclass(frozen=True, eq=False)
class Boundary:
    """Outward flux = matrix @ u - matrix[:, 0] source q; exitance M = matrix[0] @ u - reflected q.

    matrix: (m, m) for m moments, symmetric; source and reflected are 0 where the light enters buried.
    """

    matrix: np.ndarray
    source: float = 0.0
    reflected: float = 0.0


def published(eta: float) -> Boundary:
    """The papers' condition with the polynomial F_dr and A = (1 + F_dr) / (1 - F_dr) [QG Eq. 2]; diffuse source."""
    f_dr = published_reflectance(eta)
    return _diffuse(np.array([[(1 - f_dr) / (2 * (1 + f_dr))]]), f_dr)


def published_reflectance(eta: float) -> float:
    """The published polynomial F_dr; 0 without an index step."""
    return 0.0 if eta == 1 else -1.440 / eta**2 + 0.710 / eta + 0.668 + 0.0636 * eta


def diffusion(eta: float, diffuse_source: bool = False) -> Boundary:
    """Two-moment A = (1 + 3 R2) / (1 - 2 R1) from the exact Fresnel reflectance."""
    matrix = np.array([[(1 - 2 * moment(1, eta)) / (2 * (1 + 3 * moment(2, eta)))]])
    return _diffuse(matrix, 2 * moment(1, eta)) if diffuse_source else Boundary(matrix)


def sp3(eta: float, diffuse_source: bool = False) -> Boundary:
    """SP3 in (phi, phi2), with the symmetric part of Klose and Larsen's matrix."""
    matrix = klose_larsen(eta)
    matrix = _TO_KLOSE.T @ ((matrix + matrix.T) / 2) @ _TO_KLOSE
    return _diffuse(matrix, 2 * moment(1, eta)) if diffuse_source else Boundary(matrix)


def klose_larsen(eta: float) -> np.ndarray:
    """K (2, 2) of docs/physics.md, "Boundary matrix", in (phi1, phi2), as it is: not symmetric for eta > 1."""
    r = [moment(order, eta) if order else 0.0 for order in range(7)]
    a2 = -9 / 4 * r[1] + 15 / 2 * r[3] - 25 / 4 * r[5]
    b2 = 63 / 4 * r[2] - 105 / 2 * r[4] + 175 / 4 * r[6]
    c, d = -3 / 2 * r[1] + 5 / 2 * r[3], 3 / 2 * r[2] - 5 / 2 * r[4]
    left = np.array([[1 + 3 * r[2], -7 * d], [-3 * d, 1 + b2]])
    right = np.array([[1 / 2 - r[1], -(1 / 8 + c)], [-(1 / 8 + c), 7 / 24 + a2]])
    return np.linalg.solve(left, right)


def _diffuse(matrix: np.ndarray, reflectance: float) -> Boundary:
    source = 4 / (1 - reflectance)
    return Boundary(matrix, source, matrix[0, 0] * source - 1)
