"""What fills and lights the random bodies: drawn from a seed within stated ranges, in one grey channel."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import ndimage

from quadgraph.api.lights import DirectionalLight, Light, PointLight, RectangleLight, SpotLight
from quadgraph.mesh.surface import Surface
from quadgraph_validation.bodies.smooth_sky import SmoothSky, drawn_sky

MEAN_FREE_PATHS = (2.0, 40.0)  # across the longest side
ETA = (1.0, 1.5)
EVEN = 0.5  # share of bodies with the same material everywhere
_MATCHED = 0.2  # share of bodies of index 1
_DARK = 0.25  # share of albedos between the least and _PALE; the others are spread by the logarithm of what is absorbed
_LEAST, _PALE, _MOST = 0.02, 0.7, 0.9999
_CELLS = 56  # of a volume along the longest side
BEAMS = ("directional", "point", "rectangle", "spot")


@dataclass(frozen=True, eq=False)
class UnseenMedium:
    """Coefficients (nz, ny, nx), 1/mm, float32, at points `first` + index * `spacing`, mm, linear between; one cell is
    the same everywhere. kind: in a word.
    """

    kind: str
    eta: float
    sigma_s_prime: np.ndarray
    sigma_a: np.ndarray
    first: tuple[float, float, float] = (0.0, 0.0, 0.0)
    spacing: float = 1.0

    @property
    def even(self) -> bool:
        """Whether it is the same everywhere."""
        return self.sigma_a.size == 1


@dataclass(frozen=True, eq=False)
class UnseenCase:
    """A body, what is in it, and its one light. size: mean free paths across the longest side, and albedo: of the first
    material where there are two; inter_reflection: whether light that left may enter again.
    """

    seed: int
    surface: Surface
    medium: UnseenMedium
    light: Light | SmoothSky
    size: float
    albedo: float
    inter_reflection: bool = True


def drawn(
    seed: int, surface: Surface, lights: str = "beams", mean_free_paths: tuple[float, float] = MEAN_FREE_PATHS
) -> UnseenCase:
    """What belongs to a seed's body; lights: beams or sky; mean_free_paths: least and most, across the longest side."""
    generator = np.random.default_rng([seed, 1])
    size = float(np.exp(generator.uniform(*np.log(mean_free_paths))))
    albedo = _albedo(generator)
    total = size / float(np.ptp(surface.vertices, axis=0).max())
    eta = 1.0 if generator.random() < _MATCHED else round(float(generator.uniform(*ETA)), 3)
    if generator.random() < EVEN:
        scattering, absorption = (
            np.full((1, 1, 1), value, np.float32) for value in (total * albedo, total * (1 - albedo))
        )
        medium = UnseenMedium("even", eta, scattering, absorption)
    else:
        medium = _mixed(generator, surface, total, albedo, eta)
    light = (
        _beam(np.random.default_rng([seed, 2]), surface)
        if lights == "beams"
        else drawn_sky(np.random.default_rng([seed, 3]))
    )
    return UnseenCase(seed, surface, medium, light, size, albedo)


def _albedo(generator: np.random.Generator) -> float:
    if generator.random() < _DARK:
        return float(generator.uniform(_LEAST, _PALE))
    return 1 - float(np.exp(generator.uniform(np.log(1 - _MOST), np.log(1 - _PALE))))


def _mixed(generator: np.random.Generator, surface: Surface, total: float, albedo: float, eta: float) -> UnseenMedium:
    """Two materials, in smooth veins or in a sharp checker, on a grid around the body."""
    low, extent = surface.vertices.min(axis=0), np.ptp(surface.vertices, axis=0)
    spacing = float(np.float32(extent.max() / (_CELLS - 1)))
    counts = np.maximum(np.ceil(extent / spacing).astype(int) + 1, 2)
    kind = "veins" if generator.random() < 0.5 else "checker"
    share = (_veins if kind == "veins" else _checker)(generator, counts[::-1])
    other = total * float(np.exp(generator.uniform(np.log(0.4), np.log(2.5))))
    pale = _albedo(generator)
    scattering, absorption = (
        (first * (1 - share) + second * share).astype(np.float32)
        for first, second in ((total * albedo, other * pale), (total * (1 - albedo), other * (1 - pale)))
    )
    x, y, z = (float(value) for value in low.astype(np.float32))
    return UnseenMedium(kind, eta, scattering, absorption, (x, y, z), spacing)


def _veins(generator: np.random.Generator, shape: np.ndarray) -> np.ndarray:
    """Share of the second material, smooth: where noise of one scale is near 0."""
    noise = ndimage.gaussian_filter(generator.normal(size=shape), generator.uniform(3, 8), mode="wrap")
    return np.exp(-((noise / noise.std() / generator.uniform(0.4, 1.0)) ** 2))


def _checker(generator: np.random.Generator, shape: np.ndarray) -> np.ndarray:
    side = int(generator.integers(6, 15))
    x, y, z = np.indices(tuple(shape)) // side
    return ((x + y + z) % 2).astype(float)


def _beam(generator: np.random.Generator, surface: Surface) -> Light:
    """One light that brings about 1 W/mm^2 to the body's middle."""
    low, high = surface.vertices.min(axis=0), surface.vertices.max(axis=0)
    middle, radius = (low + high) / 2, float(np.linalg.norm(high - low)) / 2
    kind = BEAMS[generator.integers(len(BEAMS))]
    towards = generator.normal(size=3)
    towards /= np.linalg.norm(towards)
    distance = radius * generator.uniform(1.3, 3.0)
    place = _plain(middle - distance * towards)
    if kind == "directional":
        return DirectionalLight(_plain(towards), 1.0)
    if kind == "point":
        return PointLight(place, _number(4 * np.pi * distance**2))
    if kind == "spot":
        aim = middle + radius * generator.uniform(-0.3, 0.3, 3) - np.array(place)
        angle = _number(generator.uniform(10, 40))
        power = distance**2 * np.pi * (2 - np.cos(np.radians(0.8 * angle)) - np.cos(np.radians(angle)))
        return SpotLight(place, _plain(aim), angle, _number(power), 0.2)
    return _rectangle(generator, np.array(place), towards, radius)


def _rectangle(generator: np.random.Generator, place: np.ndarray, towards: np.ndarray, radius: float) -> Light:
    """A rectangle that faces the middle and is clear of the body."""
    across = np.cross(towards, generator.normal(size=3))
    across /= np.linalg.norm(across)
    other = np.cross(towards, across)
    sides = radius * generator.uniform(0.3, 1.2, 2)
    distance = radius * generator.uniform(0.2, 1.0)
    centre = place - distance * towards
    power = np.pi * (np.linalg.norm(place - centre) + radius * 2) ** 2
    return RectangleLight(_plain(centre), _plain(sides[0] * across), _plain(sides[1] * other), _number(power))


def _number(value: Any) -> float:
    """Short enough to be the same in a text."""
    return float(f"{value:.6g}")


def _plain(vector: np.ndarray) -> tuple[float, float, float]:
    x, y, z = (_number(value) for value in vector)
    return x, y, z
