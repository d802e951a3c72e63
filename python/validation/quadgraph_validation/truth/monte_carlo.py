"""Analogue random walks: isotropic or Henyey-Greenstein scattering, exact Fresnel surface; what entered is the unit.

Nothing here but free flights, scattering, absorption and reflection: independent of every equation of the package.
Results are means with standard errors; the seed is explicit, the same seed gives the same numbers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.truth.fresnel import reflectance_from_inside, refracted, transmittance_from_outside

_BATCH = 100_000  # walks at a time: arrays that stay in the cache

# Distance (n,) mm to the surface from (3, n) positions along (3, n) directions.
DistanceOut = Callable[[np.ndarray, np.ndarray], np.ndarray]
# Outward unit normals (3, n) at surface positions (3, n).
NormalAt = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Estimate:
    """Mean and standard error; arrays where several quantities are estimated."""

    mean: np.ndarray
    error: np.ndarray


@dataclass(frozen=True)
class Exits:
    """Where walks ended at the surface: position (n, 3) mm, unit direction outside (n, 3), scatterings before (n,) int.

    absorbed: how many never got there.
    """

    position: np.ndarray
    direction: np.ndarray
    scatterings: np.ndarray
    absorbed: int

    @property
    def scattered(self) -> np.ndarray:
        """(n,) bool, which of them scattered at all."""
        return self.scatterings > 0


def walk(
    position: np.ndarray,
    direction: np.ndarray,
    medium: Medium,
    eta: float,
    distance_out: DistanceOut,
    normal_at: NormalAt,
    generator: np.random.Generator,
    g: float = 0.0,
) -> Exits:
    """Follow every walk from (n, 3) inside until it is absorbed or leaves; g: mean cosine of the scattering angle, with
    which the medium's scattering is not reduced.
    """
    position, direction = (np.array(each.T, order="C") for each in (position, direction))  # (3, n): rows are quick
    scatterings = np.zeros(len(position[0]), np.int64)
    ends: list[np.ndarray] = []
    ways: list[np.ndarray] = []
    orders: list[np.ndarray] = []
    absorbed = 0
    while count := len(scatterings):
        out = distance_out(position, direction)
        flight = generator.exponential(1 / medium.sigma_t, count)
        leaves = flight >= out
        position += np.minimum(flight, out) * direction
        keep = ~leaves & (generator.random(count) < medium.albedo)
        inside, at = np.flatnonzero(keep), np.flatnonzero(leaves)
        absorbed += count - len(inside) - len(at)
        direction[:, inside] = scattered_from(direction.take(inside, axis=1), g, generator)
        scatterings[inside] += 1
        place, way = position.take(at, axis=1), direction.take(at, axis=1)
        normal = normal_at(place)
        cosine = _dot(way, normal)
        stays = generator.random(len(at)) < reflectance_from_inside(np.minimum(cosine, 1), eta)
        direction[:, at[stays]] = (way - 2 * cosine * normal)[:, stays]
        keep[at[stays]] = True
        gone = np.flatnonzero(~stays)
        ends.append(place.take(gone, axis=1))
        ways.append(_outside(way.take(gone, axis=1), normal.take(gone, axis=1), cosine[gone], eta))
        orders.append(scatterings[at[gone]])
        kept = np.flatnonzero(keep)
        position, direction, scatterings = position.take(kept, axis=1), direction.take(kept, axis=1), scatterings[kept]
    position, direction = (np.concatenate(parts, axis=1).T for parts in (ends, ways))
    return Exits(position, direction, np.concatenate(orders), absorbed)


def _outside(direction: np.ndarray, normal: np.ndarray, cosine: np.ndarray, eta: float) -> np.ndarray:
    """Directions (3, n) that leave, refracted at the surface that they meet at `cosine` (n,)."""
    return eta * direction + (refracted(cosine, eta) - eta * cosine) * normal


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Of columns of (3, n), (n,)."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def isotropic(count: int, generator: np.random.Generator) -> np.ndarray:
    """Directions (3, count), uniform over the sphere."""
    found = np.empty((3, count))
    found[2] = generator.uniform(-1, 1, count)
    azimuth = generator.uniform(0, 2 * np.pi, count)
    radius = np.sqrt(1 - found[2] ** 2)
    np.multiply(radius, np.cos(azimuth), out=found[0])
    np.multiply(radius, np.sin(azimuth), out=found[1])
    return found


def scattered_from(direction: np.ndarray, g: float, generator: np.random.Generator) -> np.ndarray:
    """Directions (3, n) after one scattering from those [Henyey 1941]; g in (-1, 1)."""
    turned = isotropic(direction.shape[1], generator)
    if g == 0:
        return turned
    # A uniform number, which turned[2] is but for its range, gives the cosine; the azimuth is that of turned.
    cosine = (1 + g**2 - ((1 - g**2) / (1 + g * turned[2])) ** 2) / (2 * g)
    sine = np.sqrt(np.maximum(1 - cosine**2, 0))
    across = turned[:2] / np.maximum(np.hypot(*turned[:2]), 1e-300)
    x, y, z = direction
    side = np.where(z < 0, -1.0, 1.0)  # two unit vectors across [Duff 2017]
    c = -1 / (side + z)
    a = np.stack([1 + side * x * x * c, side * x * y * c, -side * x])
    b = np.stack([x * y * c, side + y * y * c, -y])
    found = cosine * direction + sine * (across[0] * a + across[1] * b)
    return found / np.sqrt(_dot(found, found))


def slab(medium: Medium, thickness: float, eta: float, lambertian: bool, walks: int, seed: int) -> Estimate:
    """Scattered reflectance, scattered transmittance, absorbed and unscattered share, (4,), of a slab `thickness` mm.

    Light enters at z = 0, at normal incidence or diffuse from outside.
    """
    generator = np.random.default_rng(seed)
    counts = np.zeros(4)
    for size in _batches(walks):
        cosine = _diffuse_entry(size, eta, generator) if lambertian else np.ones(size)
        direction = np.column_stack([np.sqrt(1 - cosine**2), np.zeros(size), cosine])
        exits = walk(np.zeros((size, 3)), direction, medium, eta, _planes(thickness), _plane_normals, generator)
        below = exits.position[:, 2] > thickness / 2
        scattered = exits.scattered
        counts += [(scattered & ~below).sum(), (scattered & below).sum(), exits.absorbed, (~scattered).sum()]
    return _shares(counts, walks)


def after_many(medium: Medium, thickness: float, eta: float, most: int, walks: int, seed: int) -> Estimate:
    """Scattered reflectance and transmittance of a slab `thickness` mm, inf for a half-space, and of either the share
    of all light that entered which scattered more than `most` times, (4,): R, T, late R, late T.

    Light enters at z = 0, at normal incidence.
    """
    generator = np.random.default_rng(seed)
    counts = np.zeros(4)
    for size in _batches(walks):
        direction = np.tile([0.0, 0.0, 1.0], (size, 1))
        exits = walk(np.zeros((size, 3)), direction, medium, eta, _planes(thickness), _plane_normals, generator)
        below, late = exits.position[:, 2] > thickness / 2, exits.scatterings > most
        chosen = (exits.scattered & ~below, exits.scattered & below, late & ~below, late & below)
        counts += [which.sum() for which in chosen]
    return _shares(counts, walks)


def half_space(medium: Medium, eta: float, wavelengths: np.ndarray, walks: int, seed: int) -> Estimate:
    """Response M/q, per wavelength in mm, to collimated normal light q = cos(2 pi x / wavelength) on a half-space.

    One run serves all wavelengths: light entering at x = 0 and leaving at x weighs cos(2 pi x / wavelength).
    """
    generator = np.random.default_rng(seed)
    number = 2 * np.pi / np.asarray(wavelengths, np.float64)
    total, squares = np.zeros(len(number)), np.zeros(len(number))
    for size in _batches(walks):
        direction = np.tile([0.0, 0.0, 1.0], (size, 1))
        exits = walk(np.zeros((size, 3)), direction, medium, eta, _planes(np.inf), _plane_normals, generator)
        score = np.cos(exits.position[:, :1] * number)
        total += score.sum(axis=0)
        squares += (score**2).sum(axis=0)
    mean = total / walks
    return Estimate(mean, np.sqrt((squares / walks - mean**2) / (walks - 1)))


def sphere(medium: Medium, radius: float, eta: float, bins: int, walks: int, seed: int) -> Estimate:
    """Scattered exitance, W/mm^2, of a sphere in parallel light of 1 W/mm^2 travelling along -z.

    (bins,) mean over zones of equal cos(theta) from -1 to 1, theta from +z, which the light comes from. `walks` counts
    the light that entered.
    """
    generator = np.random.default_rng(seed)
    counts = np.zeros(bins)
    edges = np.linspace(-1, 1, bins + 1)
    for size in _batches(walks):
        exits = through_sphere(medium, radius, eta, size, generator)
        counts += np.histogram(exits.position[exits.scattered, 2] / radius, edges)[0]
    shares = _shares(counts, walks)
    scale = entering_sphere(radius, eta) / (4 * np.pi * radius**2 / bins)
    return Estimate(shares.mean * scale, shares.error * scale)


def through_sphere(
    medium: Medium, radius: float, eta: float, walks: int, generator: np.random.Generator, g: float = 0.0
) -> Exits:
    """Walks of parallel light along -z that entered a sphere about the origin, all of it where y = 0 and x >= 0."""
    outside = _directional_entry(walks, eta, generator)
    inside = refracted(outside, 1 / eta)
    sine = np.sqrt(1 - outside**2)
    normal = np.column_stack([sine, np.zeros(walks), outside])
    travelling = np.array([0.0, 0.0, -1.0]) / eta + (outside / eta - inside)[:, None] * normal
    geometry = _sphere_out(radius), lambda at: at / np.sqrt(_dot(at, at))
    return walk(radius * normal, travelling, medium, eta, *geometry, generator, g)


def entering_sphere(radius: float, eta: float) -> float:
    """W that enter a sphere in parallel light of 1 W/mm^2."""
    cosine = np.linspace(0, 1, 20001)
    return float(np.pi * radius**2 * np.trapezoid(2 * cosine * transmittance_from_outside(cosine, eta), cosine))


def _batches(walks: int) -> list[int]:
    whole, rest = divmod(walks, _BATCH)
    return [_BATCH] * whole + ([rest] if rest else [])


def _shares(counts: np.ndarray, walks: int) -> Estimate:
    mean = counts / walks
    return Estimate(mean, np.sqrt(mean * (1 - mean) / walks))


def _planes(thickness: float) -> DistanceOut:
    def distance(position: np.ndarray, direction: np.ndarray) -> np.ndarray:
        z, cosine = position[2], direction[2]
        with np.errstate(divide="ignore", invalid="ignore"):
            return (np.where(cosine > 0, thickness, 0.0) - z) / cosine

    return distance


def _plane_normals(position: np.ndarray) -> np.ndarray:
    # Rounding leaves an exit within an ulp of its plane; of the two planes the lit one is at 0.
    normal = np.zeros_like(position)
    normal[2] = np.where(position[2] < 1e-9, -1.0, 1.0)
    return normal


def _sphere_out(radius: float) -> DistanceOut:
    def distance(position: np.ndarray, direction: np.ndarray) -> np.ndarray:
        along = _dot(position, direction)
        return np.sqrt(np.maximum(along**2 + (radius**2 - _dot(position, position)), 0)) - along

    return distance


def _diffuse_entry(count: int, eta: float, generator: np.random.Generator) -> np.ndarray:
    """Inside cosines (count,) of Lambertian light from outside, those that enter."""
    return refracted(_directional_entry(count, eta, generator), 1 / eta)


def _directional_entry(count: int, eta: float, generator: np.random.Generator) -> np.ndarray:
    """Outside cosines with density c T(c): of Lambertian light on a plane, and of parallel light on a sphere."""
    found = np.empty(0)
    while len(found) < count:
        cosine = np.sqrt(generator.random(count))
        enters = generator.random(count) < transmittance_from_outside(cosine, eta)
        found = np.concatenate([found, cosine[enters]])
    return found[:count]
