"""Random walks in a closed triangle mesh, compiled by Numba: one loop that follows light until it is gone.

Nothing here but rays, free flights, isotropic scattering, and exact Fresnel reflection at flat faces. What is absorbed
is taken from a walk's weight, and light walks end by Russian roulette; flights in a volume are by delta tracking.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from quadgraph_validation.truth.triangle_tree import ENTERING, LEAVING, TriangleTree, distance_to, first_hit

_LIGHT, _KEPT = 0.05, 0.2  # a walk lighter than the first survives as one of the second, or ends
_EVENTS = 1_000_000  # after which a walk is lost: trapped in an edge, or next to nothing is absorbed


class Clearance(NamedTuple):
    """Distances (nx, ny, nz) of the middles of cubic cells from the surface: most flights need no ray.

    low: corner of the grid; cell: side.
    """

    distance: np.ndarray
    low: np.ndarray
    cell: float


class WalkVolume(NamedTuple):
    """Coefficients (nz, ny, nx), 1/mm, at points `first` + index * `spacing` (x, y, z), linear between, nearest beside.

    majorant: at least the largest sigma_t. One cell is the same everywhere.
    """

    scattering: np.ndarray
    absorption: np.ndarray
    first: np.ndarray
    spacing: np.ndarray
    majorant: float


class WalkTally(NamedTuple):
    """By patch (n,): entered, weight of light that came in for the first time; scattered, what left after it had
    scattered; again, of that, what left without having scattered since it entered again; unscattered, what left so.

    rest (4,): weight absorbed; gone for good after it was inside; number of walks that met the body; number lost.
    """

    entered: np.ndarray
    scattered: np.ndarray
    again: np.ndarray
    unscattered: np.ndarray
    rest: np.ndarray


@njit(cache=True)
def clearance(tree: TriangleTree, low, cell, nx, ny, nz):
    """Measure the middles of all cells."""
    found = np.empty((nx, ny, nz))
    for i in range(nx):
        for j in range(ny):
            most = 1e300
            for k in range(nz):
                x, y, z = low[0] + (i + 0.5) * cell, low[1] + (j + 0.5) * cell, low[2] + (k + 0.5) * cell
                most = distance_to(tree, x, y, z, most + cell)  # no further than the one before and the way to it
                found[i, j, k] = most
    return found


@njit(cache=True)
def _free(near, x, y, z):
    """How far there is no surface around a point, at least."""
    i, j, k = (x - near.low[0]) / near.cell, (y - near.low[1]) / near.cell, (z - near.low[2]) / near.cell
    nx, ny, nz = near.distance.shape
    a, b, c = min(max(int(i), 0), nx - 1), min(max(int(j), 0), ny - 1), min(max(int(k), 0), nz - 1)
    i, j, k = i - a - 0.5, j - b - 0.5, k - c - 0.5
    return near.distance[a, b, c] - near.cell * np.sqrt(i * i + j * j + k * k)


@njit(cache=True)
def random(state):
    """The next number in [0, 1) of SplitMix64 [Steele et al. 2014]; state: (1,) uint64."""
    state[0] += np.uint64(0x9E3779B97F4A7C15)
    z = state[0]
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    z = z ^ (z >> np.uint64(31))
    return (z >> np.uint64(11)) * (1.0 / 9007199254740992.0)


@njit(cache=True)
def fresnel(cosine, ratio):
    """Reflectance of unpolarised light, and its cosine beyond; ratio: index on its side over the index beyond."""
    squared = 1 - ratio * ratio * (1 - cosine * cosine)
    if squared <= 0:
        return 1.0, 0.0
    beyond = np.sqrt(squared)
    s = (ratio * cosine - beyond) / (ratio * cosine + beyond)
    p = (cosine - ratio * beyond) / (cosine + ratio * beyond)
    return 0.5 * (s * s + p * p), beyond


@njit(cache=True)
def _at(values, volume, x, y, z):
    """A coefficient at a point."""
    nz, ny, nx = values.shape
    u = min(max((x - volume.first[0]) / volume.spacing[0], 0.0), nx - 1.0)
    v = min(max((y - volume.first[1]) / volume.spacing[1], 0.0), ny - 1.0)
    w = min(max((z - volume.first[2]) / volume.spacing[2], 0.0), nz - 1.0)
    i, j, k = min(int(u), nx - 2), min(int(v), ny - 2), min(int(w), nz - 2)
    u, v, w = u - i, v - j, w - k
    low = (values[k, j, i] * (1 - u) + values[k, j, i + 1] * u) * (1 - v)
    low += (values[k, j + 1, i] * (1 - u) + values[k, j + 1, i + 1] * u) * v
    high = (values[k + 1, j, i] * (1 - u) + values[k + 1, j, i + 1] * u) * (1 - v)
    high += (values[k + 1, j + 1, i] * (1 - u) + values[k + 1, j + 1, i + 1] * u) * v
    return low * (1 - w) + high * w


@njit(cache=True)
def _collision(volume, x, y, z, state):
    """Albedo of a collision at a point, -1 where delta tracking goes on as if there were none."""
    if volume.scattering.size == 1:
        return volume.scattering[0, 0, 0] / volume.majorant
    scattering = _at(volume.scattering, volume, x, y, z)
    total = scattering + _at(volume.absorption, volume, x, y, z)
    return scattering / total if random(state) * volume.majorant < total else -1.0


@njit(cache=True)
def _lighter(weight, state):
    """A weight, or that of a walk of Russian roulette: 0 if it ended."""
    if weight >= _LIGHT:
        return weight
    return _KEPT if random(state) * _KEPT < weight else 0.0


@njit(cache=True)
def _isotropic(state):
    dz = 2 * random(state) - 1
    radius, turn = np.sqrt(1 - dz * dz), 2 * np.pi * random(state)
    return radius * np.cos(turn), radius * np.sin(turn), dz


@njit(cache=True)
def _bent(dx, dy, dz, nx, ny, nz, along, turn):
    """A way times `along`, and `turn` times a normal, as a unit vector."""
    dx, dy, dz = along * dx + turn * nx, along * dy + turn * ny, along * dz + turn * nz
    length = np.sqrt(dx * dx + dy * dy + dz * dz)
    return dx / length, dy / length, dz / length


@njit(cache=True)
def _polarised(index, beyond, sine, across):
    """Reflectance of one polarisation from one index into another; sine: of its way outside, below both."""
    here, there = np.sqrt(1 - (sine / index) ** 2), np.sqrt(1 - (sine / beyond) ** 2)
    a, b = (index * here, beyond * there) if across else (beyond * here, index * there)
    return ((a - b) / (a + b)) ** 2


@njit(cache=True)
def _through_coat(cosine, eta, coat, inside, state):
    """Whether light goes through a surface under a coat of that index, bounce after bounce in it."""
    here, beyond = (eta, 1.0) if inside else (1.0, eta)
    sine = here * np.sqrt(1 - cosine * cosine)
    if sine >= 1:
        return False
    across = random(state) < 0.5
    near, far = _polarised(here, coat, sine, across), _polarised(coat, beyond, sine, across)
    if random(state) < near:
        return False
    while random(state) < far:
        if random(state) >= near:
            return False
    return True


@njit(cache=True)
def _at_face(normal, dx, dy, dz, inside, side, eta, state, coat=0.0):
    """The way on of a walk that meets a face, mirrored or refracted by chance, and whether it goes through.

    coat: index of refraction of a coat on the face, 0 for none.
    """
    nx, ny, nz = normal
    cosine = min(abs(dx * nx + dy * ny + dz * nz), 1.0)
    ratio = eta if inside else 1 / eta
    reflected, beyond = fresnel(cosine, ratio)
    if coat > 0:
        reflected = 0.0 if _through_coat(cosine, eta, coat, inside, state) else 1.0
    if random(state) < reflected:
        dx, dy, dz = _bent(dx, dy, dz, nx, ny, nz, 1.0, -2 * side * cosine)
        return dx, dy, dz, False
    dx, dy, dz = _bent(dx, dy, dz, nx, ny, nz, ratio, side * (beyond - ratio * cosine))
    return dx, dy, dz, True


@njit(cache=True)
def _leave(tally, at, weight, scattered, fresh):
    """Count what leaves through a patch."""
    if scattered:
        tally.scattered[at] += weight
        tally.again[at] += 0 if fresh else weight
    else:
        tally.unscattered[at] += weight


@njit(cache=True, nogil=True)
def follow(tree, near, volume, eta, coat, patch, origins, ways, again, seed, tally):
    """Follow light from outside, origins and unit ways (n, 3), each of weight 1, until it is gone.

    eta, patch (f,): index of refraction behind each triangle of the mesh, inside over outside, and its patch; coat:
    index of a coat on all of it, 0 for none; again:
    whether what leaves or is reflected outside is followed; tally: is added to.
    """
    state = np.array([seed], np.uint64)
    for walk in range(len(origins)):
        x, y, z = origins[walk]
        dx, dy, dz = ways[walk]
        weight, inside, skip, events = 1.0, False, -1, 0
        been, scattered, fresh, met = False, False, True, False  # fresh: has scattered since it entered again
        while weight > 0:
            events += 1
            if events > _EVENTS:
                tally.rest[3] += 1
                break
            flight = -np.log(1 - random(state)) / volume.majorant if inside else np.inf
            face, reach, side = -1, flight, LEAVING if inside else ENTERING
            if flight == np.inf or flight >= _free(near, x, y, z):
                face, reach = first_hit(tree, x, y, z, dx, dy, dz, flight, side, skip)
            if face < 0 and not inside:
                tally.rest[1] += weight if been else 0
                break
            x, y, z, skip = x + reach * dx, y + reach * dy, z + reach * dz, face
            if face < 0:
                albedo = _collision(volume, x, y, z, state)
                if albedo >= 0:
                    tally.rest[0] += weight * (1 - albedo)
                    weight, scattered, fresh = _lighter(weight * albedo, state), True, True
                    dx, dy, dz = _isotropic(state)
                continue
            met, tally.rest[2] = True, tally.rest[2] + (0 if met else 1)
            own = eta[tree.number[face]]
            dx, dy, dz, through = _at_face(tree.normal[face], dx, dy, dz, inside, side, own, state, coat)
            if not through:
                if inside or again:
                    continue
                break
            at = patch[tree.number[face]]
            if inside:
                _leave(tally, at, weight, scattered, fresh)
            elif not been:
                tally.entered[at] += weight
            if inside and not again:
                tally.rest[1] += weight
                break
            fresh, inside, been = not scattered, not inside, True
