"""What is predicted of a volume for the squares of all photographs, and how that changes with its coefficients."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from quadgraph import core
from quadgraph.acquisition.model.prediction import Predicted, Predictor
from quadgraph.acquisition.model.problem import Problem
from quadgraph.acquisition.volume import samples
from quadgraph.acquisition.volume.linearised import Channels, Linearised, by_lights
from quadgraph.acquisition.volume.volume_grid import VolumeGrid
from quadgraph.acquisition.volume.volume_weights import Sizes, Weighing, Weights
from quadgraph.base.errors import InputError

LARGEST_LEVEL = 40_000  # tets of the level that derivatives are taken on, if there is one of so few
MOST_SQUARES = 40_000
MOST_POINTS = 6000  # of the grid: deviations are found with dense matrices
SWEEP_POINTS = 80_000  # of the correction: with fewer its noise is what limits the contrasts that are found
_USUAL_POINTS = 2000  # at most, where no spacing is stated: with more the photographs of a body part less well


def derivative_level(graph: core.QuadGraph) -> int:
    """The finest level that is small enough to differentiate over and over, or else the coarsest."""
    small = [number for number, level in enumerate(graph.levels) if len(level.tets) <= LARGEST_LEVEL]
    return small[0] if small else len(graph.levels) - 1


class VolumeSetting:
    """What stays: photographs, their squares, and the grid in a level of the body. data (m, 3): values of all
    squares; inside (n,): volume of the body that each point of the grid stands for, mm^3.
    """

    def __init__(
        self, problem: Problem, predictor: Predictor, spacing: float | None, folder: Path, advance: Callable[[], None]
    ) -> None:
        """folder: for volumes on their way to the engine; spacing: mm, None: as long as the level's edges. Raises
        InputError.
        """
        self.problem, self.predictor, self.advance = problem, predictor, advance
        self._paths = (folder / f"{number}.npz" for number in itertools.count())
        graph = predictor.graph
        self.level = derivative_level(graph)
        level = graph.levels[self.level]
        corners = np.array(level.vertices, np.float64)[np.array(level.tets)]
        edges = corners[:, 1:] - corners[:, :1]
        mean_edge = float(np.linalg.norm(edges, axis=2).mean())
        self.grid = _grid(corners.reshape(-1, 3), spacing, mean_edge)
        self.at_tets = self.grid.weights(corners.mean(axis=1))
        self.inside = np.asarray(self.at_tets.T @ (np.abs(np.linalg.det(edges)) / 6))
        self.samples = samples.gather(problem, predictor, level, MOST_SQUARES)
        self.groups = by_lights(problem, self.samples)
        pairs = zip(self.samples.squares, problem.measured, strict=True)
        self.data = np.concatenate([squares.of(one.values) for squares, one in pairs])

    def predicted(
        self, logs: np.ndarray, gains: np.ndarray, corrected: bool, draw: int = 0, model: Linearised | None = None
    ) -> Around:
        """Predictions by the engine's own pictures around logarithms (2, n, 3) of sigma_a and sigma_s_prime, and gains
        (p, 3). draw: of what their correction draws by chance; model: the one around the same, if there is one. Raises
        SolverError, InputError.
        """
        path = next(self._paths)
        self.grid.material(np.exp(logs), self.problem.capture.eta).save(path)
        pictures = self.predictor.predict(
            path, corrected, self.advance, {"sweep_points": SWEEP_POINTS, "sweep_seed": draw}
        )
        model = model or self.linearised(logs)
        factors = [
            np.divide(squares.of(picture.radiance), other, out=np.zeros_like(other), where=other > 0)
            for squares, picture, other in zip(self.samples.squares, pictures, model.radiances, strict=True)
        ]
        expected = [
            scale * radiance for scale, radiance in zip(self.scales(factors, gains), model.radiances, strict=True)
        ]
        weights = Weights(self.problem, self.samples, pictures, expected)
        return Around(self, logs, gains, pictures, factors, draw, weights, model)

    def linearised(self, logs: np.ndarray) -> Linearised:
        """The model of the level around logarithms."""
        absorption, scattering = (np.asarray(self.at_tets @ each) for each in np.exp(logs))
        return self.linearised_at(absorption, scattering)

    def linearised_at(self, absorption: np.ndarray, scattering: np.ndarray, model: str = "sp3") -> Linearised:
        """The same around sigma_a and sigma_s_prime of the tets, (n_t, 3) 1/mm each."""
        tets = absorption, scattering
        return Linearised(self.predictor, self.groups, self.level, tets, self.advance, model)

    def scales(self, factors: Channels, gains: np.ndarray) -> Channels:
        """What a square's value is over the model's radiance."""
        known = self.problem.exposure * self.problem.factor
        return [factor * gain * of for factor, gain, of in zip(factors, gains, known, strict=True)]

    def split(self, values: np.ndarray) -> Channels:
        """Values of all squares, (m, 3), by photograph."""
        return np.split(values, np.cumsum([len(each.rays) for each in self.samples.squares])[:-1])


@dataclass(frozen=True, eq=False)
class Around:
    """Predictions around a volume. factors: what the engine's pictures were over the model when they were made, by
    square; draw: of their correction, the last if they are means; weights: what residuals count.
    """

    setting: VolumeSetting
    logs: np.ndarray
    gains: np.ndarray
    pictures: list[Predicted]
    factors: Channels
    draw: int
    weights: Weights
    model: Linearised

    def moved(self, logs: np.ndarray, gains: np.ndarray) -> Around:
        """The same factors and weights around another volume. Raises SolverError."""
        model = self.setting.linearised(logs)
        return Around(self.setting, logs, gains, self.pictures, self.factors, self.draw, self.weights, model)

    def _values(self, radiances: Channels) -> np.ndarray:
        """(m, 3) of all squares."""
        scales = self.setting.scales(self.factors, self.gains)
        return np.concatenate([scale * radiance for scale, radiance in zip(scales, radiances, strict=True)])

    def renewed(self, corrected: bool) -> Around:
        """The same volume with factors and weights of the engine's own pictures of it, whose error is taken to be of
        the size that the residuals speak for. Raises SolverError.

        Factors of corrections are means over all draws but the first, which is of coefficients that are the same
        throughout: they change little with the volume, and by chance.
        """
        found = self.setting.predicted(self.logs, self.gains, corrected, self.draw + 1, self.model)
        if corrected and self.draw:
            found = found.of_factors(
                [old + (new - old) / found.draw for old, new in zip(self.factors, found.factors, strict=True)]
            )
        return found.sized(found.weights.estimated(found.residual, self.weights.sizes))

    def of_factors(self, factors: Channels) -> Around:
        """The same with other factors."""
        return replace(self, factors=factors)

    def sized(self, sizes: Sizes) -> Around:
        """The same with the engine's error of these sizes."""
        return replace(self, weights=self.weights.resized(sizes))

    def judged_by(self, weights: Weights) -> np.ndarray:
        """(3,) chi^2 per square by any weights, by channel."""
        left = weights.at(self.residual).apply(self.residual)
        return (self.residual * left).sum(axis=0) / weights.counts.sum(axis=0)

    @cached_property
    def residual(self) -> np.ndarray:
        """(m, 3) data less predictions, 0 where a square does not count."""
        return np.where(self.weights.counts, self.setting.data - self._values(self.model.radiances), 0)

    @cached_property
    def weighing(self) -> Weighing:
        """Weights at the residuals."""
        return self.weights.at(self.residual)

    @cached_property
    def chi_squared(self) -> np.ndarray:
        """(3,) per square, by channel."""
        return self.judged_by(self.weights)

    def by_photograph(self) -> np.ndarray:
        """(p, 3) mean squares of residuals in standard deviations, NaN where nothing counts."""
        square = np.where(self.weights.counts, self.weighing.each * self.residual**2, np.nan)
        return np.stack([_means(part) for part in self.setting.split(square)])

    def along(self, direction: np.ndarray) -> np.ndarray:
        """J v: how the squares' values, (m, 3), change along a direction of the logarithms, (2, n, 3)."""
        absorption, scattering = (np.asarray(self.setting.at_tets @ each) for each in np.exp(self.logs) * direction)
        return self._values(self.model.along(absorption, scattering))

    def transposed(self, values: np.ndarray) -> np.ndarray:
        """J^T w, (2, n, 3), of weights of the squares (m, 3)."""
        scales = self.setting.scales(self.factors, self.gains)
        found = self.model.back([scale * part for scale, part in zip(scales, self.setting.split(values), strict=True)])
        return np.exp(self.logs) * np.stack([np.asarray(self.setting.at_tets.T @ each) for each in found])

    def told(self, direction: np.ndarray) -> np.ndarray:
        """The matrix of Gauss and Newton times a direction of the logarithms."""
        self.setting.advance()
        return self.transposed(self.weighing.apply(self.along(direction)))


def _means(values: np.ndarray) -> np.ndarray:
    """(3,) of what is not NaN in (n, 3)."""
    known = ~np.isnan(values)
    return np.where(known.any(axis=0), np.nansum(values, axis=0) / np.maximum(known.sum(axis=0), 1), np.nan)


def _grid(points: np.ndarray, spacing: float | None, mean_edge: float) -> VolumeGrid:
    """The grid around points. Raises InputError where a stated spacing makes too many."""
    room = float(np.prod(np.ptp(points, axis=0)))
    usual, least = (1.2 * float(np.cbrt(room / most)) for most in (_USUAL_POINTS, MOST_POINTS))
    found = VolumeGrid.around(points, spacing or max(mean_edge, usual))
    if found.count > MOST_POINTS:
        raise InputError(
            f"--spacing: {found.count} points {found.spacing:.3g} mm apart found, allowed are {MOST_POINTS}; state a "
            f"wider spacing, such as {1.5 * max(least, found.spacing):.2g}"
        )
    return found
