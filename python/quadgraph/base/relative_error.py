"""How far values are from others, relative."""

from __future__ import annotations

import numpy as np


def relative_rms(weight: np.ndarray, difference: np.ndarray, truth: np.ndarray) -> float:
    """Root of the weighted mean square of a difference (n, c) over that of the truth (n, c), channels together.

    weight: (n,), such as areas, or bool for a part that counts.
    """
    return float(np.sqrt(_squares(weight, difference) / _squares(weight, truth)))


def _squares(weight: np.ndarray, values: np.ndarray) -> float:
    # A product of vectors would be added up in parts, one for each thread that linear algebra has.
    return float((weight * (np.asarray(values, np.float64) ** 2).sum(axis=1)).sum())
