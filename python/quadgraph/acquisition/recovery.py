"""Homogeneous coefficients of a body from a capture, from its photographs to what is to be said of the result."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph.acquisition import diagnosis, photographs, prediction, start
from quadgraph.acquisition.capture import Capture
from quadgraph.acquisition.fitting import OUTER, Fit, fit
from quadgraph.acquisition.photographs import Measured
from quadgraph.acquisition.prediction import CHANNELS, Predictor
from quadgraph.acquisition.problem import Problem
from quadgraph.api.materials import VolumeMaterial
from quadgraph.base.errors import InputError
from quadgraph.base.progress import ProgressCallback

NAMES = ("sigma_a", "sigma_s_prime")
_UNDETERMINED = 0.35  # standard deviation of a logarithm, from which on a coefficient is said not to be determined
_ANYTHING = 5.0  # the same, from which on nothing is known of it
_TIED = 0.98  # correlation of a channel's two coefficients, from which on that is said


@dataclass(frozen=True, eq=False)
class Recovered:
    """A fit with what is to be said of it. undetermined: what the photographs leave open; findings: what is most
    probably wrong with them; notes: what the engine says against its own predictions.
    """

    capture: Capture
    measured: list[Measured]
    problem: Problem
    fit: Fit
    undetermined: list[str]
    findings: list[str]
    notes: list[str]

    @property
    def material(self) -> VolumeMaterial:
        """The coefficients as --material takes them: a grid of one cell."""
        absorption, scattering = (row.reshape(1, 1, 1, 3) for row in self.fit.coefficients)
        return VolumeMaterial(scattering, absorption, 1.0, (0.0, 0.0, 0.0), self.capture.eta)

    def report(self) -> dict[str, Any]:
        """All numbers, ready for JSON; coefficients and their deviations in 1/mm, by channel."""
        found = self.fit
        spread = found.coefficients * found.deviations
        return {
            "capture": str(self.capture.path),
            "eta": self.capture.eta,
            "converged": found.converged,
            "coefficients": dict(zip(NAMES, found.coefficients.tolist(), strict=True)),
            "standard_deviations": dict(zip(NAMES, spread.tolist(), strict=True)),
            "deviations_of_logarithms": dict(zip(NAMES, found.deviations.tolist(), strict=True)),
            "correlation": found.correlations.tolist(),
            "chi_squared_per_degree": found.chi_squared.tolist(),
            "photographs": [
                {
                    "file": str(one.stated.file),
                    "chi_squared_per_pixel": [None if np.isnan(value) else float(value) for value in chi],
                    "gain": gain.tolist(),
                    "pixels": int(counted.sum()),
                }
                for one, chi, gain, counted in zip(
                    self.measured, found.by_photograph, found.gains, self.problem.counted, strict=True
                )
            ],
            "steps": [
                {
                    "coefficients": dict(zip(NAMES, step.coefficients.tolist(), strict=True)),
                    "chi_squared_per_degree": step.chi_squared.tolist(),
                }
                for step in found.steps
            ],
            "undetermined": self.undetermined,
            "findings": self.findings,
            "notes": self.notes,
        }


def recover(
    capture: Capture,
    corrected: bool,
    tell: ProgressCallback,
    advance: Callable[[float], None],
    device: str = "",
    validation: bool = False,
) -> Recovered:
    """Recover the coefficients. corrected: predict by the engine with its correction to transport; advance: is called
    with the share of the work done so far, 0 to 1, after each solve; device, validation: as `Stage` takes them.

    Raises InputError, FormatError, SolverError, DeviceError.
    """
    measured = photographs.read_all(capture)
    with _body(capture, tell) as body:
        predictor = Predictor(capture, body, device, validation)
        grid = start.candidates(predictor.size_mm)
        work = _ShareDone(advance, predictor.solves * (len(grid) + 1), predictor.solves)
        first = predictor.predict(start.middle(predictor.size_mm), False, work.step)
        prediction.check_seen(capture, first)
        problem = Problem(capture, measured, first)
        ranking = start.ranked(problem, predictor, grid, work.step)
        tell(f"start: {_text(np.exp(ranking.starts[0]))}")
        found = fit(problem, predictor, ranking.starts, corrected, tell, work.step)
        notes = list(predictor.notes)
        findings = diagnosis.findings(problem, found, ranking)
    advance(1.0)
    return Recovered(capture, measured, problem, found, undetermined(found), findings, notes)


def undetermined(found: Fit) -> list[str]:
    """What the photographs do not determine, in words."""
    said = []
    for row, name in enumerate(NAMES):
        for channel, colour in enumerate(CHANNELS):
            deviation = found.deviations[row, channel]
            if deviation > _UNDETERMINED:
                said.append(f"{name} of {colour} is not determined: {_open(found, row, channel)}")
    for channel, colour in enumerate(CHANNELS):
        if abs(found.correlations[channel]) > _TIED:
            said.append(
                f"{NAMES[0]} and {NAMES[1]} of {colour} are tied (correlation {found.correlations[channel]:+.3f}): a "
                "mix of both is known better than either; photographs from the unlit side, or known gains, part them"
            )
    if not found.converged:
        said.append(f"the fit did not settle in {OUTER} steps")
    return said


def _open(found: Fit, row: int, channel: int) -> str:
    """How open a coefficient is, in words."""
    deviation, value = found.deviations[row, channel], found.coefficients[row, channel]
    if deviation > _ANYTHING:
        return "the photographs say nothing of its size"
    most = value * np.exp(2 * deviation)
    return f"its standard deviation is a factor of {np.exp(deviation):.3g}; two of them allow up to {most:.3g} 1/mm"


class _ShareDone:
    """How much of the work is done: solves for the start, then those of steps that get fewer and fewer."""

    def __init__(self, advance: Callable[[float], None], for_start: int, solves: int) -> None:
        self._advance, self._start, self._solves = advance, for_start, solves
        self._done = 0

    def step(self) -> None:
        """One more solve was made."""
        self._done += 1
        late = max(self._done - self._start, 0) / (60 * self._solves)
        self._advance(0.2 * min(self._done / self._start, 1.0) + 0.79 * late / (1 + late))


@contextmanager
def _body(capture: Capture, tell: ProgressCallback) -> Iterator[Path]:
    """The capture's body as a baked file: a mesh is baked, and kept for the next time."""
    from quadgraph.baking import bare, kept
    from quadgraph.baking.pipeline import BakeOptions

    stated = capture.unit is not None or capture.height_mm is not None
    if not bare.is_mesh(capture.body):
        if stated:
            raise InputError(f"{capture.path}: unit: found for {capture.body.name}, allowed for meshes; leave it out")
        yield capture.body
        return
    if not stated:
        raise InputError(
            f"{capture.path}: unit: is missing, {capture.body.name} is a mesh and needs it, or height (mm)"
        )
    tell(f"baking {capture.body.name}, once for this mesh and size")
    with kept.body(capture.body, BakeOptions(unit=capture.unit, height_mm=capture.height_mm), tell) as baked:
        yield baked


def _text(coefficients: np.ndarray) -> str:
    return ", ".join(
        f"{name} {'/'.join(f'{value:.3g}' for value in row)}" for name, row in zip(NAMES, coefficients, strict=True)
    )
