"""Analogue random walks through a slab, by the angle at which light leaves.

Nothing here but free flights, scattering, absorption, reflection, and splitting: few walks get through a thick slab, so
it is cut into layers, and a walk that passes into the next deeper one goes on as two, of half its weight each.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.truth.fresnel import reflectance_from_inside, refracted
from quadgraph_validation.truth.monte_carlo import Estimate

BINS = 10
BIN_AREA = np.diff(np.linspace(0, 1, BINS + 1) ** 2)  # share of a hemisphere's cosine-weighted directions, per bin
_BATCHES = 25  # independent ones: their scatter is the standard error
_TOGETHER = 40_000  # walks that are followed at a time: the last few take as many steps as all of them


@dataclass(frozen=True)
class ExitAngles:
    """Radiance, W/(mm^2 sr) per W/mm^2 that entered, (BINS,): mean over cosine-weighted bins of the outside cosine.

    lit, unlit: the side that it leaves by. Only light that scattered.
    """

    lit: Estimate
    unlit: Estimate


@dataclass
class _Walks:
    """Walks under way: batch, layer, depth in it in mean free paths, inside cosine to the unlit side, scattered yet.

    A walk in layer n has weight 2^-n.
    """

    batch: np.ndarray
    layer: np.ndarray
    depth: np.ndarray
    cosine: np.ndarray
    scattered: np.ndarray

    def taken(self, which: np.ndarray) -> _Walks:
        """Those of a mask or of indices."""
        indices = np.flatnonzero(which) if which.dtype == bool else which
        return _Walks(*(array.take(indices) for array in vars(self).values()))

    def joined(self, other: _Walks) -> _Walks:
        pairs = zip(vars(self).values(), vars(other).values(), strict=True)
        return _Walks(*(np.concatenate(pair) for pair in pairs))


def slab(medium: Medium, thickness: float, eta: float, cosine: float, walks: int, seed: int) -> ExitAngles:
    """Light of outside cosine `cosine` on a slab of `thickness` mm; `walks` of it enter, refracted."""
    generator = np.random.default_rng(seed)
    size = -(-walks // _BATCHES)
    depth = medium.sigma_t * thickness
    together = min(max(_TOGETHER // size, 1), _BATCHES)
    counts = [min(together, _BATCHES - first) for first in range(0, _BATCHES, together)]
    tallies = np.concatenate([_batches(medium, depth, eta, cosine, size, count, generator) for count in counts])
    radiance = tallies / (size * np.pi * BIN_AREA)
    mean, error = radiance.mean(axis=0), radiance.std(axis=0, ddof=1) / np.sqrt(_BATCHES)
    return ExitAngles(Estimate(mean[0], error[0]), Estimate(mean[1], error[1]))


def _batches(
    medium: Medium, depth: float, eta: float, cosine: float, size: int, count: int, generator: np.random.Generator
) -> np.ndarray:
    """Walks (count, 2, BINS) that left scattered, by batch, side and bin; `size` enter in each batch."""
    layers = _layers(medium.albedo, depth)
    height = depth / layers
    tally = np.zeros(count * 2 * BINS)
    inside = float(refracted(cosine, 1 / eta))
    batch, layer = np.repeat(np.arange(count), size), np.zeros(count * size, np.int64)
    walks = _Walks(batch, layer, np.zeros(len(batch)), np.full(len(batch), inside), np.zeros(len(batch), bool))
    while len(walks.depth):
        walks.depth = walks.depth + walks.cosine * generator.exponential(size=len(walks.depth))
        within = (walks.depth > 0) & (walks.depth < height)
        scattering = walks.taken(within & (generator.random(len(within)) < medium.albedo))
        scattering.cosine = generator.uniform(-1, 1, len(scattering.cosine))
        scattering.scattered[:] = True
        # A flight that meets a plane begins again there: it has no memory.
        crossing = walks.taken(~within)
        down = crossing.cosine > 0
        crossing.layer += np.where(down, 1, -1)
        outside = (crossing.layer < 0) | (crossing.layer == layers)
        crossing.depth = np.where(down ^ outside, 0.0, height)
        crossing = _split(crossing.taken(~outside), generator).joined(
            _surface(crossing.taken(outside), layers, eta, tally, generator)
        )
        walks = scattering.joined(crossing)
    return tally.reshape(count, 2, BINS)


def _layers(albedo: float, depth: float) -> int:
    """About as many as light is halved on its way through."""
    decay = min(np.sqrt(3 * (1 - albedo)), 1.0)
    return 1 + int(np.log2(1 + 0.75 * depth) * (1 - decay) + decay * depth / np.log(2))


def _split(walks: _Walks, generator: np.random.Generator) -> _Walks:
    """Two of each that came deeper; of the others one in two goes on, for both."""
    copies = np.where(walks.cosine > 0, 2, generator.integers(0, 2, len(walks.cosine)))
    return walks.taken(np.repeat(np.arange(len(copies)), copies))


def _surface(walks: _Walks, layers: int, eta: float, tally: np.ndarray, generator: np.random.Generator) -> _Walks:
    """Count what leaves, and turn the rest around."""
    walks.layer = np.clip(walks.layer, 0, layers - 1)
    cosine = np.abs(walks.cosine)
    stays = generator.random(len(cosine)) < reflectance_from_inside(cosine, eta)
    counted = ~stays & walks.scattered
    bins = np.minimum((BINS * refracted(cosine[counted], eta)).astype(np.int64), BINS - 1)
    side = 2 * walks.batch[counted] + (walks.cosine[counted] > 0)
    tally += np.bincount(bins + BINS * side, 0.5 ** walks.layer[counted], len(tally))
    staying = walks.taken(stays)
    staying.cosine = -staying.cosine
    return staying
