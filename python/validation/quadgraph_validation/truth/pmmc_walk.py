"""Somebody else's random walks, pmmc's through tets, as a cross-check: the same quantities as reference/monte_carlo.py.

pmmc (https://mcx.space) is optional and walks on the CPU, but refuses to start where no OpenCL device is found, be it
the CPU's own (Debian's pocl-opencl-icd).
"""

from __future__ import annotations

import ctypes
import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from typing import Any

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph.tets.graph import Graph
from quadgraph_validation.base import extra_module
from quadgraph_validation.bodies import meshes
from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.truth import monte_carlo
from quadgraph_validation.truth.fresnel import gauss
from quadgraph_validation.truth.monte_carlo import Estimate

_WIDTH = 300.0  # mm of a slab: light hardly gets to its sides
_INSIDE = 1e-4  # mm below the surface, where walks start
_TURN = np.pi * (3 - np.sqrt(5))  # between beams, so that they spread evenly over a disc
_DOWN = np.array([0.0, 0.0, -1.0])
_END = 1e-5  # s after which pmmc lets go of a walk: none lives as long


def load() -> Any:
    """Import pmmc. Raises InputError, saying why, where it cannot run."""
    module, problem = _found()
    if problem:
        raise InputError(problem)
    return module


@lru_cache(maxsize=1)
def _found() -> tuple[Any, str]:
    """The module, or what is wrong with it. Asked only once: pmmc 0.3.12 hangs when it fails to find a device again."""
    try:
        with silent():
            pmmc = extra_module.load("pmmc", "truth")
            devices = pmmc.gpuinfo()
    except InputError as error:
        return None, str(error)
    except RuntimeError:
        devices = []
    if not devices:
        return None, "pmmc finds no OpenCL device, without which it does not start; Debian has pocl-opencl-icd"
    return pmmc, ""


def slab(medium: Medium, thickness: float, eta: float, walks: int, seed: int) -> Estimate:
    """Scattered reflectance, scattered transmittance, absorbed and unscattered share, (4,), of a slab `thickness` mm.

    Light enters at normal incidence. Raises InputError as `load` does.
    """
    side = np.array([0, _WIDTH])
    body = meshes.box(side, side, np.array([0, thickness]), meshes.no_wall)
    start = np.array([0.49 * _WIDTH, 0.51 * _WIDTH, _INSIDE])
    weight, scattered, position = _run(body, medium, eta, start, np.array([0.0, 0.0, 1.0]), walks, seed)
    below = position[:, 2] > thickness / 2
    # Rows: reflected, transmitted, absorbed and unscattered share of each walk; walks that never left were absorbed.
    shares = np.zeros((4, walks))
    shares[2] = 1
    for row, share in ((0, scattered & ~below), (1, scattered & below), (3, ~scattered)):
        shares[row, : len(weight)] = weight * share
    shares[2, : len(weight)] -= weight
    return Estimate(shares.mean(axis=1), shares.std(axis=1) / np.sqrt(walks))


def sphere(body: Graph, medium: Medium, eta: float, zones: int, beams: int, walks: int, seed: int) -> Estimate:
    """Scattered exitance (zones,), W/mm^2, of a ball in parallel light along -z, as monte_carlo.sphere has it.

    body: tets of the ball about the origin; beams: thin ones that stand for the light, at Gauss nodes of the cosine at
    which they meet the sphere, with walks / beams each. eta is 1, for the ball's facets would refract. Raises
    InputError as `load` does.
    """
    radius = float(np.linalg.norm(body.vertices, axis=1).max())
    edges, each = np.linspace(-1, 1, zones + 1), walks // beams
    cosines, weights = gauss(beams)
    mean, variance = np.zeros(zones), np.zeros(zones)
    for number, (cosine, part) in enumerate(zip(cosines, 2 * cosines * weights, strict=True)):
        across, turn = radius * np.sqrt(1 - cosine**2), _TURN * number
        start = _entry(body, across * np.array([np.cos(turn), np.sin(turn)]))
        if start is None:  # past the facets' rim
            continue
        left, scattered, position = _run(body, medium, eta, start, _DOWN, each, seed + number)
        at = position[scattered, 2] / np.linalg.norm(position[scattered], axis=1)
        first, second = (np.histogram(at, edges, weights=left[scattered] ** power)[0] / each for power in (1, 2))
        mean += part * first
        variance += part**2 * (second - first**2) / each
    scale = monte_carlo.entering_sphere(radius, eta) / (4 * np.pi * radius**2 / zones)
    return Estimate(scale * mean, scale * np.sqrt(variance))


def _entry(body: Graph, point: np.ndarray) -> np.ndarray | None:
    """Where light along -z over (2,) `point` meets a body first, (3,) mm, a little inside; None if it does not."""
    corners = body.vertices[body.faces]
    edges = np.moveaxis(corners[:, 1:, :2] - corners[:, :1, :2], 1, 2)
    flat = np.abs(np.linalg.det(edges)) < 1e-12
    edges[flat] = np.eye(2)
    u, v = np.linalg.solve(edges, (point - corners[:, 0, :2])[..., None])[..., 0].T
    met = np.flatnonzero(~flat & (u >= 0) & (v >= 0) & (u + v <= 1))
    if not len(met):
        return None
    weight = np.column_stack([1 - u - v, u, v])[met]
    return np.append(point, np.einsum("ij,ij->i", weight, corners[met, :, 2]).max() - _INSIDE)


def _run(
    body: Graph, medium: Medium, eta: float, start: np.ndarray, way: np.ndarray, walks: int, seed: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What of each walk that left is left (n,), whether it had scattered, and where it left (n, 3)."""
    pmmc = load()
    options = leaving_options(medium, eta, body.vertices.mean(axis=0), walks, seed) | {
        "node": body.vertices.astype(np.float32),
        "elem": (body.tets + 1).astype(np.int32),
        "elemprop": np.ones(len(body.tets), np.int32),
        "srcpos": start.tolist(),
        "srcdir": way.tolist(),
        "e0": _tet_around(body, start) + 1,
    }
    with silent():
        return that_left(pmmc.run(options), medium)


def leaving_options(medium: Medium, eta: float, middle: np.ndarray, walks: int, seed: int) -> dict[str, Any]:
    """Options of pmmc by which it tells each walk that leaves a body around `middle`, (3,) mm."""
    return {
        "nphoton": walks,
        "prop": [[0, 0, 1, 1], [medium.sigma_a, medium.sigma_s_prime, 0, eta]],
        "isreflect": int(eta != 1),
        "tstart": 0,
        "tend": _END,
        "tstep": _END,
        "compute": "sse",
        "method": "havel",
        "gpuid": 1,
        "seed": seed,
        # One detector around everything: every walk that leaves is told.
        "issavedet": 1,
        "issaveexit": 1,
        "detpos": [[*middle.tolist(), 1e4]],
        "maxdetphoton": walks + 10,
    }


def that_left(result: dict[str, Any], medium: Medium) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What of each walk that left is left (n,), whether it had scattered, and where it left (n, 3)."""
    found = np.asarray(result["detp"], np.float64)
    # Rows: detector, scatterings, length of the way in mm, position, direction, weight at the start.
    return found[9] * np.exp(-medium.sigma_a * found[2]), found[1] > 0, found[3:6].T


def _tet_around(body: Graph, point: np.ndarray) -> int:
    corners = body.vertices[body.tets]
    edges = np.moveaxis(corners[:, 1:] - corners[:, :1], 1, 2)
    inner = np.linalg.solve(edges, (point - corners[:, 0])[..., None])[..., 0]
    smallest = np.minimum(inner.min(axis=1), 1 - inner.sum(axis=1))
    return int(smallest.argmax())


@contextmanager
def silent() -> Iterator[None]:
    """Keep what compiled code prints, to either stream, from the terminal."""
    streams = sys.stdout, sys.stderr
    kept = [os.dup(number) for number in (1, 2)]
    with tempfile.TemporaryFile() as sink:
        for stream, number in zip(streams, (1, 2), strict=True):
            stream.flush()
            os.dup2(sink.fileno(), number)
        try:
            yield
        finally:
            ctypes.CDLL(None).fflush(None)
            for stream, number, before in zip(streams, (1, 2), kept, strict=True):
                stream.flush()
                os.dup2(before, number)
                os.close(before)
