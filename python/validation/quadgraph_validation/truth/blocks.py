"""Pictures compared by blocks of pixels, with the noise of the truth taken away."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

BLOCK = 4  # pixels along an edge
BRIGHT = 0.25  # of the block that 95% of the covered ones are not brighter than: above it a block counts as bright


@dataclass(frozen=True)
class Deviation:
    """How far a picture is from the truth over some blocks; everything relative.

    rms: root mean square of the difference over that of the truth, the truth's noise taken away in quadrature (0 where
    the noise is larger than the difference); noise: that of the truth; mean: ratio of the means; blocks: how many.
    """

    rms: float
    noise: float
    mean: float
    blocks: int


def means(image: np.ndarray) -> np.ndarray:
    """Block means (h/BLOCK, w/BLOCK) of an image (h, w) whose sides are multiples of BLOCK."""
    h, w = image.shape
    return image.reshape(h // BLOCK, BLOCK, w // BLOCK, BLOCK).mean(axis=(1, 3))


def errors(error: np.ndarray) -> np.ndarray:
    """Standard errors of the block means from those of independent pixels (h, w)."""
    return np.sqrt(means(error**2)) / BLOCK


def covered(alpha: np.ndarray) -> np.ndarray:
    """Blocks, bool, that the object covers wholly, from the pixels' coverage (h, w)."""
    return means((alpha > 1 - 1e-3).astype(float)) == 1


def parts(truth: np.ndarray, alpha: np.ndarray) -> dict[str, np.ndarray]:
    """Covered blocks, bool, of an image (h, w): all of them, the bright and the dark ones."""
    inside, values = covered(alpha), means(truth)
    bright = inside & (values >= BRIGHT * np.quantile(values[inside], 0.95))
    return {"all": inside, "bright": bright, "dark": inside & ~bright}


def deviation(found: np.ndarray, truth: np.ndarray, error: np.ndarray, chosen: np.ndarray) -> Deviation:
    """Compare two images (h, w), the truth with standard errors (h, w), over the chosen blocks."""
    if not chosen.any():
        return Deviation(float("nan"), float("nan"), float("nan"), 0)
    ours, true = means(found)[chosen], means(truth)[chosen]
    noise = np.mean(errors(error)[chosen] ** 2)
    # The noise is in the truth's own mean square too.
    scale = max(np.mean(true**2) - noise, np.finfo(float).tiny)
    rms = np.sqrt(max(np.mean((ours - true) ** 2) - noise, 0) / scale)
    return Deviation(float(rms), float(np.sqrt(noise / scale)), float(ours.mean() / true.mean()), int(chosen.sum()))
