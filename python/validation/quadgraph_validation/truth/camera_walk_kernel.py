"""What a camera sees of a body in a closed triangle mesh, by walks backwards from its pixels, compiled by Numba.

A walk from a pixel goes the way of light backwards: refracted in, scattered, and out again, where it meets the lights.
Lights have to have some size, since walks meet them by chance: rectangles and uniform surroundings.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from quadgraph_validation.truth.microsurface import at_rough_face
from quadgraph_validation.truth.triangle_tree import ENTERING, LEAVING, first_hit
from quadgraph_validation.truth.walk_kernel import (
    _at,
    _at_face,
    _bent,
    _free,
    _isotropic,
    _lighter,
    fresnel,
    random,
)

_EVENTS = 1_000_000  # after which a walk is given up: trapped in an edge


class WideLights(NamedTuple):
    """Lights that walks meet. Rectangles: centre, along, across, normal (n, 3), half edges in mm, normal of length 1
    and to where they shine; radiance (n,); around (n,): radiance of uniform surroundings, 0 of a rectangle.
    """

    centre: np.ndarray
    along: np.ndarray
    across: np.ndarray
    normal: np.ndarray
    radiance: np.ndarray
    around: np.ndarray


@njit(cache=True)
def _shone(lights, k, x, y, z, dx, dy, dz, reach):
    """Radiance of light k along a way backwards from a point outside, up to `reach`."""
    if lights.around[k] > 0:
        return lights.around[k] if reach == np.inf else 0.0
    n, c = lights.normal[k], lights.centre[k]
    facing = dx * n[0] + dy * n[1] + dz * n[2]
    if facing >= 0:
        return 0.0
    far = ((c[0] - x) * n[0] + (c[1] - y) * n[1] + (c[2] - z) * n[2]) / facing
    if far <= 0 or far >= reach:
        return 0.0
    px, py, pz = x + far * dx - c[0], y + far * dy - c[1], z + far * dz - c[2]
    u, v = lights.along[k], lights.across[k]
    uu, vv = u[0] * u[0] + u[1] * u[1] + u[2] * u[2], v[0] * v[0] + v[1] * v[1] + v[2] * v[2]
    uv = u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
    pu, pv = px * u[0] + py * u[1] + pz * u[2], px * v[0] + py * v[1] + pz * v[2]
    det = uu * vv - uv * uv
    a, b = (pu * vv - pv * uv) / det, (pv * uu - pu * uv) / det
    return lights.radiance[k] if abs(a) <= 1 and abs(b) <= 1 else 0.0


@njit(cache=True, nogil=True)
def seen(tree, near, volume, eta, alpha, lights, eye, ways, samples, seed, total, squares):
    """Add to `total` (n, k) the radiance that pixels see of each light alone, W/(mm^2 sr), scattered light only.

    volume: a WalkVolume, of a majorant above 0; alpha: roughness (GGX) of the surface, 0 for a smooth one; ways
    (n, s, 3): unit ways of the rays of each pixel from the eye (3,);
    samples: walks a ray; squares (n, k): sums of squares of the mean of each ray's walks, for its noise.
    """
    state = np.array([seed], np.uint64)
    count = len(lights.radiance)
    found = np.zeros(count)
    for pixel in range(ways.shape[0]):
        for ray in range(ways.shape[1]):
            way = ways[pixel, ray]
            face, reach = first_hit(tree, eye[0], eye[1], eye[2], way[0], way[1], way[2], np.inf, ENTERING, -1)
            if face < 0:
                continue
            found[:] = 0
            for _ in range(samples):
                _walk(tree, near, volume, eta, alpha, lights, eye, way, face, reach, state, found)
            for k in range(count):
                value = found[k] / samples
                total[pixel, k] += value
                squares[pixel, k] += value * value


@njit(cache=True)
def _entering(normal, way, eta, alpha, state):
    """The way inside of a walk from outside, and its weight; 0 where chance mirrors it at a rough surface."""
    if alpha > 0:
        dx, dy, dz, through = at_rough_face(normal, way[0], way[1], way[2], False, eta, alpha, state)
        return dx, dy, dz, 1.0 if through else 0.0
    nx, ny, nz = normal
    cosine = min(abs(way[0] * nx + way[1] * ny + way[2] * nz), 1.0)
    reflected, beyond = fresnel(cosine, 1 / eta)
    dx, dy, dz = _bent(way[0], way[1], way[2], nx, ny, nz, 1 / eta, cosine / eta - beyond)
    return dx, dy, dz, 1 - reflected


@njit(cache=True)
def _walk(tree, near, volume, eta, alpha, lights, eye, way, face, reach, state, found):
    """One walk that enters where a ray meets the body; adds what it meets of each light to `found`."""
    x, y, z = eye[0] + reach * way[0], eye[1] + reach * way[1], eye[2] + reach * way[2]
    dx, dy, dz, weight = _entering(tree.normal[face], way, eta, alpha, state)
    even, majorant = volume.scattering.size == 1, volume.majorant
    sigma_s, sigma_t = volume.scattering[0, 0, 0], majorant
    inside, scattered, skip = True, False, face
    for _ in range(_EVENTS):
        if weight <= 0:
            return
        flight = -np.log(1 - random(state)) / majorant if inside else np.inf
        side = LEAVING if inside else ENTERING
        face, reach = -1, flight
        if flight == np.inf or flight >= _free(near, x, y, z):
            face, reach = first_hit(tree, x, y, z, dx, dy, dz, flight, side, skip)
        if not inside and scattered:
            for k in range(len(found)):
                found[k] += weight * _shone(lights, k, x, y, z, dx, dy, dz, reach)
        if face < 0 and not inside:
            return
        x, y, z, skip = x + reach * dx, y + reach * dy, z + reach * dz, face
        if face < 0:
            if not even:
                sigma_s = _at(volume.scattering, volume, x, y, z)
                sigma_t = sigma_s + _at(volume.absorption, volume, x, y, z)
                if random(state) * majorant >= sigma_t:
                    continue  # delta tracking goes on as if there were no collision
            weight, scattered = _lighter(weight * sigma_s / sigma_t, state), True
            dx, dy, dz = _isotropic(state)
            continue
        if alpha > 0:
            dx, dy, dz, through = at_rough_face(tree.normal[face], dx, dy, dz, inside, eta, alpha, state)
        else:
            dx, dy, dz, through = _at_face(tree.normal[face], dx, dy, dz, inside, side, eta, state)
        inside = inside != through
