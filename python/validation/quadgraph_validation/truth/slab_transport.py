"""Transport through an infinite slab by discrete ordinates with exact modes in depth: the deterministic truth.

    mu dpsi/dtau + psi = albedo/2 (integral of psi over mu + phi_u),   psi(+mu) = R(mu) psi(-mu) at either surface

psi = 2 pi L of collided light; phi_u the fluence of light not scattered yet. With p = psi(mu) + psi(-mu) this is
p'' = mu^-2 (p - albedo integral(p) - albedo phi_u), whose modes are those of a symmetric matrix.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import linalg

from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.truth.fresnel import (
    composite_gauss,
    inside_cosines,
    lambertian_entry,
    reflectance_from_inside,
    refracted,
)

COLLIMATED = (np.array([1.0]), np.array([1.0]))
_ANGLES = 40  # per part of the hemisphere
_ANGLES_PER_BIN = 6
_ENTRY_ANGLES = 33
# A mode with zero decay has another form; this albedo differs from 1 by less than anything asked for.
_LARGEST_ALBEDO = 1 - 1e-11


@dataclass(frozen=True)
class SlabLight:
    """Where the light that entered a slab goes, as shares of it.

    reflectance, transmittance: scattered, through the lit and the unlit surface; unscattered: through either.
    """

    reflectance: float
    transmittance: float
    absorbed: float
    unscattered: float


@dataclass(frozen=True)
class Beam:
    """Unscattered light inside a slab: fluence down e^(-tau/mu) + up e^(-(depth-tau)/mu) per unit that entered."""

    mu: float
    down: float
    up: float
    out: float  # share that leaves unscattered, through both surfaces


def beam(mu: float, depth: float, eta: float) -> Beam:
    """Sum of all reflections between the surfaces of a slab of optical depth `depth` at inside cosine mu."""
    inside = float(reflectance_from_inside(mu, eta))
    once = np.exp(-depth / mu)
    amplitude = 1 / (1 - (inside * once) ** 2)
    return Beam(
        mu, amplitude / mu, amplitude * inside * once / mu, (1 - inside) * once * (1 + inside * once) * amplitude
    )


def entry(lambertian: bool, eta: float) -> tuple[np.ndarray, np.ndarray]:
    """Inside cosines and their shares of the light that entered."""
    return lambertian_entry(_ENTRY_ANGLES, eta) if lambertian else COLLIMATED


def discrete_ordinates(
    medium: Medium, thickness: float, eta: float, lambertian: bool, angles: int = _ANGLES
) -> SlabLight:
    """Transport through `thickness` mm, exact but for the number of angles (40: about 1e-6 of the light)."""
    depth = medium.sigma_t * thickness
    modes = _Modes(min(medium.albedo, _LARGEST_ALBEDO), depth, eta, inside_cosines(angles, eta))
    parts = []
    for mu, weight in zip(*entry(lambertian, eta), strict=True):
        light = beam(float(mu), depth, eta)
        reflected, transmitted, absorbed = modes.collided(light)
        parts.append(weight * np.array([reflected, transmitted, absorbed, light.out]))
    return SlabLight(*(float(x) for x in np.sum(parts, axis=0)))


def radiance_by_angle(medium: Medium, thickness: float, eta: float, cosine: float, bins: int = 10) -> np.ndarray:
    """Radiance of scattered light that leaves by the lit and the unlit side, (2, bins).

    In 1/(mm^2 sr) per 1/mm^2 that entered, collimated, at outside cosine `cosine`; cosine-weighted means over equal
    ranges of the outside cosine.
    """
    depth = medium.sigma_t * thickness
    modes = _Modes(min(medium.albedo, _LARGEST_ALBEDO), depth, eta, inside_cosines(_ANGLES_PER_BIN, eta, parts=bins))
    outside, weight = (x.reshape(bins, -1) for x in composite_gauss(_ANGLES_PER_BIN, bins))
    means = []
    for psi in modes.arriving(beam(float(refracted(cosine, 1 / eta)), depth, eta)):
        leaving = ((1 - modes.reflectance) * psi)[-outside.size :].reshape(bins, -1) / (2 * np.pi * eta**2)
        means.append((leaving * outside * weight).sum(axis=1) / (outside * weight).sum(axis=1))
    return np.array(means)


class _Modes:
    """Decay rates and angular shapes of collided light, and the boundary conditions at both surfaces."""

    def __init__(self, albedo: float, depth: float, eta: float, cosines: tuple[np.ndarray, np.ndarray]) -> None:
        self.albedo, self.depth = albedo, depth
        self.mu, self.weight = cosines
        self.reflectance = reflectance_from_inside(self.mu, eta)
        root = np.sqrt(self.weight)
        matrix = (np.eye(len(root)) - albedo * np.outer(root, root)) / np.outer(self.mu, self.mu)
        squared, vectors = np.linalg.eigh(matrix)
        self.rate = np.sqrt(np.clip(squared, 0, None))
        self.shape = vectors / (self.mu * root)[:, None]  # p of each mode, (angles, modes)
        self.slope = self.mu[:, None] * self.shape * self.rate  # psi(mu) - psi(-mu) of a falling mode
        keep, lose = 1 - self.reflectance[:, None], 1 + self.reflectance[:, None]
        near, far = keep * self.shape + lose * self.slope, keep * self.shape - lose * self.slope
        end = np.exp(-self.rate * depth)
        self.conditions = linalg.lu_factor(np.block([[near, far * end], [far * end, near]]))

    def collided(self, light: Beam) -> tuple[float, float, float]:
        """Shares reflected, transmitted and absorbed of the light that entered as `light`."""
        own = self._particular(light.mu)
        up, down, (falling, rising) = self._surfaces(light, own)
        leaving = self.weight * self.mu * (1 - self.reflectance)
        modes = (self.weight @ self.shape) * (falling + rising) * -np.expm1(-self.rate * self.depth) / self.rate
        uncollided = (light.down + light.up) * light.mu * -np.expm1(-self.depth / light.mu)
        absorbed = (1 - self.albedo) * (modes.sum() + (1 + self.weight @ own) * uncollided)
        return float(leaving @ up), float(leaving @ down), float(absorbed)

    def arriving(self, light: Beam) -> tuple[np.ndarray, np.ndarray]:
        """psi of collided light that meets the lit and the unlit surface from inside, by angle."""
        up, down, _ = self._surfaces(light, self._particular(light.mu))
        return up, down

    def _surfaces(self, light: Beam, own: np.ndarray) -> tuple[np.ndarray, np.ndarray, tuple[np.ndarray, np.ndarray]]:
        """psi towards the lit surface there and towards the unlit one there, and the modes' amplitudes."""
        once = np.exp(-self.depth / light.mu)
        p = own * np.array([light.down + light.up * once, light.down * once + light.up])[:, None]
        m = own * (self.mu / light.mu) * np.array([light.down - light.up * once, light.down * once - light.up])[:, None]
        falling, rising = self._amplitudes(p, m)
        end = np.exp(-self.rate * self.depth)
        p[0] += self.shape @ (falling + rising * end)
        p[1] += self.shape @ (falling * end + rising)
        m[0] += self.slope @ (falling - rising * end)
        m[1] += self.slope @ (falling * end - rising)
        return (p[0] - m[0]) / 2, (p[1] + m[1]) / 2, (falling, rising)

    def _particular(self, mu: float) -> np.ndarray:
        """P with p = P e^(-tau/mu) for the fluence phi_u = e^(-tau/mu)."""
        ratio = (self.mu / mu) ** 2
        shape = 1 / (1 - ratio)
        return shape * self.albedo / (1 - self.albedo * (self.weight @ shape))

    def _amplitudes(self, p: np.ndarray, m: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Amplitudes of the falling and rising modes that meet both boundary conditions beside (p, m)."""
        keep, lose = 1 - self.reflectance, 1 + self.reflectance
        right = np.concatenate([-(keep * p[0] + lose * m[0]), -(keep * p[1] - lose * m[1])])
        falling, rising = np.split(linalg.lu_solve(self.conditions, right), 2)
        return falling, rising
