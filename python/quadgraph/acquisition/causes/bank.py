"""How well photographs fit if something that the capture says is otherwise, for any coefficients.

Predictions on a coarse grid of coefficients, of pictures gathered in squares, are interpolated in logarithms, so that
another assumption costs milliseconds instead of a fit. It is good to some per cent, which is enough to tell mistakes
apart.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import interpolate, ndimage

from quadgraph.acquisition.model.prediction import Predicted, Predictor
from quadgraph.acquisition.model.problem import Problem, huber_costs, huber_weights, within

_DEPTHS = np.log((2.0, 6.0, 18.0, 54.0, 160.0))  # mean free paths across the body
_ABSORBED = np.log((0.0006, 0.003, 0.012, 0.04, 0.1, 0.25, 0.6))  # 1 - albedo
_FINE = (17, 25)  # points of the grid that is searched
_PIXELS = 2500  # of all photographs, that are compared
_BESIDE = 0.3  # relative error beside the body, where a prediction is dark
_SURROGATE = 0.03  # relative error of what is interpolated
_DARKEST = 1e-5  # of the brightest prediction
_TINY = 1e-30  # of single precision
_FAINT = 0.02  # of the brightest value, below which differences of logarithms say little


@dataclass(frozen=True, eq=False)
class Gathered:
    """A photograph in squares. values, noise, error (h, w, 3): means, their variances, and the engine's relative error;
    usable (h, w, 3): neither masked nor saturated; inside (h, w, 3): whether all of a square is of the body and may
    count; beside (h, w): whether nothing of it and of its neighbours is.
    """

    values: np.ndarray
    noise: np.ndarray
    error: np.ndarray
    usable: np.ndarray
    inside: np.ndarray
    beside: np.ndarray

    @property
    def compared(self) -> np.ndarray:
        """(h, w, 3) which squares are held against predictions: those inside, and where it is dark some beside."""
        some = np.zeros(self.beside.shape, bool)
        some[::2, ::2] = self.beside[::2, ::2]
        level = self.values[self.beside & self.usable.all(axis=2)]
        bright = np.quantile(self.values, 0.99)
        dark = level.size > 0 and np.quantile(level, 0.75) < _FAINT * bright
        return self.inside | (some & dark)[..., None]


@dataclass(frozen=True, eq=False)
class Otherwise:
    """What else may be true of one photograph; None: as the capture says.

    seen: its pictures; nodes (nodes, h, w, 3): logarithms of its predictions; gain: the name of an unknown gain that it
    has in place of its own.
    """

    seen: Gathered | None = None
    nodes: np.ndarray | None = None
    gain: str | None = None


class Bank:
    """Predictions of all photographs of a problem for coefficients of any size."""

    def __init__(self, problem: Problem, predictor: Predictor, pictures: Sequence[Predicted]) -> None:
        """pictures: predictions whose errors count."""
        self.problem, self.predictor = problem, predictor
        counted = sum(int(each.any(axis=2).sum()) for each in problem.counted)
        self.side = max(1, int(np.ceil(np.sqrt(counted / _PIXELS))))
        self.seen = [self._seen(number, picture) for number, picture in enumerate(pictures)]
        self.compared = [each.compared for each in self.seen]
        self.nodes = self.predicted(predictor)
        self._fine = {_nodes(few).shape[0]: _weights(few) for few in (False, True)}
        self._points = len(next(iter(self._fine.values())))
        self._known: dict[tuple[int, ...], np.ndarray] = {}

    def predicted(self, predictor: Predictor, few: bool = False) -> list[np.ndarray]:
        """(nodes, h, w, 3) logarithms of predictions of a predictor's photographs; few: at fewer nodes, for less."""
        found: list[list[np.ndarray]] = []
        for depth, absorbed in np.exp(_nodes(few)):
            coefficients = np.repeat(_coefficients(depth, absorbed, predictor.size_mm)[:, None], 3, axis=1)
            found.append([squares(each.radiance, self.side) for each in predictor.predict(coefficients, False)])
        return [logarithms(np.stack(pictures)) for pictures in zip(*found, strict=True)]

    def constant(self, predictor: Predictor, coefficients: np.ndarray) -> list[np.ndarray]:
        """The same for one pair of coefficients (2, 3), whatever those of other photographs are."""
        pictures = [squares(each.radiance, self.side) for each in predictor.predict(coefficients, False)]
        few = len(_nodes(True))
        return [np.repeat(logarithms(each[None]), few, axis=0) for each in pictures]

    def coefficients(self, otherwise: Mapping[int, Otherwise], without: Sequence[int] = ()) -> np.ndarray:
        """(2, 3) sigma_a and sigma_s_prime, 1/mm, that fit best, to photographs that are not left out."""
        best = self.costs(otherwise, without).argmin(axis=0)
        depth, absorbed = np.exp(_grid(_FINE)[best]).T
        return _coefficients(depth, absorbed, self.predictor.size_mm)

    def picture(self, number: int) -> np.ndarray:
        """(h, w, 3) what a photograph is predicted to show, of the coefficients that fit best."""
        best = self.costs({}).argmin(axis=0)
        nodes = self.nodes[number]
        return np.stack([np.exp(np.tensordot(self._fine[len(nodes)][best[c]], nodes[..., c], 1)) for c in range(3)], 2)

    def scale(self, number: int) -> float:
        """What the capture says a photograph's values are over radiance; an unknown gain is 1."""
        return float(self.problem.exposure[number] * self.problem.factor[number])

    def cost(self, otherwise: Mapping[int, Otherwise], of: Sequence[int] = ()) -> float:
        """Robust square of residuals, in standard deviations, per value, of the coefficients that fit best.

        of: photographs whose residuals count; all where none are named.
        """
        total = self.costs(otherwise)
        best = total.argmin(axis=0)
        counted = of or range(len(self.seen))
        whole = self.costs(otherwise, [n for n in range(len(self.seen)) if n not in counted]) if of else total
        count = sum(int(self._counts(number, otherwise).sum()) for number in counted)
        return float(np.take_along_axis(whole, best[None], axis=0).sum() / max(count, 1))

    def costs(self, otherwise: Mapping[int, Otherwise], without: Sequence[int] = ()) -> np.ndarray:
        """(fine, 3) the same in all, of each channel's coefficients; without: photographs that are left out."""
        groups = self._groups(otherwise, without)
        return sum((self._costs(each, otherwise) for each in groups), np.zeros((self._points, 3)))

    def residuals(self, otherwise: Mapping[int, Otherwise]) -> np.ndarray:
        """(n,) residuals, in standard deviations, of the coefficients that fit best."""
        best = self.costs(otherwise).argmin(axis=0)
        groups = self._groups(otherwise)
        return np.concatenate([self._left(each, otherwise, c)[best[c]] for each in groups for c in range(3)])

    def _groups(self, otherwise: Mapping[int, Otherwise], without: Sequence[int] = ()) -> list[list[int]]:
        """Photographs that share a gain, and each of a known gain alone."""
        groups: dict[int | str, list[int]] = {}
        for number in (each for each in range(len(self.seen)) if each not in without):
            named = otherwise[number].gain if number in otherwise else None
            group = int(self.problem.group[number])
            groups.setdefault(named or (group if group >= 0 else -1 - number), []).append(number)
        return list(groups.values())

    def _counts(self, number: int, otherwise: Mapping[int, Otherwise]) -> np.ndarray:
        seen = otherwise[number].seen if number in otherwise else None
        return self.compared[number] & (seen or self.seen[number]).usable

    def _costs(self, members: list[int], otherwise: Mapping[int, Otherwise]) -> np.ndarray:
        """(fine, 3) robust squares of photographs that share a gain, or of one of a known gain."""
        key = tuple(members)
        changed = any(number in otherwise for number in members)
        if changed or key not in self._known:
            left = [self._left(members, otherwise, channel) for channel in range(3)]
            found = np.stack([huber_costs(each).sum(axis=1) for each in left], axis=1)
            if changed:
                return found
            self._known[key] = found
        return self._known[key]

    def factors(self, otherwise: Mapping[int, Otherwise]) -> np.ndarray:
        """(photographs, 3) what values are times those predicted, of the coefficients that fit best."""
        best = self.costs(otherwise).argmin(axis=0)
        result = np.empty((len(self.seen), 3))
        for number, channel in np.ndindex(result.shape):
            fine, values, least, deviation = self._pairs(number, otherwise.get(number, Otherwise()), channel)
            row = fine[best[channel]][None]
            result[number, channel] = np.exp(_gains(row, values, least, deviation)[0, 0]) if values.size else 1.0
        return result

    def _left(self, members: list[int], otherwise: Mapping[int, Otherwise], channel: int) -> np.ndarray:
        """(fine, n) residuals of photographs that share a gain, in standard deviations."""
        parts = [self._pairs(number, otherwise.get(number, Otherwise()), channel) for number in members]
        fine = np.concatenate([each[0] for each in parts], axis=1)
        values, least, deviation = (np.concatenate([each[k] for each in parts]) for k in (1, 2, 3))
        if values.size and (otherwise.get(members[0], Otherwise()).gain or self.problem.group[members[0]] >= 0):
            fine = fine + _gains(fine, values, least, deviation)
        return (np.log(values + least) - np.logaddexp(fine, np.log(least))) / deviation

    def _pairs(self, number: int, other: Otherwise, channel: int) -> tuple[np.ndarray, ...]:
        """(fine, n) logarithms of predictions; (n,) values, what both are raised by, and deviations of logarithms."""
        seen = other.seen or self.seen[number]
        nodes = self.nodes[number] if other.nodes is None else other.nodes
        counts = self._counts(number, {number: other})[..., channel]
        fine = self._fine[len(nodes)] @ nodes[:, counts, channel] + np.float32(np.log(self.scale(number)))
        values = np.maximum(seen.values[counts, channel], 0).astype(np.float32)
        faint = _FAINT * float(np.quantile(values, 0.95)) if values.size else 0.0
        least = np.full(values.shape, max(faint, _TINY), np.float32)
        noise = np.minimum(seen.noise[counts, channel] / (values + least).astype(np.float64) ** 2, 1.0)
        deviation = np.sqrt(self.seen[number].error[counts, channel] ** 2 + _SURROGATE**2 + noise)
        return fine, values, least, deviation.astype(np.float32)

    def _seen(self, number: int, picture: Predicted) -> Gathered:
        one = self.problem.measured[number]
        inside = within(picture, self.problem.capture.polarised)
        error = np.where((picture.alpha > 0)[..., None], picture.error, _BESIDE)
        return Gathered(
            squares(one.values, self.side),
            squares(one.variance_of(one.values), self.side) / self.side**2,
            squares(error, self.side),
            squares(one.usable.astype(float), self.side) == 1,
            squares(inside.astype(float), self.side) == 1,
            ndimage.maximum_filter(squares(picture.alpha, self.side), 3) == 0,
        )


def _gains(fine: np.ndarray, values: np.ndarray, least: np.ndarray, deviation: np.ndarray) -> np.ndarray:
    """(fine, 1) logarithms of the factors by which predictions fit values best, robustly."""
    measured = np.log(values + least)
    gain = np.median(measured - fine, axis=1, keepdims=True)
    for _ in range(2):
        left = (measured - np.logaddexp(fine + gain, np.log(least))) / deviation
        weight = huber_weights(left) / deviation**2
        gain = gain + (weight * left * deviation).sum(axis=1, keepdims=True) / weight.sum(axis=1, keepdims=True)
    return gain


def squares(picture: np.ndarray, side: int) -> np.ndarray:
    """Means over squares of so many pixels; what is left over at the right and the bottom is dropped."""
    height, width = (size // side for size in picture.shape[:2])
    trimmed = picture[: height * side, : width * side]
    return trimmed.reshape(height, side, width, side, *picture.shape[2:]).mean(axis=(1, 3))


def logarithms(pictures: np.ndarray) -> np.ndarray:
    """Of radiances (nodes, h, w, 3), those that are next to nothing raised to the same."""
    most = pictures.max(axis=(1, 2), keepdims=True)
    return np.log(np.maximum(pictures, np.maximum(most * _DARKEST, _TINY))).astype(np.float32)


def _coefficients(depth: np.ndarray, absorbed: np.ndarray, size_mm: float) -> np.ndarray:
    """(2, ...) sigma_a and sigma_s_prime, 1/mm, from mean free paths across a body and 1 - albedo."""
    return np.array([absorbed, 1 - absorbed]) * depth / size_mm


def _axes(few: bool) -> tuple[np.ndarray, np.ndarray]:
    """Logarithms of depths, and of 1 - albedo, both rising."""
    return (_DEPTHS[::2], _ABSORBED[::3]) if few else (_DEPTHS, _ABSORBED)


def _nodes(few: bool) -> np.ndarray:
    """(nodes, 2) all pairs of both."""
    return np.array(list(itertools.product(*_axes(few))))


def _grid(counts: tuple[int, int]) -> np.ndarray:
    """(fine, 2) the finer grid between them."""
    points = [np.linspace(axis[0], axis[-1], count) for axis, count in zip(_axes(False), counts, strict=True)]
    return np.array(list(itertools.product(*points)))


def _weights(few: bool) -> np.ndarray:
    """(fine, nodes) what makes of values at the nodes those at the finer grid: cubic splines in both directions."""
    parts = []
    for nodes, count in zip(_axes(few), _FINE, strict=True):
        spline = interpolate.CubicSpline(nodes, np.eye(len(nodes)), bc_type="natural")
        parts.append(spline(np.linspace(nodes[0], nodes[-1], count)))
    return np.kron(*parts).astype(np.float32)
