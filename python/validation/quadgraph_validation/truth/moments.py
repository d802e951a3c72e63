"""Diffusion and SP3 as one system of m moments with constant coefficients (docs/physics.md, "SP3").

    -div(stiffness grad u) + mass u = (S, 0),   u = (phi) or (phi, phi2)

phi is the fluence of collided light, phi2 = the second of Klose and Larsen's unknowns, S = sigma_s' times the fluence
of light not yet scattered. The eigenvectors of the pair of matrices uncouple it into Helmholtz equations.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import linalg

from quadgraph_validation.bodies.media import Medium


@dataclass(frozen=True, eq=False)
class Moments:
    """stiffness (m, m) mm and mass (m, m) 1/mm, both symmetric, stiffness positive definite."""

    stiffness: np.ndarray
    mass: np.ndarray

    @cached_property
    def modes(self) -> tuple[np.ndarray, np.ndarray]:
        """Decay rates (m,) 1/mm and their vectors (m, m), in columns: mass v = rate^2 stiffness v."""
        squared, vectors = linalg.eigh(self.mass, self.stiffness)
        return np.sqrt(np.clip(squared, 0, None)), vectors


# The two models' matrices: what kappa, sigma_a and sigma_t multiply.
STIFFNESS = {1: np.array([[1.0]]), 2: np.array([[1, 2 / 3], [2 / 3, 55 / 63]])}
ABSORPTION = {1: np.array([[1.0]]), 2: np.array([[1.0, 0], [0, 0]])}
EXTINCTION = {1: np.array([[0.0]]), 2: np.array([[0.0, 0], [0, 5 / 9]])}


def _moments(medium: Medium, count: int) -> Moments:
    mass = medium.sigma_a * ABSORPTION[count] + medium.sigma_t * EXTINCTION[count]
    return Moments(medium.kappa * STIFFNESS[count], mass)


def diffusion(medium: Medium) -> Moments:
    """One moment, the fluence."""
    return _moments(medium, 1)


def sp3(medium: Medium) -> Moments:
    """Two moments."""
    return _moments(medium, 2)


ModelOf = Callable[[Medium], Moments]
