"""Measured media (Jensen et al. 2001, Figure 5) that the studies use; kept apart from the engine's list."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Medium:
    """A homogeneous medium with isotropic scattering, one channel; both coefficients in 1/mm."""

    sigma_s_prime: float
    sigma_a: float

    @property
    def sigma_t(self) -> float:
        """Extinction, 1/mm."""
        return self.sigma_s_prime + self.sigma_a

    @property
    def albedo(self) -> float:
        """Single-scattering albedo."""
        return self.sigma_s_prime / self.sigma_t

    @property
    def kappa(self) -> float:
        """Diffusion coefficient, mm."""
        return 1 / (3 * self.sigma_t)

    @property
    def sigma_tr(self) -> float:
        """Effective transport coefficient, 1/mm."""
        return float(np.sqrt(self.sigma_a / self.kappa))


# Name to (sigma_s' R G B, sigma_a R G B), 1/mm.
_TABLE = {
    "marble": ((2.19, 2.62, 3.00), (0.0021, 0.0041, 0.0071)),
    "wholemilk": ((2.55, 3.21, 3.77), (0.0011, 0.0024, 0.014)),
    "skin1": ((0.74, 0.88, 1.01), (0.032, 0.17, 0.48)),
    "ketchup": ((0.18, 0.07, 0.03), (0.061, 0.97, 1.45)),
}
NAMES = tuple(_TABLE)
CHANNELS = "RGB"


def media(name: str) -> list[Medium]:
    """The three channels of a medium in NAMES."""
    scattering, absorption = _TABLE[name]
    return [Medium(s, a) for s, a in zip(scattering, absorption, strict=True)]
