"""The smooth surface between a body of relative index eta >= 1 and the air: exact, unpolarised."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import numpy.typing as npt


def refracted(cosine: npt.ArrayLike, ratio: float) -> np.ndarray:
    """Cosine beyond the surface of light that meets it at `cosine`; 0 under total reflection.

    ratio: index on the light's side over the index beyond.
    """
    return np.sqrt(np.clip(1 - ratio**2 * (1 - np.asarray(cosine) ** 2), 0, None))


def reflectance_from_inside(cosine: npt.ArrayLike, eta: float) -> np.ndarray:
    """Fresnel reflectance R(mu) for light inside that meets the surface at `cosine`; 1 under total reflection."""
    cosine = np.asarray(cosine, np.float64)
    beyond = refracted(cosine, eta)
    total = beyond <= 0
    with np.errstate(invalid="ignore", divide="ignore"):
        s = (eta * cosine - beyond) / (eta * cosine + beyond)
        p = (cosine - eta * beyond) / (cosine + eta * beyond)
    return np.where(total, 1.0, (s**2 + p**2) / 2)


def transmittance_from_outside(cosine: npt.ArrayLike, eta: float) -> np.ndarray:
    """Share of the light arriving from outside at `cosine` that enters."""
    return 1 - reflectance_from_inside(refracted(cosine, 1 / eta), eta)


def critical_cosine(eta: float) -> float:
    """Inside cosine below which everything is reflected."""
    return float(np.sqrt(1 - 1 / eta**2))


def gauss(count: int, low: float = 0.0, high: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Gauss-Legendre nodes and weights on [low, high]."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return low + (high - low) * (nodes + 1) / 2, (high - low) / 2 * weights


def composite_gauss(count: int, parts: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss-Legendre nodes and weights on [0, 1], `count` in each of `parts` equal parts."""
    pieces = [gauss(count, part / parts, (part + 1) / parts) for part in range(parts)]
    return np.concatenate([nodes for nodes, _ in pieces]), np.concatenate([weights for _, weights in pieces])


def inside_cosines(count: int, eta: float, parts: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights over the inside cosine in [0, 1], split at the critical angle; count * parts in either piece.

    Beyond the critical angle the outside cosine is the variable: R(mu) is smooth in it, and has a root in mu. Those
    nodes come last, `count` to each of `parts` equal ranges of the outside cosine.
    """
    critical = critical_cosine(eta)
    outside, weights = composite_gauss(count, parts)
    inside = refracted(outside, 1 / eta)
    weights = weights * outside / (eta**2 * inside)
    if critical == 0:
        return inside, weights
    trapped, trapped_weights = gauss(count * parts, 0, critical)
    return np.concatenate([trapped, inside]), np.concatenate([trapped_weights, weights])


@lru_cache(maxsize=256)
def moment(order: int, eta: float) -> float:
    """R_n, the integral of R(mu) mu^n over the inside cosine from 0 to 1 (docs/physics.md, "Fresnel terms")."""
    critical = critical_cosine(eta)
    # The outside cosine squared: R falls from 1 within a cosine of sqrt(eta - 1), which is narrow for eta near 1.
    root, weights = gauss(200)
    outside = root**2
    inside = refracted(outside, 1 / eta)
    integrand = reflectance_from_inside(inside, eta) * inside ** (order - 1) * outside / eta**2
    return critical ** (order + 1) / (order + 1) + float(weights @ (2 * root * integrand))


def lambertian_entry(count: int, eta: float) -> tuple[np.ndarray, np.ndarray]:
    """Inside cosines and weights (sum 1) of diffuse light from outside, after entering: c T(c) dc, c outside."""
    outside, weights = gauss(count)
    weights = weights * outside * transmittance_from_outside(outside, eta)
    return refracted(outside, 1 / eta), weights / weights.sum()


def entering_share(lambertian: bool, eta: float) -> float:
    """Share of the light arriving from outside, at normal incidence or diffuse, that enters."""
    if not lambertian:
        return float(transmittance_from_outside(1.0, eta))
    outside, weights = gauss(100)
    return float(2 * weights @ (outside * transmittance_from_outside(outside, eta)))
