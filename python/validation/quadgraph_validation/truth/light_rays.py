"""Light on its way to a body, drawn from the definitions of docs/lights.md and nothing else."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from quadgraph.api.lights import AmbientLight, DirectionalLight, Light, PointLight, RectangleLight, SpotLight
from quadgraph.base.errors import InputError
from quadgraph_validation.bodies.smooth_sky import SmoothSky

_ROOM = 1.000001  # spheres around bodies are a little larger


@dataclass(frozen=True, eq=False)
class LightRays:
    """Rays of equal power from outside a sphere around a body: origins (n, 3) mm, unit ways (n, 3).

    power: W of all that could meet the body, spread over `drawn` rays; those that surely miss are left out.
    """

    origins: np.ndarray
    ways: np.ndarray
    power: float
    drawn: int


def rays(
    light: Light | SmoothSky, middle: np.ndarray, radius: float, count: int, generator: np.random.Generator
) -> LightRays:
    """Draw `count` rays of a grey light towards a sphere around a body. Raises InputError for kinds it has none of."""
    radius *= _ROOM
    if isinstance(light, DirectionalLight):
        way = _unit(light.direction)
        ways = np.broadcast_to(way, (count, 3))
        power = _grey(light.irradiance) * np.pi * radius**2
        return LightRays(_disc(ways, middle, radius, generator), ways, power, count)
    if isinstance(light, AmbientLight):
        ways = _cone(np.array([0.0, 0.0, 1.0]), -1.0, count, generator)
        power = 4 * np.pi * radius**2 * _grey(light.irradiance)
        return LightRays(_disc(ways, middle, radius, generator), ways, power, count)
    if isinstance(light, SmoothSky):
        return _sky(light, middle, radius, count, generator)
    if isinstance(light, PointLight):
        return _point(light, middle, radius, count, generator)
    if isinstance(light, SpotLight):
        return _spot(light, middle, radius, count, generator)
    if isinstance(light, RectangleLight):
        return _rectangle(light, middle, radius, count, generator)
    raise InputError(f"light: {type(light).__name__} found, random walks start from {_KINDS}")


_KINDS = "directional, ambient, point, spot and rectangle lights, and smooth skies"


def _point(
    light: PointLight, middle: np.ndarray, radius: float, count: int, generator: np.random.Generator
) -> LightRays:
    place = np.array(light.position)
    distance = float(np.linalg.norm(middle - place))
    least = np.sqrt(1 - (radius / distance) ** 2) if distance > radius else -1.0
    ways = _cone(_unit(middle - place), least, count, generator)
    return LightRays(np.broadcast_to(place, ways.shape), ways, _grey(light.power) * (1 - least) / 2, count)


def _spot(light: SpotLight, middle: np.ndarray, radius: float, count: int, generator: np.random.Generator) -> LightRays:
    """Directions even in the cone, kept as often as they are bright."""
    edge = 0.2 if light.edge is None else light.edge
    outer, inner = np.cos(np.radians([light.angle, light.angle * (1 - edge)]))
    axis = _unit(light.direction)
    ways = _cone(axis, outer, count, generator)
    fade = np.clip((ways @ axis - outer) / max(inner - outer, 1e-12), 0, 1)
    ways = ways[generator.random(count) < fade**2 * (3 - 2 * fade)]
    on_axis = _grey(light.power) / (np.pi * (2 - inner - outer))
    power = on_axis * 2 * np.pi * (1 - outer)
    return _meeting(np.broadcast_to(np.array(light.position), ways.shape), ways, middle, radius, power, count)


def _rectangle(
    light: RectangleLight, middle: np.ndarray, radius: float, count: int, generator: np.random.Generator
) -> LightRays:
    """Even over the rectangle and over the cone in which the sphere is seen, kept by the cosine times that cone."""
    u, v = np.array(light.u), np.array(light.v)
    place = np.array(light.centre) + (generator.random((count, 2)) - 0.5) @ np.stack([u, v])
    to_middle = middle - place
    distance = np.linalg.norm(to_middle, axis=1)
    least = np.where(distance > radius, np.sqrt(np.clip(1 - (radius / distance) ** 2, 0, None)), -1)
    ways = _around(to_middle / distance[:, None], least, generator)
    kept = np.clip(ways @ _unit(np.cross(u, v)), 0, None) * (1 - least) / (1 - least).max()
    chosen = generator.random(count) < kept
    power = _grey(light.power) * 2 * (1 - least).max()
    return LightRays(place[chosen], ways[chosen], power, count)


def _sky(sky: SmoothSky, middle: np.ndarray, radius: float, count: int, generator: np.random.Generator) -> LightRays:
    """Texels as often as they are bright and large, directions even over each."""
    rows, columns = sky.radiance.shape
    edges = np.cos(np.pi * np.arange(rows + 1) / rows)
    power = (sky.radiance * ((edges[:-1] - edges[1:]) * 2 * np.pi / columns)[:, None]).ravel()
    row, column = np.divmod(generator.choice(len(power), count, p=power / power.sum()), columns)
    height = generator.uniform(edges[row + 1], edges[row])
    longitude = 2 * np.pi * (column + generator.random(count)) / columns - np.pi
    flat = np.sqrt(1 - height**2)
    ways = -np.stack([flat * np.sin(longitude), height, -flat * np.cos(longitude)], axis=-1)
    return LightRays(_disc(ways, middle, radius, generator), ways, float(power.sum()) * np.pi * radius**2, count)


def _meeting(
    origins: np.ndarray, ways: np.ndarray, middle: np.ndarray, radius: float, power: float, count: int
) -> LightRays:
    """Those rays that meet the sphere."""
    to_middle = middle - origins
    along = np.einsum("ij,ij->i", to_middle, ways)
    missed = np.einsum("ij,ij->i", to_middle, to_middle) - along**2
    meets = (missed < radius**2) & ((along > 0) | (np.linalg.norm(to_middle, axis=1) < radius))
    return LightRays(origins[meets], ways[meets], power, count)


def _disc(ways: np.ndarray, middle: np.ndarray, radius: float, generator: np.random.Generator) -> np.ndarray:
    """Origins even over discs that face the ways, beside the sphere."""
    x, y = _frames(ways)
    far, turn = radius * np.sqrt(generator.random(len(ways))), generator.uniform(0, 2 * np.pi, len(ways))
    return middle - radius * ways + (far * np.cos(turn))[:, None] * x + (far * np.sin(turn))[:, None] * y


def _cone(axis: np.ndarray, least: float, count: int, generator: np.random.Generator) -> np.ndarray:
    """Directions (count, 3) even over those whose cosine to the axis is at least `least`."""
    return _around(np.broadcast_to(axis, (count, 3)), np.full(count, least), generator)


def _around(axes: np.ndarray, least: np.ndarray, generator: np.random.Generator) -> np.ndarray:
    """A direction for each axis (n, 3), even over those whose cosine to it is at least `least` (n,)."""
    cosine, turn = generator.uniform(least, 1), generator.uniform(0, 2 * np.pi, len(axes))
    sine = np.sqrt(1 - cosine**2)
    x, y = _frames(axes)
    return (sine * np.cos(turn))[:, None] * x + (sine * np.sin(turn))[:, None] * y + cosine[:, None] * axes


def _frames(ways: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors (n, 3) across each way and each other."""
    helper = np.eye(3)[np.abs(ways).argmin(axis=1)]
    x = np.cross(helper, ways)
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    return x, np.cross(ways, x)


def _unit(vector: Any) -> np.ndarray:
    vector = np.asarray(vector, np.float64)
    return vector / np.linalg.norm(vector)


def _grey(value: Any) -> float:
    return float(np.ravel(value)[0])
