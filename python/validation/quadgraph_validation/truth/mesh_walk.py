"""Truth for any body: random walks from its light through its triangle mesh, batch by batch, tallied over patches.

Independent of the engine: light_rays.py has the lights by their definitions, walk_kernel.py the walks, and both know
nothing but the mesh, the coefficients and Fresnel's equations.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from quadgraph.api.lights import Light
from quadgraph.mesh.surface import Surface
from quadgraph_validation.bodies.smooth_sky import SmoothSky
from quadgraph_validation.bodies.unseen_cases import UnseenMedium
from quadgraph_validation.truth import light_rays, walk_kernel
from quadgraph_validation.truth.walk_surface import walk_surface

_PILOT = 20_000  # rays, which tell how many of a light's meet the body


@dataclass(frozen=True, eq=False)
class WalkBatch:
    """Powers, W. By patch (n,): entered (for the first time), scattered (what left after it had scattered), again (of
    that, what left without having scattered since it entered again), unscattered (what left so, even if it entered
    again). In all: absorbed; gone, away for good after it was inside.

    walks: that met the body; lost: of them, those given up.
    """

    entered: np.ndarray
    scattered: np.ndarray
    again: np.ndarray
    unscattered: np.ndarray
    absorbed: float
    gone: float
    walks: int
    lost: int


class MeshWalker:
    """One body, or several apart from each other, what is in it, and one light."""

    def __init__(
        self,
        surface: Surface,
        medium: UnseenMedium,
        light: Light | SmoothSky,
        patch: np.ndarray,
        again: bool = True,
        eta: np.ndarray | None = None,
        coat: float = 0.0,
    ) -> None:
        """patch (m,): of each triangle; again: whether light outside the body is followed and may enter again.

        eta (m,): index of refraction behind each triangle; None is that of the medium for all. coat: index
        of a coat on all of the surface, 0 for none.
        """
        self._light, self._again, self._coat = light, again, float(coat)
        self._patch, self._patches = np.asarray(patch, np.int64), int(patch.max()) + 1
        low, high = surface.vertices.min(axis=0), surface.vertices.max(axis=0)
        self._middle = (low + high) / 2
        self._radius = float(np.linalg.norm(surface.vertices - self._middle, axis=1).max())
        self._tree, self._near = walk_surface(surface)
        self._volume = volume_of(medium)
        self._eta = np.full(len(patch), medium.eta) if eta is None else np.asarray(eta, np.float64)

    @cached_property
    def hit_rate(self) -> float:
        """Share of the light's drawn rays that meet the body."""
        tally = self._follow(_PILOT, [0, 0])[0]
        return tally.rest[2] / _PILOT

    def batch(self, walks: int, number: int, seed: int) -> WalkBatch:
        """About so many walks that meet the body; number: of the batch, each has random numbers of its own."""
        count = int(walks / max(self.hit_rate, 1e-3))
        tally, power = self._follow(count, [seed, number + 1])
        unit = power / count
        absorbed, gone, met, lost = tally.rest
        entered, scattered, again, unscattered = (unit * part for part in tally[:4])
        return WalkBatch(entered, scattered, again, unscattered, unit * absorbed, unit * gone, int(met), int(lost))

    def _follow(self, count: int, seed: list[int]) -> tuple[walk_kernel.WalkTally, float]:
        generator = np.random.default_rng(seed)
        drawn = light_rays.rays(self._light, self._middle, self._radius, count, generator)
        entered, scattered, again, unscattered = np.zeros((4, self._patches))
        tally = walk_kernel.WalkTally(entered, scattered, again, unscattered, np.zeros(4))
        start = generator.integers(2**64, dtype=np.uint64)
        origins, ways = np.ascontiguousarray(drawn.origins), np.ascontiguousarray(drawn.ways)
        what = (self._tree, self._near, self._volume, self._eta, self._coat, self._patch)
        walk_kernel.follow(*what, origins, ways, self._again, start, tally)
        return tally, drawn.power


def volume_of(medium: UnseenMedium) -> walk_kernel.WalkVolume:
    """A medium as walks take it."""
    scattering, absorption = (np.asarray(c, np.float64) for c in (medium.sigma_s_prime, medium.sigma_a))
    majorant = float((scattering + absorption).max())
    first, spacing = np.array(medium.first), np.full(3, medium.spacing)
    return walk_kernel.WalkVolume(scattering, absorption, first, spacing, majorant)
