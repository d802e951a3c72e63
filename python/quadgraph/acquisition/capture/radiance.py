"""A photograph as linear values with their variances, whatever it was made of."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Radiance:
    """values, variances: (h, w, 3) float32, value over exposure; usable: (h, w, 3), not saturated in all exposures."""

    values: np.ndarray
    variances: np.ndarray
    usable: np.ndarray
