"""What a light with a place or a direction lets into each face of a body: points of face and light, every ray cast."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from quadgraph.api.lights import DirectionalLight, Light, PointLight, RectangleLight, SpotLight
from quadgraph.base.errors import InputError
from quadgraph.mesh.surface import Surface
from quadgraph_validation.bodies.smooth_sky import SmoothSky
from quadgraph_validation.truth.fresnel import transmittance_from_outside
from quadgraph_validation.truth.irradiance import Occluder

_FACES_AT_ONCE = 2000
# Multiples of these fill the four-dimensional cube evenly: powers of the root of x^5 = x + 1 (Roberts 2018).
_STEP = 1.1673039782614187 ** -np.arange(1.0, 5.0)
_EDGE = 0.2  # of a spot that does not say


def entering(surface: Surface, light: Light | SmoothSky, eta: float, points: int, seed: int) -> np.ndarray:
    """q (m,) W/mm^2 that a grey light outside the body's bounds lets into each triangle, the mean over so many points.

    Raises InputError for ambient light, skies and projectors.
    """
    occluder, generator = Occluder(surface), np.random.default_rng(seed)
    parts = []
    for begin in range(0, len(surface.triangles), _FACES_AT_ONCE):
        corners = surface.corners[begin : begin + _FACES_AT_ONCE]
        places = (generator.random((len(corners), 1, 4)) + np.arange(points)[:, None] * _STEP) % 1
        parts.append(_means(occluder, corners, light, eta, places))
    return np.concatenate(parts)


def _means(
    occluder: Occluder, corners: np.ndarray, light: Light | SmoothSky, eta: float, places: np.ndarray
) -> np.ndarray:
    """Over triangles (n, 3, 3); places (n, p, 4) in [0, 1): where on the triangle, and where on the light."""
    count, points = places.shape[:2]
    u, v = places[..., 0], places[..., 1]
    folded = u + v > 1
    u, v = np.where(folded, 1 - u, u), np.where(folded, 1 - v, v)
    at = np.einsum("npk,nkd->npd", np.stack([1 - u - v, u, v], axis=-1), corners).reshape(-1, 3)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal = np.repeat(normal / np.linalg.norm(normal, axis=1)[:, None], points, axis=0)
    way, facing = _arriving(light, at, places[..., 2:].reshape(-1, 2))
    cosine = np.clip(np.einsum("ij,ij->i", way, normal), 0, 1)
    lit = np.flatnonzero(cosine * facing > 0)
    share = np.zeros(len(at))
    share[lit] = cosine[lit] * transmittance_from_outside(cosine[lit], eta) * facing[lit]
    share[lit] *= occluder.passes(at[lit], normal[lit], way[lit])
    return share.reshape(count, points).mean(axis=1)


def _arriving(light: Light | SmoothSky, at: np.ndarray, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Unit ways (n, 3) from points (n, 3) to the light, and W/mm^2 on planes that face it."""
    if isinstance(light, DirectionalLight):
        way = -np.array(light.direction) / np.linalg.norm(light.direction)
        return np.broadcast_to(way, at.shape), np.full(len(at), float(np.max(light.irradiance)))
    source, intensity = _source(light, place)
    way = source - at
    distance = np.linalg.norm(way, axis=1)
    way /= distance[:, None]
    return way, intensity(-way) / distance**2


def _source(light: Light | SmoothSky, place: np.ndarray) -> tuple[np.ndarray, Callable[[np.ndarray], np.ndarray]]:
    """Where the light is (n, 3), mm, and W/sr by the unit way (n, 3) that it travels."""
    power = float(np.max(getattr(light, "power", 0.0)))
    if isinstance(light, PointLight):
        return np.array(light.position), lambda ways: np.full(len(ways), power / (4 * np.pi))
    if isinstance(light, SpotLight):
        return np.array(light.position), lambda ways: _spot(light, power, ways)
    if isinstance(light, RectangleLight):
        u, v = np.array(light.u), np.array(light.v)
        axis = np.cross(u, v) / np.linalg.norm(np.cross(u, v))
        return np.array(light.centre) + (place - 0.5) @ np.stack([u, v]), lambda ways: power / np.pi * (ways @ axis)
    raise InputError(f"light: {type(light).__name__} found, wanted is a directional, point, spot or rectangle light")


def _spot(light: SpotLight, power: float, ways: np.ndarray) -> np.ndarray:
    edge = _EDGE if light.edge is None else light.edge
    outer, inner = np.cos(np.radians([light.angle, light.angle * (1 - edge)]))
    axis = np.array(light.direction) / np.linalg.norm(light.direction)
    fade = np.clip((ways @ axis - outer) / max(inner - outer, 1e-12), 0, 1)
    return power / (np.pi * (2 - inner - outer)) * fade**2 * (3 - 2 * fade)
