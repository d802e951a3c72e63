"""Exact solutions in slabs and the half-space: either model, boundary and source (docs/physics.md, "Closed forms")."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.truth.boundary import Boundary
from quadgraph_validation.truth.fresnel import gauss, reflectance_from_inside
from quadgraph_validation.truth.moments import ModelOf, Moments
from quadgraph_validation.truth.slab_transport import SlabLight

_DEPTHS = 64  # Gauss nodes per layer for the absorbed power


@dataclass(frozen=True)
class Layer:
    """A homogeneous layer, `thickness` mm."""

    medium: Medium
    thickness: float


@dataclass(frozen=True)
class ClosedFormBeam:
    """Unscattered light in a layer, fluence amplitude e^(start + rate z) at depth z mm, the exponent at most 0."""

    amplitude: float
    start: float
    rate: float

    def at(self, z: float) -> float:
        """Fluence per unit that entered."""
        return float(self.amplitude * np.exp(self.start + self.rate * z))


def slab(
    medium: Medium,
    thickness: float,
    model: ModelOf,
    boundary: Boundary,
    eta: float = 1.0,
    light: tuple[np.ndarray, np.ndarray] | None = None,
) -> SlabLight:
    """What a homogeneous slab of `thickness` mm does to the light that entered; see `layered_slab`."""
    return layered_slab([Layer(medium, thickness)], model, boundary, eta, light)


def layered_slab(
    layers: Sequence[Layer],
    model: ModelOf,
    boundary: Boundary,
    eta: float = 1.0,
    light: tuple[np.ndarray, np.ndarray] | None = None,
) -> SlabLight:
    """What layers, the lit one first, do to the light that entered through z = 0.

    light: inside cosines and shares of the light that entered, buried: it scatters along its way, reflected at the
    surfaces as eta says; None: the diffuse source of `boundary` with q = 1. Raises numpy.linalg.LinAlgError where a
    beam decays exactly as a mode does.
    """
    if light is None:
        return _Slab(layers, model, boundary).solve(None, eta)
    parts = [(share, _Slab(layers, model, boundary).solve(float(mu), eta)) for mu, share in zip(*light, strict=True)]
    names = ("reflectance", "transmittance", "absorbed", "unscattered")
    return SlabLight(*(float(sum(share * getattr(part, name) for share, part in parts)) for name in names))


class _Slab:
    """Coefficients of two functions per layer and moment, from continuity and the boundary conditions."""

    def __init__(self, layers: Sequence[Layer], model: ModelOf, boundary: Boundary) -> None:
        self.layers, self.boundary = layers, boundary
        self.systems = [model(layer.medium) for layer in layers]
        self.count = len(boundary.matrix)

    def solve(self, mu: float | None, eta: float) -> SlabLight:
        beams, unscattered = ([[] for _ in self.layers], 0.0) if mu is None else self._beams(mu, eta)
        coefficients = self._coefficients(beams)
        k = self.boundary
        lit = self._field(0, 0.0, coefficients, beams)[0]
        unlit = self._field(-1, self.layers[-1].thickness, coefficients, beams)[0]
        absorbed = sum(self._absorbed(n, coefficients, beams) for n in range(len(self.layers)))
        return SlabLight(
            float(k.matrix[0] @ lit - k.reflected), float(k.matrix[0] @ unlit), float(absorbed), unscattered
        )

    def _beams(self, mu: float, eta: float) -> tuple[list[list[ClosedFormBeam]], float]:
        """Unscattered light down and up in each layer; the share that leaves."""
        depths = np.cumsum([0.0] + [layer.medium.sigma_t * layer.thickness for layer in self.layers]) / mu
        inside = float(reflectance_from_inside(mu, eta))
        once = np.exp(-depths[-1])
        amplitude = 1 / (1 - (inside * once) ** 2)
        beams = []
        for layer, top in zip(self.layers, depths, strict=False):
            rate = layer.medium.sigma_t / mu
            whole = amplitude / mu
            beams.append(
                [ClosedFormBeam(whole, -top, -rate), ClosedFormBeam(whole * inside, top - 2 * depths[-1], rate)]
            )
        return beams, float((1 - inside) * once * (1 + inside * once) * amplitude)

    def _particular(self, index: int, rate: float) -> np.ndarray:
        """(m,) response to unscattered light of unit fluence that changes as e^(rate z)."""
        system, layer = self.systems[index], self.layers[index]
        source = np.zeros(self.count)
        source[0] = layer.medium.sigma_s_prime
        return np.linalg.solve(system.mass - rate**2 * system.stiffness, source)

    def _field(
        self, index: int, z: float, coefficients: np.ndarray, beams: list[list[ClosedFormBeam]]
    ) -> tuple[np.ndarray, np.ndarray]:
        """The moments (m,) and their slope at depth z of a layer."""
        values, slopes = _even_and_odd(self.systems[index], z, self.layers[index].thickness)
        value, slope = values @ coefficients[index], slopes @ coefficients[index]
        for beam in beams[index]:
            part = self._particular(index, beam.rate) * beam.at(z)
            value, slope = value + part, slope + beam.rate * part
        return value, slope

    def _coefficients(self, beams: list[list[ClosedFormBeam]]) -> np.ndarray:
        """(layers, 2 m): the conditions are linear, so their matrix is what unit coefficients do to them."""
        size = 2 * self.count * len(self.layers)
        none: list[list[ClosedFormBeam]] = [[] for _ in self.layers]
        matrix = [self._conditions(unit.reshape(len(self.layers), -1), none) for unit in np.eye(size)]
        right = -self._conditions(np.zeros((len(self.layers), 2 * self.count)), beams)
        right[: self.count] += self.boundary.matrix[:, 0] * self.boundary.source
        return np.linalg.solve(np.column_stack(matrix), right).reshape(len(self.layers), -1)

    def _conditions(self, coefficients: np.ndarray, beams: list[list[ClosedFormBeam]]) -> np.ndarray:
        """What must equal the diffuse source at z = 0, and 0 elsewhere."""
        k = self.boundary.matrix
        value, slope = self._field(0, 0.0, coefficients, beams)
        rows = [k @ value - self.systems[0].stiffness @ slope]
        for index in range(len(self.layers)):
            value, slope = self._field(index, self.layers[index].thickness, coefficients, beams)
            flux = self.systems[index].stiffness @ slope
            if index + 1 == len(self.layers):
                rows.append(k @ value + flux)
            else:
                below, slope = self._field(index + 1, 0.0, coefficients, beams)
                rows += [value - below, flux - self.systems[index + 1].stiffness @ slope]
        return np.concatenate(rows)

    def _absorbed(self, index: int, coefficients: np.ndarray, beams: list[list[ClosedFormBeam]]) -> float:
        layer = self.layers[index]
        # Nodes gather at both ends, where the light changes over a mean free path.
        angle, weights = gauss(_DEPTHS, 0, np.pi)
        depth = layer.thickness * (1 - np.cos(angle)) / 2
        weights = weights * layer.thickness * np.sin(angle) / 2
        total = 0.0
        for z, weight in zip(depth, weights, strict=True):
            fluence = self._field(index, z, coefficients, beams)[0][0]
            fluence += sum(beam.at(z) for beam in beams[index])
            total += weight * layer.medium.sigma_a * fluence
        return total


def _even_and_odd(system: Moments, z: float, thickness: float) -> tuple[np.ndarray, np.ndarray]:
    """Two solutions per mode, even and odd about the middle, (m, 2 m), and slopes; 1 and linear without absorption."""
    rates, vectors = system.modes
    half = thickness / 2
    x, rates = z - half, np.maximum(rates, 1e-6 / half)
    far = np.exp(-2 * rates * abs(x))
    size = np.exp(rates * (abs(x) - half))
    even = size * (1 + far) / (1 + np.exp(-2 * rates * half))
    odd = size * -np.expm1(-2 * rates * abs(x)) / -np.expm1(-2 * rates * half) * np.sign(x)
    even_slope = rates * odd * np.tanh(rates * half)
    odd_slope = rates * even / np.tanh(rates * half)
    return np.hstack([vectors * even, vectors * odd]), np.hstack([vectors * even_slope, vectors * odd_slope])


def half_space_response(
    medium: Medium, wavelengths: np.ndarray, model: ModelOf, boundary: Boundary, buried: bool
) -> np.ndarray:
    """M/q of a half-space under q = cos(2 pi x / wavelength), wavelengths (n,) in mm (inf: uniform).

    buried: normally incident light that scatters along its way; else the diffuse source of `boundary`.
    """
    system, k = model(medium), boundary.matrix
    responses = []
    for wave in 2 * np.pi / np.asarray(wavelengths, np.float64):
        lateral = Moments(system.stiffness, system.mass + wave**2 * system.stiffness)
        rates, vectors = lateral.modes
        particular: np.ndarray = np.zeros(len(k))
        right = k[:, 0] * boundary.source
        if buried:
            source = np.zeros(len(k))
            source[0] = medium.sigma_s_prime
            particular = np.linalg.solve(lateral.mass - medium.sigma_t**2 * system.stiffness, source)
            right = -(k + medium.sigma_t * system.stiffness) @ particular
        surface = vectors @ np.linalg.solve(k @ vectors + system.stiffness @ vectors * rates, right) + particular
        responses.append(k[0] @ surface - boundary.reflected)
    return np.array(responses)
