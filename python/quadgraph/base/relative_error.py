"""How far values are from others, relative."""

from __future__ import annotations

import numpy as np


def relative_rms(weight: np.ndarray, difference: np.ndarray, truth: np.ndarray) -> float:
    """Root of the weighted mean square of a difference (n, 3) over that of the truth (n, 3), channels together."""
    return float(np.sqrt(_squares(weight, difference) / _squares(weight, truth)))


def _squares(weight: np.ndarray, values: np.ndarray) -> float:
    return float(weight @ (np.asarray(values, np.float64) ** 2).sum(axis=1))
