"""Exact solutions in spheres and infinite cylinders of concentric layers, diffuse source, for either model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.special import eval_legendre, ive, kve

from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.truth.boundary import Boundary
from quadgraph_validation.truth.moments import ModelOf, Moments


@dataclass(frozen=True)
class Shell:
    """A homogeneous layer from the next smaller radius out to `radius` mm."""

    medium: Medium
    radius: float


def sphere(
    shells: Sequence[Shell],
    coefficients: Sequence[float],
    model: ModelOf,
    boundary: Boundary,
    r: np.ndarray,
    cos_theta: np.ndarray,
) -> np.ndarray:
    """Moments (m, n), W/mm^2, at (n,) r mm and cos theta for irradiance q = sum coefficients[l] P_l(cos theta).

    shells: innermost first.
    """
    shapes = [eval_legendre(order, cos_theta) for order in range(len(coefficients))]
    return _sum(_Waves(0.5), shells, coefficients, shapes, model, boundary, r)


def cylinder(
    shells: Sequence[Shell],
    coefficients: Sequence[float],
    model: ModelOf,
    boundary: Boundary,
    r: np.ndarray,
    theta: np.ndarray,
) -> np.ndarray:
    """Moments (m, n), W/mm^2, at (n,) r mm and theta for irradiance q = sum coefficients[m] cos(m theta)."""
    shapes = [np.cos(order * np.asarray(theta)) for order in range(len(coefficients))]
    return _sum(_Waves(0.0), shells, coefficients, shapes, model, boundary, r)


def _sum(
    waves: _Waves,
    shells: Sequence[Shell],
    coefficients: Sequence[float],
    shapes: Sequence[np.ndarray],
    model: ModelOf,
    boundary: Boundary,
    r: np.ndarray,
) -> np.ndarray:
    systems = [model(shell.medium) for shell in shells]
    edges = [shell.radius for shell in shells]
    r = np.maximum(np.asarray(r, np.float64), 1e-6 * edges[-1])
    where = np.minimum(np.searchsorted(edges, r), len(shells) - 1)
    result = np.zeros((len(boundary.matrix), len(r)))
    for order, coefficient in enumerate(coefficients):
        if coefficient == 0:
            continue
        amplitudes = _amplitudes(waves, systems, edges, boundary, order)
        for index, system in enumerate(systems):
            inside = where == index
            values, _ = waves.basis(system, order, r[inside], edges[index], index > 0)
            result[:, inside] += coefficient * np.einsum("nij,j->in", values, amplitudes[index]) * shapes[order][inside]
    return result


def _amplitudes(
    waves: _Waves, systems: Sequence[Moments], edges: Sequence[float], boundary: Boundary, order: int
) -> list[np.ndarray]:
    """Per shell the amplitudes of its waves for q = 1 of one angular order."""
    moments = len(boundary.matrix)
    widths = [moments * (2 if index else 1) for index in range(len(systems))]
    starts = np.cumsum([0, *widths])
    matrix, right = np.zeros((starts[-1], starts[-1])), np.zeros(starts[-1])

    def at(index: int, radius: float) -> tuple[np.ndarray, np.ndarray]:
        values, slopes = waves.basis(systems[index], order, np.array([radius]), edges[index], index > 0)
        return values[0], systems[index].stiffness @ slopes[0]

    for index in range(len(systems) - 1):
        rows = slice(2 * moments * index, 2 * moments * (index + 1))
        inner, outer = at(index, edges[index]), at(index + 1, edges[index])
        matrix[rows, starts[index] : starts[index + 1]] = np.vstack(inner)
        matrix[rows, starts[index + 1] : starts[index + 2]] = -np.vstack(outer)
    value, flux = at(len(systems) - 1, edges[-1])
    matrix[-moments:, starts[-2] :] = flux + boundary.matrix @ value
    right[-moments:] = boundary.matrix[:, 0] * boundary.source
    solution = np.linalg.solve(matrix, right)
    return [solution[a:b] for a, b in pairwise(starts)]


@dataclass(frozen=True)
class _Waves:
    """Radial functions r^-h I_(order + h)(s r) and K alike: h = 1/2 in spheres, 0 in cylinders."""

    h: float

    def basis(
        self, system: Moments, order: int, r: np.ndarray, edge: float, hollow: bool
    ) -> tuple[np.ndarray, np.ndarray]:
        """(n, m, waves) moments of every wave and their slopes at (n,) r; `hollow`: those that grow inwards, too.

        Every wave is scaled to 1 at the outer `edge`.
        """
        rates, vectors = system.modes
        s = np.maximum(rates, 1e-5 / edge)
        kinds = [self._growing, self._falling] if hollow else [self._growing]
        values, slopes = [], []
        for kind in kinds:
            value, slope = kind(order, s, r[:, None], edge)
            values.append(value[:, None, :] * vectors)
            slopes.append(slope[:, None, :] * vectors)
        return np.concatenate(values, axis=2), np.concatenate(slopes, axis=2)

    def _growing(self, order: int, s: np.ndarray, r: np.ndarray, edge: float) -> tuple[np.ndarray, np.ndarray]:
        nu = order + self.h
        scale = (edge / r) ** self.h * np.exp(s * (r - edge)) / ive(nu, s * edge)
        value = scale * ive(nu, s * r)
        return value, scale * s * ive(nu + 1, s * r) + order / r * value

    def _falling(self, order: int, s: np.ndarray, r: np.ndarray, edge: float) -> tuple[np.ndarray, np.ndarray]:
        nu = order + self.h
        scale = (edge / r) ** self.h * np.exp(s * (edge - r)) / kve(nu, s * edge)
        value = scale * kve(nu, s * r)
        return value, -scale * s * kve(nu + 1, s * r) + order / r * value
