"""Coefficients of a body from a capture, from its photographs to what is to be said of the result."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph.acquisition.capture import photographs
from quadgraph.acquisition.capture.capture import Capture
from quadgraph.acquisition.capture.photographs import Measured
from quadgraph.acquisition.causes import diagnosis, outlines
from quadgraph.acquisition.homogeneous import start
from quadgraph.acquisition.homogeneous.fitting import OUTER, Fit, fit
from quadgraph.acquisition.model import prediction
from quadgraph.acquisition.model.prediction import CHANNELS, NAMES, Predictor, SpreadSolves
from quadgraph.acquisition.model.problem import Problem
from quadgraph.acquisition.volume import volume_report
from quadgraph.acquisition.volume.fit_state import StateFolder
from quadgraph.acquisition.volume.volume_fit import VolumeFit, fit_volume, most_products
from quadgraph.acquisition.volume.volume_options import VolumeOptions
from quadgraph.api.materials import VolumeMaterial
from quadgraph.base.errors import InputError
from quadgraph.base.progress import ProgressCallback
from quadgraph.mesh import mesh_names

_ANYTHING = 5.0  # the same, from which on nothing is known of it
_LIGHTS = 4  # sets of lights, by whose photographs a volume begins
_STEPS = 2  # the same, at most
_TIED = 0.98  # correlation of a channel's two coefficients, from which on that is said


@dataclass(frozen=True, eq=False)
class Recovered:
    """A fit with what is to be said of it. undetermined: what the photographs leave open; findings: what is most
    probably wrong with them; notes: what the engine says against its own predictions.
    """

    capture: Capture
    measured: list[Measured]
    problem: Problem
    fit: Fit | VolumeFit
    undetermined: list[str]
    findings: list[str]
    notes: list[str]

    @property
    def material(self) -> VolumeMaterial:
        """The coefficients as --material takes them, on the volume's grid or a grid of one cell, with deviations."""
        if isinstance(self.fit, VolumeFit):
            found = self.fit
            return found.grid.material(found.coefficients, self.capture.eta, found.deviations, found.resolution)
        absorption, scattering = (row.reshape(1, 1, 1, 3) for row in self.fit.coefficients)
        spread = (row.reshape(1, 1, 1, 3) for row in self.fit.deviations[::-1])
        return VolumeMaterial(scattering, absorption, 1.0, (0.0, 0.0, 0.0), self.capture.eta, *spread)

    def report(self) -> dict[str, Any]:
        """All numbers, ready for JSON; coefficients and their deviations in 1/mm, by channel."""
        found = self.fit
        numbers = {"volume": volume_report.numbers(found)} if isinstance(found, VolumeFit) else _numbers(found)
        photographs = zip(self.measured, found.by_photograph, found.gains, self.problem.counted, strict=True)
        return {
            "capture": str(self.capture.path),
            "eta": self.capture.eta,
            **numbers,
            "photographs": [
                {
                    "file": str(one.stated.file),
                    "chi_squared_per_pixel": [None if np.isnan(value) else float(value) for value in chi],
                    "gain": gain.tolist(),
                    "pixels": int(counted.sum()),
                }
                for one, chi, gain, counted in photographs
            ],
            "undetermined": self.undetermined,
            "findings": self.findings,
            "notes": self.notes,
        }


def _numbers(found: Fit) -> dict[str, Any]:
    """What is known of coefficients that are the same throughout."""
    spread = found.coefficients * found.deviations
    return {
        "converged": found.converged,
        "coefficients": dict(zip(NAMES, found.coefficients.tolist(), strict=True)),
        "standard_deviations": dict(zip(NAMES, spread.tolist(), strict=True)),
        "deviations_of_logarithms": dict(zip(NAMES, found.deviations.tolist(), strict=True)),
        "correlation": found.correlations.tolist(),
        "chi_squared_per_degree": found.chi_squared.tolist(),
        "steps": [
            {
                "coefficients": dict(zip(NAMES, step.coefficients.tolist(), strict=True)),
                "chi_squared_per_degree": step.chi_squared.tolist(),
            }
            for step in found.steps
        ],
    }


def recover(
    capture: Capture,
    corrected: bool,
    volume: VolumeOptions | None,
    tell: ProgressCallback,
    advance: Callable[[float], None],
    device: str = "",
    validation: bool = False,
    resume: Path | None = None,
    spread: SpreadSolves | None = None,
) -> Recovered:
    """Recover the coefficients. corrected: predict by the engine with its correction to transport; volume: how those
    that differ from place to place are looked for, None for the same throughout; advance: is called with the share of
    the work done so far, 0 to 1, after each solve; device, validation: as `Stage` takes them; resume: a folder in which
    the state of a fit of a volume is kept after each outer step, and from which it goes on; spread: makes corrected
    predictions elsewhere, each set of lights by itself.

    Raises InputError, FormatError, SolverError, DeviceError.
    """
    if volume is not None and capture.deformation:
        raise InputError(
            f"{capture.path}: deformation: found, allowed with --volume is a body that lies as in its file; leave it "
            "out, and move cameras and lights instead"
        )
    measured = photographs.read_all(capture)
    with _body(capture, tell) as body:
        engine = partial(Predictor, body=body, device=device, validation=validation, spread=spread)
        if volume is None:
            found = _throughout(capture, measured, engine(capture), corrected, tell, advance)
        else:
            states = StateFolder(resume, capture, f"{corrected} {volume}") if resume else None
            found = _by_place(capture, measured, engine, corrected, volume, states, tell, advance)
    advance(1.0)
    return found


def _throughout(
    capture: Capture,
    measured: list[Measured],
    predictor: Predictor,
    corrected: bool,
    tell: ProgressCallback,
    advance: Callable[[float], None],
) -> Recovered:
    """The same coefficients throughout."""
    problem, found = _fitted(capture, measured, predictor, corrected, OUTER, tell, advance)
    findings = diagnosis.findings(problem, found, predictor, tell)
    return Recovered(capture, measured, problem, found, undetermined(found), findings, list(predictor.notes))


def _fitted(
    capture: Capture,
    measured: list[Measured],
    predictor: Predictor,
    corrected: bool,
    outer: int,
    tell: ProgressCallback,
    advance: Callable[[float], None],
) -> tuple[Problem, Fit]:
    """The best of a grid of coefficients that are the same throughout, and what a fit in so many steps makes of it."""
    grid = start.candidates(predictor.size_mm)
    work = _ShareDone(advance, predictor.solves * (len(grid) + 1), predictor.solves)
    first = predictor.predict(start.middle(predictor.size_mm), False, work.step)
    prediction.check_seen(capture, predictor.box_mm, first)
    outlines.check_masks(capture, measured, first)
    problem = Problem(capture, measured, first)
    starts = start.ranked(problem, predictor, grid, work.step)
    tell(f"start: {_text(np.exp(starts[0]))}")
    return problem, fit(problem, predictor, starts, corrected, tell, work.step, outer)


def _by_place(
    capture: Capture,
    measured: list[Measured],
    engine: Callable[[Capture], Predictor],
    corrected: bool,
    options: VolumeOptions,
    states: StateFolder | None,
    tell: ProgressCallback,
    advance: Callable[[float], None],
) -> Recovered:
    """Coefficients that differ from place to place, from homogeneous ones of some of the photographs on.

    engine: predicts a capture of the body.
    """
    kept = states.read() if states else None
    same = kept.start if kept else _of_some(capture, measured, engine, tell, lambda share: advance(0.2 * share))
    predictor = engine(capture)
    first = predictor.predict(same, False)
    prediction.check_seen(capture, predictor.box_mm, first)
    outlines.check_masks(capture, measured, first)
    problem = Problem(capture, measured, first)
    done = 0

    def step() -> None:
        nonlocal done
        done += 1
        advance(0.2 + 0.79 * min(1.0, done / most_products(predictor.solves, options)))

    begin = kept or (same, problem.best_gains(first, prediction.LEAST_ERROR))
    keep = states.write if states else lambda state: None
    volume = fit_volume(problem, predictor, begin, corrected, options, tell, step, keep)
    findings, left_open = diagnosis.of_volume(volume), volume_report.undetermined(volume)
    return Recovered(capture, measured, problem, volume, left_open, findings, list(predictor.notes))


def _of_some(
    capture: Capture,
    measured: list[Measured],
    engine: Callable[[Capture], Predictor],
    tell: ProgressCallback,
    advance: Callable[[float], None],
) -> np.ndarray:
    """Roughly, the same coefficients throughout, (2, 3); the engines that found them are gone then."""
    few = _some_lights(capture)
    some = [one for one in measured if one.stated in few.photographs]
    tell(f"the same coefficients throughout, from {len(some)} of {len(measured)} photographs")
    _, found = _fitted(few, some, engine(few), False, _STEPS, tell, advance)
    return found.coefficients


def _some_lights(capture: Capture) -> Capture:
    """A capture of all photographs under a few of its sets of lights."""
    sets = list(dict.fromkeys(each.lights for each in capture.photographs))
    chosen = {sets[k] for k in np.unique(np.linspace(0, len(sets) - 1, _LIGHTS).round().astype(int))}
    return replace(capture, photographs=tuple(each for each in capture.photographs if each.lights in chosen))


def undetermined(found: Fit) -> list[str]:
    """What the photographs do not determine, in words."""
    said = []
    for row, name in enumerate(NAMES):
        for channel, colour in enumerate(CHANNELS):
            deviation = found.deviations[row, channel]
            if deviation > volume_report.UNDETERMINED:
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
    from quadgraph.baking import kept
    from quadgraph.baking.pipeline import BakeOptions

    stated = capture.unit is not None or capture.height_mm is not None
    if not mesh_names.is_mesh(capture.body):
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
