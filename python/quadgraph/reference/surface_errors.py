"""Errors of an exitance over the whole surface of a body and over its unlit part."""

from __future__ import annotations

import numpy as np

PARTS = ("whole", "unlit")
UNLIT_BELOW = 0.1  # of the mean irradiance, as the engine has it
LEAST_SHARE = 0.02  # of the area: a smaller unlit part is not judged


def weights(area: np.ndarray, q: np.ndarray) -> dict[str, np.ndarray]:
    """Areas (n,) of the faces by part, 0 outside it, from areas (n,) and irradiance q (n, 3).

    A part of too small a share of the area is left out.
    """
    total = np.asarray(q, np.float64).sum(axis=1)
    unlit = total < UNLIT_BELOW * (area @ total) / area.sum()
    found = {"whole": area, "unlit": area * unlit}
    return {part: weight for part, weight in found.items() if weight.sum() > LEAST_SHARE * area.sum()}


def relative(weight: np.ndarray, difference: np.ndarray, truth: np.ndarray) -> float:
    """Root of the weighted mean square of a difference (n, 3) over that of the truth (n, 3), channels together."""
    return float(np.sqrt(_squares(weight, difference) / _squares(weight, truth)))


def _squares(weight: np.ndarray, values: np.ndarray) -> float:
    return float(weight @ (np.asarray(values, np.float64) ** 2).sum(axis=1))
