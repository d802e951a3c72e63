"""Weights of the squares of a volume: noise, the engine's own error, and gains.

What photographs share is unknown and taken out in closed form, by channel: a gain without a stated value may be
anything, and the engine's error is alike in all squares that are about as bright under the same lights, there with its
stated size as its deviation; some of it is alike in each part of a picture, and some another in each square [Tarvainen
et al. 2010 on why the model's own error has to be in the weights]. How much those two are is estimated from residuals:
what the engine states is an error of whole pictures, and may be many times what differs from place to place.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from typing import NamedTuple

import numpy as np
from scipy import sparse

from quadgraph.acquisition.model.prediction import Predicted
from quadgraph.acquisition.model.problem import BANDS, Problem, huber_weights
from quadgraph.acquisition.volume.samples import TILES, Samples

_ANYTHING = 1e-12  # inverse variance of a gain that may be anything
_BEYOND = 5.0  # standard deviations, from which on a square's weight falls
_LEAST = 0.03  # of the stated error, that each part of it is taken to be at least


class Sizes(NamedTuple):
    """The engine's error over what it states, (3,) each: alike in each part of a picture; another in each square."""

    in_tiles: np.ndarray
    local: np.ndarray


AT_FIRST = Sizes(np.full(3, 0.25), np.full(3, 1.0))  # while residuals are those of a material that is wrong


class Weights:
    """Inverse covariance of the squares of all photographs, stacked. counts (m, 3): whether a square counts at all."""

    def __init__(
        self, problem: Problem, samples: Samples, pictures: Sequence[Predicted], expected: Sequence[np.ndarray]
    ) -> None:
        """pictures: predictions, whose errors count; expected: values of the squares, (n, 3) a photograph, with the
        present gains.
        """
        noise, error, band = [], [], []
        for one, squares, picture, value in zip(problem.measured, samples.squares, pictures, expected, strict=True):
            radiance = squares.of(picture.radiance)
            scale = np.divide(value, radiance, out=np.zeros_like(value), where=radiance > 0)
            pixels = one.variance_of(picture.radiance * np.median(scale, axis=0))
            noise.append(squares.variance(pixels))
            error.append(squares.of(picture.error))
            band.append(np.rint(squares.of(picture.band)).astype(int))
        self.counts = np.concatenate([each.counts for each in samples.squares])
        self._value, size = np.concatenate(expected), np.concatenate(error)
        self._noise, self._error = np.concatenate(noise), size * self._value
        self._problem, self._bands = problem, np.concatenate(band)
        self._photograph = np.repeat(np.arange(len(expected)), [len(each) for each in expected])
        self._tile = np.concatenate([each.tile for each in samples.squares])
        self._resize(AT_FIRST)

    def resized(self, sizes: Sizes) -> Weights:
        """The same, with the engine's error of other sizes."""
        other = copy(self)
        other._resize(sizes)
        return other

    def _resize(self, sizes: Sizes) -> None:
        self.sizes = sizes
        self._weight = np.where(self.counts, 1 / np.maximum(self._variance(sizes), 1e-300), 0)
        self._shared = [
            _Shared(
                self._problem,
                (self._photograph, self._tile, self._bands[:, channel]),
                self._error[:, channel],
                self._value[:, channel],
                sizes.in_tiles[channel],
            )
            for channel in range(3)
        ]

    def _variance(self, sizes: Sizes) -> np.ndarray:
        """(m, 3) of what differs from square to square."""
        return self._noise + (sizes.local * self._error) ** 2

    def estimated(self, residual: np.ndarray, guess: Sizes) -> Sizes:
        """The sizes that residuals (m, 3) speak for, by moments: of what differs within tiles, and of tiles' means.

        guess: about what they are, by which residuals are weighed and cut off. Neither is more than all of what the
        engine states: what is beyond that is no error of the engine's.
        """
        limit = _BEYOND * np.sqrt(self._variance(guess))
        believed = np.clip(residual, -limit, limit)
        found = [self._of_channel(believed[:, channel], channel, guess) for channel in range(3)]
        in_tiles, local = np.clip(np.sqrt(np.maximum(np.array(found).T, 0)), _LEAST, 1)
        return Sizes(in_tiles, local)

    def _of_channel(self, residual: np.ndarray, channel: int, guess: Sizes) -> tuple[float, float]:
        """Squares of both sizes, or less than 0."""
        error = self._error[:, channel]
        use = self.counts[:, channel] & (error > 0)
        if not use.any():
            return 0.0, 0.0
        value, noise = residual[use] / error[use], self._noise[use, channel] / error[use] ** 2
        in_tiles, local = (float(size[channel] ** 2) for size in guess)
        photograph = self._photograph[use]
        return _sizes(value, noise, photograph, TILES**2 * photograph + self._tile[use], (in_tiles, local))

    def over(self, other: Weights) -> float:
        """How much more a square counts than by other weights, in the middle of all."""
        return float(np.median(self._weight[self.counts] / other._weight[self.counts]))

    def at(self, residual: np.ndarray) -> Weighing:
        """The weights at residuals (m, 3): less where these are beyond belief."""
        return Weighing(self._weight * huber_weights(residual * np.sqrt(self._weight), _BEYOND), self._shared)


def _sizes(
    value: np.ndarray, noise: np.ndarray, photograph: np.ndarray, tile: np.ndarray, guess: tuple[float, float]
) -> tuple[float, float]:
    """Variances of what tiles share and of what differs in them, of values (n,) whose noise has these variances.

    By moments, weighed as the likelihood weighs them around a guess of both; means of photographs are anything.
    """
    weight = 1 / (noise + guess[1])
    total = np.bincount(tile, weight)
    tiles = np.flatnonzero(total)
    mean, size = np.bincount(tile, weight * value)[tiles] / total[tiles], total[tiles]
    number = np.searchsorted(tiles, tile)
    share = weight / size[number]
    left = (weight * (value - mean[number])) ** 2 - weight**2 * noise * (1 - share)
    local = float(left.sum() / max((weight**2 * (1 - share)).sum(), 1e-300))
    # A tile's mean strays by noise and what differs within it, and is held against that of its photograph.
    strays = np.bincount(number, weight**2 * (noise + max(local, 0.0))) / size**2
    of = photograph[np.unique(number, return_index=True)[1]]
    part = size / np.bincount(of, size)[of]

    def spread(variance: np.ndarray) -> np.ndarray:
        return variance * (1 - 2 * part) + np.bincount(of, part**2 * variance)[of]

    mean = mean - np.bincount(of, part * mean)[of]
    weight = 1 / (strays + guess[0]) ** 2
    shared = weight * (mean**2 - spread(strays))
    return float(shared.sum() / max((weight * spread(np.ones(len(tiles)))).sum(), 1e-300)), local


class Weighing:
    """Weights by which residuals are held to be what they are. each (m, 3): before what is shared is taken out."""

    def __init__(self, each: np.ndarray, shared: Sequence[_Shared]) -> None:
        """shared: of each channel."""
        self.each, self._shared = each, shared
        self._inverse = [own.inverse(each[:, channel]) for channel, own in enumerate(shared)]

    def _best(self, weighed: np.ndarray, channel: int) -> np.ndarray:
        """The shared amounts that fit weighed residuals of a channel, (m,), best."""
        return self._inverse[channel] @ (self._shared[channel].columns.T @ weighed)

    def apply(self, residual: np.ndarray) -> np.ndarray:
        """The inverse covariance times (m, 3)."""
        weighed = self.each * residual
        taken = [own.columns @ self._best(weighed[:, channel], channel) for channel, own in enumerate(self._shared)]
        return weighed - self.each * np.stack(taken, axis=1)

    def gains(self, residual: np.ndarray) -> np.ndarray:
        """(groups, 3) by how much unknown gains should grow, relative."""
        weighed = self.each * residual
        found = [self._best(weighed[:, channel], channel)[own.first_gain :] for channel, own in enumerate(self._shared)]
        return np.stack(found, axis=1)


class _Shared:
    """What the squares of a channel share: the engine's error by lights and brightness and by parts of pictures, then
    gains.
    """

    def __init__(
        self,
        problem: Problem,
        places: tuple[np.ndarray, np.ndarray, np.ndarray],
        error: np.ndarray,
        value: np.ndarray,
        in_tiles: float,
    ) -> None:
        """places: photograph, part of the picture, and band of brightness of each square; error: in units of value;
        in_tiles: how much of it is alike in parts of pictures.
        """
        photograph, tile, band = places
        bands, tiles = BANDS * len(problem.measured), TILES**2 * len(problem.measured)
        self.first_gain = bands + tiles
        group = problem.group[photograph]
        unknown = np.flatnonzero(group >= 0)
        every = np.arange(len(value))
        rows = np.concatenate([every, every, unknown])
        by_tile = bands + TILES**2 * photograph + tile
        columns = np.concatenate([BANDS * problem.alike[photograph] + band, by_tile, self.first_gain + group[unknown]])
        entries = np.concatenate([error, in_tiles * error, value[unknown]])
        shape = len(value), self.first_gain + len(problem.groups)
        self.columns = sparse.csr_array((entries, (rows, columns)), shape=shape)
        self._prior = np.append(np.ones(self.first_gain), np.full(len(problem.groups), _ANYTHING))

    def inverse(self, weight: np.ndarray) -> np.ndarray:
        """Covariance of the shared amounts, for weights (m,)."""
        matrix = (self.columns.T @ sparse.diags_array(weight) @ self.columns).toarray()
        return np.linalg.inv(matrix + np.diag(self._prior))
