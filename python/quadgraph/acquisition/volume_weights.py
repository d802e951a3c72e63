"""How much each square of the photographs says of a volume: noise, the engine's own error, and gains.

What photographs share is unknown and taken out in closed form, by channel: a gain without a stated value may be
anything, and the engine's error is alike in all squares that are about as bright under the same lights, there with its
stated size as its deviation; some of it is alike in each part of a picture, and some another in each square [Tarvainen
et al. 2010 on why the model's own error has to be in the weights].
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import sparse

from quadgraph.acquisition.prediction import Predicted
from quadgraph.acquisition.problem import BANDS, Problem, huber_weights
from quadgraph.acquisition.samples import TILES, Samples

IN_TILES, LOCAL = 0.25, 1.0  # of the error, that differ from part to part of a picture, and from square to square
_ANYTHING = 1e-12  # inverse variance of a gain that may be anything
_BEYOND = 5.0  # standard deviations, from which on a square's weight falls


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
        value, size = np.concatenate(expected), np.concatenate(error)
        variance = np.concatenate(noise) + (LOCAL * size * value) ** 2
        self._weight = np.where(self.counts, 1 / np.maximum(variance, 1e-300), 0)
        photograph = np.repeat(np.arange(len(expected)), [len(each) for each in expected])
        bands = np.concatenate(band)
        tile = np.concatenate([each.tile for each in samples.squares])
        self._shared = [
            _Shared(problem, (photograph, tile, bands[:, channel]), (size * value)[:, channel], value[:, channel])
            for channel in range(3)
        ]

    def at(self, residual: np.ndarray) -> Weighing:
        """The weights at residuals (m, 3): less where these are beyond belief."""
        return Weighing(self._weight * huber_weights(residual * np.sqrt(self._weight), _BEYOND), self._shared)


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
        self, problem: Problem, places: tuple[np.ndarray, np.ndarray, np.ndarray], error: np.ndarray, value: np.ndarray
    ) -> None:
        """places: photograph, part of the picture, and band of brightness of each square; error: in units of value."""
        photograph, tile, band = places
        bands, tiles = BANDS * len(problem.measured), TILES**2 * len(problem.measured)
        self.first_gain = bands + tiles
        group = problem.group[photograph]
        unknown = np.flatnonzero(group >= 0)
        every = np.arange(len(value))
        rows = np.concatenate([every, every, unknown])
        by_tile = bands + TILES**2 * photograph + tile
        columns = np.concatenate([BANDS * problem.alike[photograph] + band, by_tile, self.first_gain + group[unknown]])
        entries = np.concatenate([error, IN_TILES * error, value[unknown]])
        shape = len(value), self.first_gain + len(problem.groups)
        self.columns = sparse.csr_array((entries, (rows, columns)), shape=shape)
        self._prior = np.append(np.ones(self.first_gain), np.full(len(problem.groups), _ANYTHING))

    def inverse(self, weight: np.ndarray) -> np.ndarray:
        """Covariance of the shared amounts, for weights (m,)."""
        matrix = (self.columns.T @ sparse.diags_array(weight) @ self.columns).toarray()
        return np.linalg.inv(matrix + np.diag(self._prior))
