"""Exposures of one scene merged to radiance with a variance for each pixel, by Poisson and Gaussian noise.

A value of an exposure t is t L + noise of variance read_out^2 + shot t L, L the radiance times a gain. The merged value
is the mean weighed by the inverse variances, saturated exposures left out.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterable, Sequence

import numpy as np
from scipy.optimize import nnls

from quadgraph.acquisition.capture.capture import NoiseModel
from quadgraph.acquisition.capture.radiance import Radiance
from quadgraph.acquisition.session.frames import Frame

_ROUNDS = 2  # of weights by the radiance that the last ones gave
_BINS, _LEAST_IN_BIN = 24, 200
_TOLD_BY = 1 << 18  # pixels of a pair of exposures
_MAD = 1.4826  # of normal noise, standard deviation over median absolute deviation
_BRIGHT = 20.0  # standard deviations, from which on pixels tell the ratio of two exposures
_VALUES = 1 << 15  # merged at a time, few enough for what is made of them on the way to stay in a core's cache


def merge(
    frames: Sequence[Frame], exposures: Sequence[float], noise: NoiseModel, black: np.ndarray | None, blacks: int
) -> Radiance:
    """Merge exposures of one size.

    black: (h, w, 3), the mean of `blacks` exposures without light, which is subtracted.
    """
    shape = frames[0].values.shape
    merged = Radiance(np.empty(shape, np.float32), np.empty(shape, np.float32), np.empty(shape, bool))
    step = max(_VALUES // max(shape[1] * shape[2], 1), 1)
    for first in range(0, shape[0], step):
        rows = slice(first, first + step)
        _merge_rows(merged, rows, frames, exposures, noise, black, blacks)
    return merged


def _merge_rows(
    merged: Radiance,
    rows: slice,
    frames: Sequence[Frame],
    exposures: Sequence[float],
    noise: NoiseModel,
    black: np.ndarray | None,
    blacks: int,
) -> None:
    wide = frames[0].values.shape[1]
    shares = np.tile(frames[0].shares, wide)  # a row of values: NumPy goes by three of them at a time slowly
    floor = noise.read_out**2 * shares * (1 + (1 / blacks if blacks else 0.0))
    dark = _flat(black[rows]) if black is not None else 0.0
    values = [_flat(frame.values[rows]) - dark for frame in frames]
    counts = [~_flat(frame.saturated[rows]) for frame in frames]
    weights = [np.where(count, time**2, 0.0) for count, time in zip(counts, exposures, strict=True)]
    found = _mean(values, weights, exposures)
    for _ in range(_ROUNDS):
        expected = np.maximum(found, 0)
        weights = [
            np.where(count, time**2 / (floor + noise.shot * shares * time * expected), 0.0)
            for count, time in zip(counts, exposures, strict=True)
        ]
        found = _mean(values, weights, exposures)
    whole = _sum(weights)
    usable = whole > 0
    _flat(merged.usable[rows])[:] = usable
    _flat(merged.values[rows])[:] = np.where(usable, found, 0)
    _flat(merged.variances[rows])[:] = 1 / np.where(usable, whole, 1)


def _flat(rows: np.ndarray) -> np.ndarray:
    """(h, 3 w) of (h, w, 3)."""
    return rows.reshape(len(rows), -1)


def _mean(values: Sequence[np.ndarray], weights: Sequence[np.ndarray], exposures: Sequence[float]) -> np.ndarray:
    parts = [weight * value / time for value, weight, time in zip(values, weights, exposures, strict=True)]
    whole = _sum(weights)
    return _sum(parts) / np.where(whole > 0, whole, 1)


def _sum(arrays: Sequence[np.ndarray]) -> np.ndarray:
    """One after the other: NumPy's own sum over a first axis takes several times as long."""
    return np.asarray(functools.reduce(np.add, arrays))


def estimate_noise(
    brackets: Iterable[tuple[Sequence[Frame], Sequence[float]]], black: np.ndarray | None
) -> NoiseModel | None:
    """The noise model by which pairs of exposures differ as they do; None where there is no pair to tell it.

    Differences of value over exposure have the variance read_out^2 (1/s^2 + 1/t^2) + shot L (1/s + 1/t); the median of
    each bin of brightness is taken off, so that exposures that are stated a little wrong do no harm.
    """
    rows, found, certain = [], [], []
    for frames, exposures in brackets:
        order = np.argsort(exposures)
        for short, long in itertools.pairwise(order):
            s, t = exposures[short], exposures[long]
            one, other = frames[short], frames[long]
            dark = black if black is not None else 0.0
            both = _some(~one.saturated & ~other.saturated)
            first, second = _some(one.values - dark) / s, _some(other.values - dark) / t
            for channel, share in enumerate(one.shares):
                fine = both[channel]
                # A mean that shot noise leaves independent of the difference: bins of it cut nothing off.
                mean = (s * first[channel][fine] + t * second[channel][fine]) / (s + t)
                for level, variance, count in _bins(mean, (first - second)[channel][fine]):
                    rows.append((share * (1 / s**2 + 1 / t**2), share * level * (1 / s + 1 / t)))
                    found.append(variance)
                    certain.append(np.sqrt(count) / variance)
    if len(rows) < 2:
        return None
    weights = np.array(certain)
    matrix = np.array(rows) * weights[:, None]
    scale = np.linalg.norm(matrix, axis=0)
    if not (scale > 0).all():
        return None
    squares = nnls(matrix / scale, np.array(found) * weights)[0] / scale
    return NoiseModel(float(np.sqrt(squares[0])), float(squares[1])) if squares.any() else None


def _some(values: np.ndarray) -> np.ndarray:
    """(3, n) of (h, w, 3): all pixels, or every so many of many, which tell the noise to a few in a thousand."""
    pixels = values.reshape(-1, 3)
    return np.ascontiguousarray(pixels[:: max(len(pixels) // _TOLD_BY, 1)].T)


def _bins(level: np.ndarray, off: np.ndarray) -> list[tuple[float, float, int]]:
    """Mean level, variance of what is off, and pixels, of bins of the level."""
    result: list[tuple[float, float, int]] = []
    if level.size < _LEAST_IN_BIN:
        return result
    edges = np.unique(np.quantile(level, np.linspace(0, 1, _BINS + 1)))
    count = max(len(edges) - 1, 1)
    places = np.clip(np.searchsorted(edges, level, side="right") - 1, 0, count - 1).astype(np.uint8)
    order = np.argsort(places, kind="stable")
    ends = np.cumsum(np.bincount(places, minlength=count))[:-1]
    for inside, levels in zip(np.split(off[order], ends), np.split(level[order], ends), strict=True):
        if len(inside) >= _LEAST_IN_BIN:
            spread = _MAD * float(np.median(np.abs(inside - np.median(inside))))
            if spread > 0:
                result.append((max(float(levels.mean()), 0.0), spread**2, len(inside)))
    return result


def ratios(
    frames: Sequence[Frame], exposures: Sequence[float], noise: NoiseModel, black: np.ndarray | None
) -> list[float]:
    """How many times as bright each exposure is, as stated, than the next longer one says; 1 where all is right."""
    order = np.argsort(exposures)
    dark = black if black is not None else 0.0
    result = []
    for short, long in itertools.pairwise(order):
        first, second = (frames[each].values - dark for each in (short, long))
        fine = ~frames[short].saturated & ~frames[long].saturated
        fine &= first > _BRIGHT * np.sqrt(noise.read_out**2 + noise.shot * np.maximum(first, 0))
        if fine.sum() < _LEAST_IN_BIN:
            continue
        whole = float(first[fine].sum() / exposures[short]), float(second[fine].sum() / exposures[long])
        result.append(whole[0] / whole[1])
    return result
