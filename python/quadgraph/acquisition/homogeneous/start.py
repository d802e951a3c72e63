"""Where a fit starts: the best of a coarse grid of albedos and extinctions, so that it ends in no local minimum."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np

from quadgraph.acquisition.model.prediction import Predicted, Predictor
from quadgraph.acquisition.model.problem import Problem, huber_cost

ALBEDOS = (0.5, 0.9, 0.98, 0.996, 0.9992)  # reduced: sigma_s_prime / (sigma_s_prime + sigma_a)
DEPTHS = (3.0, 10.0, 30.0, 100.0)  # mean free paths across the body
_FLOOR = 0.15  # least relative error of a prediction: all candidates are wrong
_LEAST = 1e-3  # of the brightest prediction, and of data over prediction, below which all is the same
_CLOSE = 2.0  # of the best cost, up to which another start is worth a try
_APART = 1.0  # in logarithms, of the second start from the first


def candidates(size_mm: float) -> list[np.ndarray]:
    """Coefficients (2,), sigma_a and sigma_s_prime in 1/mm, for a body of that size."""
    pairs = itertools.product(DEPTHS, ALBEDOS)
    return [np.array([1 - albedo, albedo]) * depth / size_mm for depth, albedo in pairs]


def middle(size_mm: float) -> np.ndarray:
    """Coefficients (2, 3) by which the pixels are chosen: a body through which some light comes, 1/mm."""
    return np.repeat((np.array([0.02, 0.98]) * 20 / size_mm)[:, None], 3, axis=1)


def ranked(
    problem: Problem, predictor: Predictor, grid: list[np.ndarray], advance: Callable[[], None]
) -> tuple[np.ndarray, ...]:
    """Starts, logarithms (2, 3) each: the candidate that is best for each channel, and the best that is far from it.

    The second is left out where it is much worse in every channel.
    """
    costs = np.empty((len(grid), 3))
    for number, candidate in enumerate(grid):
        pictures = predictor.predict(np.repeat(candidate[:, None], 3, axis=1), False, advance)
        costs[number] = [_cost(problem, pictures, channel) for channel in range(3)]
    logs = np.log(np.array(grid))
    best, second, close = np.empty((2, 3)), np.empty((2, 3)), False
    for channel in range(3):
        order = np.argsort(costs[:, channel], kind="stable")
        best[:, channel] = logs[order[0]]
        far = [index for index in order if np.abs(logs[index] - logs[order[0]]).max() > _APART]
        second[:, channel] = logs[far[0]]
        close = close or costs[far[0], channel] < _CLOSE * costs[order[0], channel]
    return (best, second) if close else (best,)


def _cost(problem: Problem, pictures: list[Predicted], channel: int) -> float:
    _, variance = problem.variances(pictures, channel, _FLOOR)
    value = problem.values([each.radiance for each in pictures], channel)
    gain = problem.gains(value, problem.pixels[channel].data, variance, channel)
    expected = value * gain[problem.pixels[channel].photograph]
    expected = np.maximum(expected, max(expected.max() * _LEAST, 1e-100))
    relative = variance / expected**2
    # In logarithms: a candidate that is dark everywhere would have no weight anywhere.
    ratio = np.log(np.maximum(problem.pixels[channel].data, _LEAST * expected) / expected)
    return huber_cost(ratio / np.sqrt(relative + _FLOOR**2))
