"""What a half-space sends back, scattering by scattering: Chandrasekhar's H function and its series in the albedo.

Isotropic scattering below an index-matched surface. H solves H(mu) = 1 + a/2 mu H(mu) int H(m) / (mu + m) dm over m in
[0, 1] [Chandrasekhar 1960]; what scatters n times is the coefficient of a^n, so light that a cut loses is a sum.
"""

from __future__ import annotations

import numpy as np

from quadgraph_validation.truth.fresnel import gauss

_ANGLES = 48  # in each half of the nodes, which gather at 0, where H has a logarithm
_FREQUENCIES = 400


def reflectance(albedo: float, cosine: float = 1.0) -> float:
    """Share of light entering at a cosine that a half-space of albedo below 1 sends back: 1 - H(mu) sqrt(1 - a)."""
    return float(1 - _h(albedo, cosine) * np.sqrt(1 - albedo))


def by_scatterings(count: int, cosine: float = 1.0) -> np.ndarray:
    """(count + 1,) what comes back after n scatterings over a^n, of light that enters at a cosine; the first is 0."""
    mu, weights = _nodes()
    mu, weights = np.append(mu, cosine), np.append(weights, 0.0)  # H is wanted there, and enters no integral
    over = weights / (mu[:, None] + mu)
    h = np.zeros((count + 1, len(mu)))
    h[0] = 1
    inner, leaving = [over @ h[0]], [over @ (mu * h[0])]
    found = np.zeros(count + 1)
    for order in range(1, count + 1):
        pairs = [(h[j], order - 1 - j) for j in range(order)]
        found[order] = sum(each[-1] * leaving[k][-1] for each, k in pairs) / 2
        h[order] = mu / 2 * sum(each * inner[k] for each, k in pairs)
        inner.append(over @ h[order])
        leaving.append(over @ (mu * h[order]))
    return found


def _nodes() -> tuple[np.ndarray, np.ndarray]:
    root, weights = gauss(2 * _ANGLES)
    return root**3, 3 * root**2 * weights


def _h(albedo: float, cosine: float) -> float:
    """H by its closed form, ln H = -mu/pi int ln(1 - a arctan(k)/k) / (1 + mu^2 k^2) dk, k = tan(angle)."""
    angle, weights = gauss(_FREQUENCIES, 0.0, np.pi / 2)
    # Where a is close to 1 the logarithm changes within k of sqrt(1 - a): nodes gather there.
    t, slope = (2 / np.pi) ** 2 * angle**3, 3 * (2 / np.pi) ** 2 * angle**2
    k = np.tan(t)
    inside = np.log1p(-albedo * t / k) / (np.cos(t) ** 2 + (cosine * np.sin(t)) ** 2)
    return float(np.exp(-cosine / np.pi * (weights * slope) @ inside))
