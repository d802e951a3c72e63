"""Homogeneous coefficients by Levenberg and Marquardt's method in logarithms.

The predictions are those of the engine with its correction to transport. That is renewed in each outer step as a factor
of every pixel; within a step, predictions and derivatives are those of the engine without it (defect correction).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from quadgraph.acquisition.model.prediction import LEAST_ERROR, Predicted, Predictor
from quadgraph.acquisition.model.problem import Problem, huber_cost, huber_weights
from quadgraph.base.progress import ProgressCallback

OUTER, INNER, TRIES = 10, 15, 6  # at most
_DIFFERENCE = 0.1  # of a logarithm, by which derivatives are taken: dim pixels of predictions are noisy
_SMALL, _SHARE = 1e-3, 0.1  # a step this small, or of a standard deviation, is the last
_KEPT = 8  # predictions
_SAME = 0.005  # relative change of chi^2, below which a step changes nothing
_ROUGH = 0.03  # the same of the first fit, which is not corrected yet
_LONGEST = 1.5  # of a logarithm, in one step
_BOUNDS = np.log([1e-7, 1e4])  # of coefficients, 1/mm

Advance = Callable[[], None]


@dataclass(frozen=True, eq=False)
class Step:
    """One outer step: coefficients (2, 3), 1/mm, and chi^2 per degree of freedom (3,), by channel."""

    coefficients: np.ndarray
    chi_squared: np.ndarray


@dataclass(frozen=True, eq=False)
class Fit:
    """What was found. coefficients (2, 3): sigma_a and sigma_s_prime, 1/mm, of red, green, blue; covariance (3, 2, 2):
    of their logarithms; chi_squared (3,): per degree of freedom; by_photograph (p, 3): the same of each photograph's
    pixels; gains (p, 3): of photographs; pictures: the last predictions; steps: the outer ones; converged: whether the
    last was small enough.
    """

    coefficients: np.ndarray
    covariance: np.ndarray
    chi_squared: np.ndarray
    by_photograph: np.ndarray
    gains: np.ndarray
    pictures: list[Predicted]
    steps: list[Step]
    converged: bool

    @property
    def deviations(self) -> np.ndarray:
        """(2, 3) standard deviations of the coefficients' logarithms: relative ones, where they are small."""
        return np.sqrt(np.array([np.diag(each) for each in self.covariance])).T

    @property
    def correlations(self) -> np.ndarray:
        """(3,) of sigma_a with sigma_s_prime."""
        return self.covariance[:, 0, 1] / np.maximum(self.deviations[0] * self.deviations[1], 1e-300)


def fit(
    problem: Problem,
    predictor: Predictor,
    starts: tuple[np.ndarray, ...],
    corrected: bool,
    tell: ProgressCallback,
    advance: Advance,
    outer: int,
) -> Fit:
    """Fit from the best of several starts, logarithms (2, 3) each.

    advance: is called after each solve; outer: steps at most. Raises SolverError, InputError.
    """
    levels = _Model(problem, predictor, advance)
    levels.renew(starts[0], False)
    tries = [levels.inner(start, _ROUGH) for start in starts]
    costs = np.array([levels.costs(each) for each in tries])
    theta = np.array([tries[costs[:, channel].argmin()][:, channel] for channel in range(3)]).T
    steps: list[Step] = []
    converged = False
    for number in range(outer):
        levels.renew(theta, corrected)
        judged = levels.judged(theta)
        steps.append(Step(np.exp(theta), judged.chi_squared))
        tell(f"step {number + 1}: chi^2 per degree of freedom {', '.join(f'{c:.3g}' for c in judged.chi_squared)}")
        if converged or _settled(steps):
            converged = True
            break
        following = levels.inner(theta, _SMALL)
        change = np.abs(following - theta)
        converged = bool((change < np.maximum(_SMALL, _SHARE * judged.deviations)).all())
        if converged and change.max() < _SMALL:
            break
        theta = following
    return Fit(
        np.exp(theta),
        judged.covariance,
        judged.chi_squared,
        judged.by_photograph,
        judged.gains,
        levels.pictures,
        steps,
        converged,
    )


def _settled(steps: list[Step]) -> bool:
    """Whether the last step changed chi^2 by next to nothing in all channels."""
    return len(steps) > 1 and bool((np.abs(steps[-1].chi_squared / steps[-2].chi_squared - 1) < _SAME).all())


@dataclass(eq=False)
class _Judged:
    covariance: np.ndarray
    chi_squared: np.ndarray
    by_photograph: np.ndarray
    gains: np.ndarray

    @property
    def deviations(self) -> np.ndarray:
        return np.sqrt(np.array([np.diag(each) for each in self.covariance])).T


class _Model:
    """Predictions of the engine without correction times a factor a pixel, which the correction gives."""

    def __init__(self, problem: Problem, predictor: Predictor, advance: Advance) -> None:
        self._problem, self._predictor, self._advance = problem, predictor, advance
        self.pictures: list[Predicted] = []
        self._kept: dict[bytes, list[Predicted]] = {}
        self._ratios: list[np.ndarray] = []
        self._noise: list[np.ndarray] = []
        self._variances: list[np.ndarray] = []

    def renew(self, theta: np.ndarray, corrected: bool) -> None:
        """Take factors and variances from coefficients' logarithms."""
        plain = self._plain(theta)
        self.pictures = plain
        self._ratios = [np.ones(each.radiance.shape) for each in plain]
        if corrected:
            self.pictures = self._predictor.predict(np.exp(theta), True, self._advance)
            for number, (one, other) in enumerate(zip(self.pictures, plain, strict=True)):
                lit = other.radiance > 0
                self._ratios[number][lit] = one.radiance[lit] / other.radiance[lit]
        pairs = [self._problem.variances(self.pictures, channel, LEAST_ERROR) for channel in range(3)]
        self._noise, self._variances = [noise for noise, _ in pairs], [variance for _, variance in pairs]

    def _plain(self, theta: np.ndarray) -> list[Predicted]:
        """Predictions without correction; the last few are kept, since a step begins where the one before ended."""
        key = theta.tobytes()
        if key not in self._kept:
            if len(self._kept) == _KEPT:
                del self._kept[next(iter(self._kept))]
            self._kept[key] = self._predictor.predict(np.exp(theta), False, self._advance)
        return self._kept[key]

    def _values(self, theta: np.ndarray) -> list[np.ndarray]:
        plain = self._plain(theta)
        radiances = [ratio * each.radiance for ratio, each in zip(self._ratios, plain, strict=True)]
        return [self._problem.values(radiances, channel) for channel in range(3)]

    def _expected(self, value: np.ndarray, channel: int) -> tuple[np.ndarray, np.ndarray]:
        """(n,) values with the best gains, and those gains, robust by one look at the residuals."""
        pixels, variance = self._problem.pixels[channel], self._variances[channel]
        gains = self._problem.gains(value, pixels.data, variance, channel)
        for _ in range(3):
            residual = (pixels.data - gains[pixels.photograph] * value) / np.sqrt(variance)
            gains = self._problem.gains(value, pixels.data, variance / huber_weights(residual), channel)
        return gains[pixels.photograph] * value, gains

    def _residual(self, value: np.ndarray, channel: int) -> np.ndarray:
        expected, _ = self._expected(value, channel)
        return (self._problem.pixels[channel].data - expected) / np.sqrt(self._variances[channel])

    def costs(self, theta: np.ndarray) -> np.ndarray:
        """(3,) robust sums of squares, by channel."""
        return np.array([huber_cost(self._residual(value, c)) for c, value in enumerate(self._values(theta))])

    def _columns(self, theta: np.ndarray, values: list[np.ndarray]) -> list[np.ndarray]:
        """(n, 2) derivatives of the values by the logarithms, of each channel."""
        shifted = [self._values(theta + _DIFFERENCE * np.array([[row == 0], [row == 1]])) for row in range(2)]
        return [
            np.stack([(shifted[row][channel] - values[channel]) / _DIFFERENCE for row in range(2)], axis=1)
            for channel in range(3)
        ]

    def _system(self, columns: np.ndarray, value: np.ndarray, channel: int):
        """Columns without gains, weights, and the residual in units of the data."""
        expected, gains = self._expected(value, channel)
        residual = self._problem.pixels[channel].data - expected
        variance = self._variances[channel]
        weight = huber_weights(residual / np.sqrt(variance)) / variance
        photograph = self._problem.pixels[channel].photograph
        reduced = self._problem.without_gains(columns * gains[photograph][:, None], expected, weight, channel)
        return reduced, weight, residual

    def inner(self, theta: np.ndarray, small: float) -> np.ndarray:
        """Logarithms (2, 3) that fit best with the present factors and variances; small: a step that is the last."""
        values = self._values(theta)
        costs = np.array([huber_cost(self._residual(value, c)) for c, value in enumerate(values)])
        damping = np.full(3, 1e-3)
        for _ in range(INNER):
            columns = self._columns(theta, values)
            systems = [self._system(columns[c], values[c], c) for c in range(3)]
            moved = 0.0
            for _ in range(TRIES):
                trial = np.clip(theta + _steps(systems, damping), *_BOUNDS)
                found = self._values(trial)
                after = np.array([huber_cost(self._residual(value, c)) for c, value in enumerate(found)])
                better = after < costs
                moved = max(moved, float(np.abs(trial - theta)[:, better].max(initial=0)))
                theta = np.where(better, trial, theta)
                values = [found[c] if better[c] else values[c] for c in range(3)]
                costs = np.where(better, after, costs)
                damping = np.where(better, damping / 10, damping * 10)
                if better.any():
                    break
            if moved < small:
                break
        return theta

    def judged(self, theta: np.ndarray) -> _Judged:
        """How good and how certain coefficients are."""
        values = self._values(theta)
        columns = self._columns(theta, values)
        count = len(self._problem.measured)
        covariance, chi = np.empty((3, 2, 2)), np.empty(3)
        by_photograph, gains = np.full((count, 3), np.nan), np.ones((count, 3))
        for channel in range(3):
            reduced, weight, residual = self._system(columns[channel], values[channel], channel)
            expected, gains[:, channel] = self._expected(values[channel], channel)
            square = weight * residual**2
            photograph = self._problem.pixels[channel].photograph
            for number in range(count):
                mine = photograph == number
                by_photograph[number, channel] = square[mine].mean() if mine.any() else np.nan
            free = max(len(residual) - 2 - len(self._problem.groups), 1)
            chi[channel] = square.sum() / free
            covariance[channel] = self._covariance(channel, reduced, weight, expected) * max(1.0, chi[channel])
        return _Judged(covariance, chi, by_photograph, gains)

    def _covariance(self, channel: int, reduced: np.ndarray, weight: np.ndarray, expected: np.ndarray) -> np.ndarray:
        """Of the logarithms: noise apart in each pixel, the engine's own error alike in each of `Problem.blocks`."""
        matrix = reduced.T @ (weight[:, None] * reduced)
        inverse = np.linalg.pinv(matrix, rcond=1e-14)
        noise = self._noise[channel]
        scaled = weight[:, None] * reduced
        middle = scaled.T @ (noise[:, None] * scaled)
        error = np.sqrt(np.maximum(self._variances[channel] - noise, 0))
        block = self._problem.blocks(self.pictures, channel)
        patches = np.stack([np.bincount(block, scaled[:, row] * error) for row in range(2)], axis=1)
        return inverse @ (middle + patches.T @ patches) @ inverse


def _steps(systems: list, damping: np.ndarray) -> np.ndarray:
    """(2, 3) damped Gauss-Newton steps of all channels, each no longer than is sane."""
    steps = np.empty((2, 3))
    for channel, (reduced, weight, residual) in enumerate(systems):
        matrix = reduced.T @ (weight[:, None] * reduced)
        slope = reduced.T @ (weight * residual)
        damped = matrix + damping[channel] * np.diag(np.maximum(np.diag(matrix), 1e-300))
        steps[:, channel] = np.linalg.lstsq(damped, slope, rcond=None)[0]
    return np.clip(steps, -_LONGEST, _LONGEST)
