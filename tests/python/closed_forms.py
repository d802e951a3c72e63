"""Exact solutions of the diffusion equation with the papers' boundary condition (physics.md, "Closed forms")."""

from __future__ import annotations

import numpy as np
from scipy.special import eval_legendre, spherical_in


def sphere_surface_fluence(
    cos_theta: np.ndarray, coefficients: list[float], radius: float, kappa: float, sigma_a: float, mismatch: float
) -> np.ndarray:
    """Fluence on a sphere's surface for boundary source Q = sum_l coefficients[l] P_l(cos theta).

    radius in mm, kappa in mm, sigma_a in 1/mm (> 0), mismatch = A; Q and the result in W/mm^2.
    """
    sigma_tr = np.sqrt(sigma_a / kappa)
    b = 2 * mismatch * kappa
    phi = np.zeros_like(cos_theta)
    for order, coefficient in enumerate(coefficients):
        value = spherical_in(order, sigma_tr * radius)
        slope = spherical_in(order, sigma_tr * radius, derivative=True)
        phi += coefficient * eval_legendre(order, cos_theta) * value / (value + b * sigma_tr * slope)
    return phi
