"""Light at a rough surface: the random walk over the facets of a Smith surface of GGX slopes [Heitz 2016], by Numba.

All that a facet mirrors or refracts is followed until it is clear of the surface, on either side: nothing is lost.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from quadgraph_validation.truth.walk_kernel import _bent, fresnel, random

_UPRIGHT, _LEVEL = 0.9999, 1e-4  # cosines at which Smith's Lambda has a limit
_MEETINGS = 1000  # with facets, after which the last one decides


@njit(cache=True)
def _lambda(z, alpha):
    """Of a way up (z > 0), at least 0, or down, at most -1."""
    slope = z / (np.sqrt(1 - z * z) * alpha)
    root = np.sqrt(1 + 1 / (slope * slope))
    return 0.5 * (root - 1) if z > 0 else -0.5 * (root + 1)


@njit(cache=True)
def _height(below, z, alpha, state):
    """The share of facets that lie below the next one which a way meets, from one of share `below`; 2: it is clear."""
    u = random(state)
    if z > _UPRIGHT:
        return 2.0
    if z < -_UPRIGHT:
        return u * below
    if abs(z) < _LEVEL:
        return below
    lean = _lambda(z, alpha)
    if z > 0 and u > 1 - below**lean:
        return 2.0
    return min(below / (1 - u) ** (1 / lean), 1.0)


@njit(cache=True)
def _facet(x, y, z, alpha, state):
    """Normal of a facet that is seen along (x, y, z), away from it [Dupuy and Benyoub 2023]."""
    sx, sy = alpha * x, alpha * y
    length = np.sqrt(sx * sx + sy * sy + z * z)
    sx, sy, sz = sx / length, sy / length, z / length
    turn, up = 2 * np.pi * random(state), (1 - random(state)) * (1 + sz) - sz
    radius = np.sqrt(max(1 - up * up, 0.0))
    hx, hy, hz = alpha * (radius * np.cos(turn) + sx), alpha * (radius * np.sin(turn) + sy), max(up + sz, 1e-12)
    length = np.sqrt(hx * hx + hy * hy + hz * hz)
    return hx / length, hy / length, hz / length


@njit(cache=True)
def _over_facets(x, y, z, inside, eta, alpha, state):
    """The way on in the frame whose third axis points out of the body, and whether that is inside."""
    below = 1 - 1e-9
    for _ in range(_MEETINGS):
        side = -1.0 if inside else 1.0
        below = _height(below, side * z, alpha, state)
        if below > 1:
            break
        # In the frame of the side where the light is, with the way turned around.
        mx, my, mz = _facet(-side * x, -side * y, -side * z, alpha, state)
        mx, my, mz = side * mx, side * my, side * mz
        cosine = min(-(x * mx + y * my + z * mz), 1.0)
        ratio = eta if inside else 1 / eta
        reflected, beyond = fresnel(cosine, ratio)
        if random(state) < reflected:
            x, y, z = _bent(x, y, z, mx, my, mz, 1.0, 2 * cosine)
            continue
        x, y, z = _bent(x, y, z, mx, my, mz, ratio, ratio * cosine - beyond)
        inside, below = not inside, 1 - below
    return x, y, z, inside


@njit(cache=True)
def at_rough_face(normal, dx, dy, dz, inside, eta, alpha, state):
    """The way on of a walk that meets a face of roughness `alpha` > 0, by chance, and whether it goes through."""
    nx, ny, nz = normal
    if abs(nx) < 0.5:
        ax, ay, az = 0.0, nz, -ny
    else:
        ax, ay, az = -nz, 0.0, nx
    length = np.sqrt(ax * ax + ay * ay + az * az)
    ax, ay, az = ax / length, ay / length, az / length
    bx, by, bz = ny * az - nz * ay, nz * ax - nx * az, nx * ay - ny * ax
    x, y = dx * ax + dy * ay + dz * az, dx * bx + dy * by + dz * bz
    z = dx * nx + dy * ny + dz * nz
    x, y, z, ended = _over_facets(x, y, z, inside, eta, alpha, state)
    dx, dy, dz = x * ax + y * bx + z * nx, x * ay + y * by + z * ny, x * az + y * bz + z * nz
    length = np.sqrt(dx * dx + dy * dy + dz * dz)
    return dx / length, dy / length, dz / length, ended != inside
