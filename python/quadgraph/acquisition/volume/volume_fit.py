"""Coefficients that differ from place to place, by Gauss and Newton's method with conjugate gradients inside.

Unknown are the logarithms of sigma_a and sigma_s_prime at the points of a grid, in each channel. Predictions are the
engine's pictures; their correction to transport, and what the finest level and the device add, are renewed in each
outer step as a factor of every square of pixels. Within one, the model is that of linearised.py on a coarser level,
whose derivative is exact (defect correction). Smoothing is lessened until that explains little more: how large the
engine's error is, is estimated on the way, so that chi^2 alone does not say when to stop.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import numpy as np
from scipy import sparse
from scipy.sparse import linalg

from quadgraph.acquisition.model.prediction import Predicted, Predictor
from quadgraph.acquisition.model.problem import Problem
from quadgraph.acquisition.volume import posterior, published_fit
from quadgraph.acquisition.volume.fit_state import FitState
from quadgraph.acquisition.volume.smoothing import LEAST_SHARE, Smoothing
from quadgraph.acquisition.volume.volume_grid import VolumeGrid
from quadgraph.acquisition.volume.volume_model import Around, VolumeSetting
from quadgraph.acquisition.volume.volume_options import H1, PUBLISHED, VolumeOptions
from quadgraph.acquisition.volume.volume_weights import Sizes
from quadgraph.base.errors import InputError
from quadgraph.base.progress import ProgressCallback

OUTER, INNER = 4, 3  # steps at most
_SMALL, _LONGEST = 0.01, 1.0  # of a logarithm: a step this small is the last at its smoothing; the most at once
_CG_STEPS, _CG_GAIN = 12, 1e-4  # at most; of the residual, squared, at which there are enough
_PROBES = 8  # for how much the photographs tell of each point
_FLOOR = 0.02  # of the best seen point, what the smoothing of others counts at least
_THRESHOLD = 0.05  # of a logarithm over the grid's spacing: smaller slopes are no steps
_FIRST, _LESS = 30.0, 0.4  # smoothing over what is told at first; from step to step, while too little is explained
_EXPLAINED = 0.6  # chi^2 per square, below which noise is explained, and less smoothing would explain more of it
_GAINED, _FEWEST = 0.1, 3  # of chi^2, that another step has to gain, after so many
_MORE = 1.25  # weights over those before, from which on less smoothing is tried again
_LEAST_GAIN = 0.1  # a gain's factor in one step, at least
_BOUNDS = np.log([1e-7, 1e4])  # of coefficients, 1/mm

Map: TypeAlias = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True, eq=False)
class VolumeStep:
    """One step: strength of the smoothing, and chi^2 per square (3,) after it, by channel."""

    smoothing: float
    chi_squared: np.ndarray


@dataclass(frozen=True, eq=False)
class VolumeFit:
    """What was found. grid: its points; coefficients (2, n, 3): sigma_a and sigma_s_prime at them, 1/mm; deviations
    (2, n, 3): standard deviations of their logarithms, and resolution (2, n, 3): over which length they are one number,
    mm; both None where the scheme states none; inside (n,): whether a tet depends on the point; chi_squared (3,): per
    square; by_photograph (p, 3): the same of each, without what squares share; pictures: the last predictions; gains
    (p, 3).
    """

    grid: VolumeGrid
    coefficients: np.ndarray
    deviations: np.ndarray | None
    resolution: np.ndarray | None
    inside: np.ndarray
    chi_squared: np.ndarray
    by_photograph: np.ndarray
    pictures: list[Predicted]
    gains: np.ndarray
    steps: list[VolumeStep]


def most_products(solves: int, options: VolumeOptions) -> int:
    """How often `fit_volume` calls `advance` at most, where a prediction of all photographs takes so many solves."""
    if options.scheme == PUBLISHED:
        return (published_fit.MOST_STEPS * (published_fit.SECTIONS + 1) + 3) * solves
    steps = OUTER * INNER
    return (OUTER + 2) * solves + steps * (solves + _CG_STEPS) + _PROBES + posterior.RANK


def fit_volume(
    problem: Problem,
    predictor: Predictor,
    start: tuple[np.ndarray, np.ndarray] | FitState,
    corrected: bool,
    options: VolumeOptions,
    tell: ProgressCallback,
    advance: Callable[[], None],
    keep: Callable[[FitState], None],
) -> VolumeFit:
    """Fit from homogeneous coefficients (2, 3), 1/mm, and gains (p, 3), or from the state that a fit was left in.

    advance: is called after each solve and product; keep: with the state after each outer step, where the scheme has
    some. Raises SolverError, InputError.
    """
    with tempfile.TemporaryDirectory(prefix="quadgraph-acquire-") as folder:
        setting = VolumeSetting(problem, predictor, options.spacing, Path(folder), advance)
        grid, side = setting.grid, setting.samples.side
        tell(
            f"volume: {' x '.join(map(str, grid.size))} points, {grid.spacing:.3g} mm apart, from "
            f"{len(setting.data)} squares of {side} x {side} pixels on level {setting.level}"
        )
        kept = start if isinstance(start, FitState) else None
        if kept:
            _check(kept, setting)
        first, gains = (start.start, start.gains) if isinstance(start, FitState) else start
        if options.scheme == PUBLISHED:
            return _published(setting, first, tell)
        logs = kept.logs if kept else np.log(np.repeat(first[:, None, :], grid.count, axis=1))
        found = setting.predicted(logs, np.array(gains), corrected, int(kept.draw) if kept else 0)
        if kept:
            found = found.of_factors(setting.split(kept.factors)).sized(Sizes(kept.in_tiles, kept.local))
        tell(f"{'resumed' if kept else 'start'}: chi^2 per square {_text(found.chi_squared)}")
        fit = _Fit(found, tell, kept, options.scheme != H1)
        for outer in range(int(kept.outer) if kept else 0, OUTER):
            following = fit.descended(found).renewed(corrected)
            # Of both by the same weights, which are new.
            before, after = found.judged_by(following.weights).max(), following.chi_squared.max()
            tell(f"predicted anew: chi^2 per square {_text(following.chi_squared)}{_sizes(following)}")
            little = after > (1 - _GAINED) * before
            if after < before:
                fit.reweigh(following.weights.over(found.weights))
                found = following
            last = little and fit.enough
            keep(fit.state(first, found, OUTER if last else outer + 1))
            if last:
                break
        tell("standard deviations")
        known = posterior.known(found.told, fit.matrices(found.logs), found.logs.shape)
        return _result(found, fit.steps, known)


def _check(kept: FitState, setting: VolumeSetting) -> None:
    """Raise InputError for a state of other points or squares."""
    found, wanted = (kept.logs.shape[1], len(kept.factors)), (setting.grid.count, len(setting.data))
    if found != wanted:
        raise InputError(
            "--resume: a state of {} points and {} squares found, {} and {} are wanted; remove it to begin anew, or "
            "name another folder".format(*found, *wanted)
        )


def _published(setting: VolumeSetting, start: np.ndarray, tell: ProgressCallback) -> VolumeFit:
    """What the published scheme makes of homogeneous coefficients (2, 3), judged by the engine's uncorrected pictures;
    its steps state the misfit of unlit squares, of 1, in place of chi^2.
    """
    first = published_fit.PublishedFit(setting).begin(start)
    last, misfits = published_fit.descend(first, tell)
    kappa, absorption = last.unknowns
    scattering = np.maximum(1 / (3 * kappa) - absorption, published_fit.SIGMA[0])
    gains = np.ones((len(setting.problem.measured), 3))
    found = setting.predicted(np.log(np.stack([absorption, scattering])), gains, False)
    return _result(found, [VolumeStep(published_fit.LAMBDA, misfit) for misfit in misfits], None)


def _result(found: Around, steps: list[VolumeStep], known: posterior.Known | None) -> VolumeFit:
    setting = found.setting
    return VolumeFit(
        setting.grid,
        np.exp(found.logs),
        known.deviations if known else None,
        known.lengths(setting.grid.spacing) if known else None,
        setting.inside > 0,
        found.chi_squared,
        found.by_photograph(),
        found.pictures,
        found.gains,
        steps,
    )


def _sizes(around: Around) -> str:
    """What the engine's error is taken to be, in words."""
    in_tiles, local = (float(each.max()) for each in around.weights.sizes)
    return f"; of the engine's error {in_tiles:.0%} from part to part of pictures, {local:.0%} from square to square"


def _text(values: np.ndarray) -> str:
    return ", ".join(f"{each:.3g}" for each in values)


class _Fit:
    """How volumes are smoothed, and steps towards better ones."""

    def __init__(self, first: Around, tell: ProgressCallback, kept: FitState | None, edges: bool) -> None:
        """Find by random weights how much the photographs tell of each point, and from that the first smoothing; or
        take both from a state. edges: as `Smoothing` has it.
        """
        self._tell = tell
        self.steps: list[VolumeStep] = []
        self.enough = False  # whether less smoothing would explain little more
        self._diagonal = _told_of_points(first) if kept is None else kept.told
        inside, grid = first.setting.inside, first.setting.grid
        density = np.sqrt(self._diagonal.sum(axis=2) / np.maximum(inside, LEAST_SHARE * inside.max()))
        # Of both together: what is told less of varies more freely, or the other would take its part.
        most = max(float(np.quantile(each[inside > 0], 0.99)) for each in density)
        told = np.clip(density / max(most, 1e-300), _FLOOR, 1)
        self._smoothing = Smoothing(grid, inside, told, _THRESHOLD / grid.spacing, edges)
        self.strength = 1.0
        if kept is None:
            pairs = zip(self._diagonal, self.matrices(first.logs), strict=True)
            self.strength = _FIRST * max(float(each.sum() / 3 / matrix.diagonal().sum()) for each, matrix in pairs)
        else:
            pairs_kept = zip(kept.smoothings.tolist(), kept.chi_squared, strict=True)
            self.steps = [VolumeStep(smoothing, chi) for smoothing, chi in pairs_kept]
            self.strength, self.enough = float(kept.smoothing), bool(kept.enough)

    def state(self, start: np.ndarray, found: Around, outer: int) -> FitState:
        """What another run goes on from after so many outer steps."""
        return FitState(
            start,
            found.gains,
            found.logs,
            self._diagonal,
            np.array(self.strength),
            np.array(self.enough),
            np.array(outer),
            np.array([step.smoothing for step in self.steps]),
            np.array([step.chi_squared for step in self.steps]),
            *found.weights.sizes,
            np.concatenate(found.factors),
            np.array(found.draw),
        )

    def reweigh(self, factor: float) -> None:
        """Go on as smooth as before with squares that count so much more."""
        self._diagonal = factor * self._diagonal
        self.strength *= factor
        self.enough = self.enough and factor < _MORE

    def matrices(self, logs: np.ndarray) -> Sequence[sparse.csr_array]:
        """The smoothing of each coefficient around logarithms, (n, n)."""
        return [self.strength * each for each in self._smoothing.matrices(logs)]

    def descended(self, around: Around) -> Around:
        """A few steps with the same factors, each with less smoothing as long as that explains more."""
        before = float(around.chi_squared.max())
        for _ in range(INNER):
            if self.steps and not self.enough:
                self.strength *= _LESS
            step, gains = self._step(around)
            around = around.moved(np.clip(around.logs + step, *_BOUNDS), around.gains * gains)
            chi = around.chi_squared
            self.steps.append(VolumeStep(self.strength, chi))
            self._tell(f"step {len(self.steps)}: chi^2 per square {_text(chi)}")
            after = float(chi.max())
            little = len(self.steps) >= _FEWEST and after > (1 - _GAINED) * before
            if self.enough and (little or np.abs(step).max() < _SMALL):
                break
            if little and not self.enough:
                self.strength /= _LESS  # what it was one step before
                self.enough = True
            self.enough = self.enough or after < _EXPLAINED
            before = after
        return around

    def _step(self, around: Around) -> tuple[np.ndarray, np.ndarray]:
        """Of logarithms, (2, n, 3), no longer than is sane; and factors of gains, (p, 3)."""
        matrices = self.matrices(around.logs)

        def smoothed(logs: np.ndarray) -> np.ndarray:
            return np.stack([matrix @ part for matrix, part in zip(matrices, logs, strict=True)])

        residual, weighing = around.residual, around.weighing
        slope = around.transposed(weighing.apply(residual)) - smoothed(around.logs)
        step = _conjugate_gradients(
            lambda direction: around.told(direction) + smoothed(direction), slope, self._preconditioner(matrices)
        )
        step = np.clip(step, -_LONGEST, _LONGEST)
        group = around.setting.problem.group
        factors = np.ones((len(group), 3))
        factors[group >= 0] += weighing.gains(residual - around.along(step))[group[group >= 0]]
        return step, np.maximum(factors, _LEAST_GAIN)

    def _preconditioner(self, matrices: Sequence[sparse.csr_array]) -> Map:
        """Solves with the smoothing, and the diagonal of what the photographs tell."""
        solvers = [
            [_factorised(matrix, diagonal[:, channel]) for channel in range(3)]
            for matrix, diagonal in zip(matrices, self._diagonal, strict=True)
        ]

        def solve(right: np.ndarray) -> np.ndarray:
            parts = [
                [solver.solve(np.ascontiguousarray(part[:, channel])) for channel, solver in enumerate(each)]
                for each, part in zip(solvers, right, strict=True)
            ]
            return np.moveaxis(np.array(parts), 1, 2)

        return solve


def _told_of_points(around: Around) -> np.ndarray:
    """(2, n, 3) how much the photographs tell of the logarithm of each point, by random weights."""
    random, root = np.random.default_rng(0), np.sqrt(around.weighing.each)
    diagonal = np.zeros(around.logs.shape)
    for _ in range(_PROBES):
        signs = random.choice([-1.0, 1.0], size=root.shape)
        diagonal += around.transposed(root * signs) ** 2 / _PROBES
        around.setting.advance()
    return diagonal


def _factorised(matrix: sparse.csr_array, diagonal: np.ndarray) -> linalg.SuperLU:
    least = 1e-9 * diagonal.max()
    return linalg.splu(sparse.csc_array(matrix + sparse.diags_array(diagonal + least)))


def _conjugate_gradients(matrix: Map, right: np.ndarray, inverse: Map) -> np.ndarray:
    """Solve roughly; arrays of any shape."""
    found = np.zeros_like(right)
    left = right.copy()
    corrected = inverse(left)
    direction, size = corrected, float((left * corrected).sum())
    enough = _CG_GAIN * size
    for _ in range(_CG_STEPS):
        if size <= enough:
            break
        image = matrix(direction)
        length = size / float((direction * image).sum())
        found += length * direction
        left -= length * image
        corrected = inverse(left)
        size, before = float((left * corrected).sum()), size
        direction = corrected + size / before * direction
    return found
