"""Errors of an exitance over the whole surface of a body and over its unlit part."""

from __future__ import annotations

import numpy as np

PARTS = ("whole", "unlit")
UNLIT_BELOW = 0.1  # of the mean irradiance, as the engine has it
LEAST_SHARE = 0.02  # of the area: a smaller unlit part is not judged


def unlit_part(area: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Faces (n,) bool of area (n,) that let in less than a tenth of the mean irradiance, q (n, 3)."""
    total = np.asarray(q, np.float64).sum(axis=1)
    return total < UNLIT_BELOW * (area @ total) / area.sum()


def weights(area: np.ndarray, q: np.ndarray) -> dict[str, np.ndarray]:
    """Areas (n,) of the faces by part, 0 outside it, from areas (n,) and irradiance q (n, 3).

    A part of too small a share of the area is left out.
    """
    return weights_of(area, unlit_part(area, q))


def weights_of(area: np.ndarray, unlit: np.ndarray) -> dict[str, np.ndarray]:
    """Weights of faces by part, where the unlit faces (n,) bool are known."""
    found = dict(zip(PARTS, (area, area * unlit), strict=True))
    return {part: weight for part, weight in found.items() if weight.sum() > LEAST_SHARE * area.sum()}
