"""What settings of a solve cost on a baked file, and how far each is from the truth."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph import core
from quadgraph.baking.budget.displayed import DisplayedFile, DisplayedTruth

MODELS = ("diffusion", "sp3")
CYCLES = (1, 2, 3, 4, 6)  # on the finest level
CORRECTED_CYCLES = (3,)  # the same, before sweeps, which cost far more and mend most of what is left
SWEEPS = (0, 1, 2)  # of the transport equation
STEPS = (8, 16, 32, 64, 128, 256)  # of conjugate gradients, where there is no coarser level
_GAIN = 0.97  # of an error: more cycles than those that leave more of it are not tried
_LOWEST_ORDER, _HIGHEST_ORDER = 0.25, 1.0  # of the error in the number of vertices, where it is not between two trials


@dataclass(frozen=True)
class BudgetScene:
    """What a budget is for. material, lights: as the engine reads them, lights by a name; given: not the usual ones."""

    material: str
    lights: Mapping[str, Sequence[str]]
    given: bool


@dataclass(frozen=True, order=True)
class Setting:
    """What may be the same on two files.

    deep: whether the levels go down as far as they can; cycles: on the finest level; sweeps: of the transport equation,
    0 for no correction.
    """

    deep: bool
    model: str
    cycles: int
    sweeps: int


@dataclass(frozen=True)
class Trial:
    """One setting on one file. errors: relative RMS by light and part; cost: bytes read and written a frame, mean.

    levels: of the file; deep, model, cycles, sweeps: its setting; share: of an error that these may have and count as
    keeping it, for the truth that they were measured by has an error, too.
    """

    surface_vertices: int
    levels: int
    deep: bool
    model: str
    cycles: int
    sweeps: int
    cost: float
    errors: dict[str, dict[str, float]]
    share: float = field(default_factory=lambda: core.MEASURED_SHARE)

    @property
    def error(self) -> float:
        """The largest."""
        return max(max(parts.values()) for parts in self.errors.values())

    def keeps(self, error: float) -> bool:
        """With certainty."""
        return self.error <= self.share * error

    @property
    def setting(self) -> Setting:
        """What may be the same on another file."""
        return Setting(self.deep, self.model, self.cycles, self.sweeps)

    def as_dict(self) -> dict[str, Any]:
        """Ready for JSON."""
        return asdict(self)


def measure(
    path: Path,
    scene: BudgetScene,
    truths: Mapping[str, DisplayedTruth],
    truth_vertices: int,
    device: str,
    models: Iterable[str] = MODELS,
    deep: bool = False,
    sweeps: int = 0,
) -> list[Trial]:
    """Every setting on one file, until more cycles bring nothing.

    truth_vertices: on the surface that the truth was solved on; deep: as in Trial.
    """
    subject = DisplayedFile(path, scene.material, device)
    known = known_share(subject, truth_vertices)
    trials: list[Trial] = []
    for model in models:
        least = np.inf
        assemble(subject, scene, model)
        for cycles in _cycles(subject.levels, sweeps):
            trials.append(trial(subject, scene, truths, known, Setting(deep, model, cycles, sweeps)))
            if trials[-1].error > _GAIN * least:
                break
            least = trials[-1].error
    return trials


def _cycles(levels: int, sweeps: int) -> tuple[int, ...]:
    if levels == 1:
        return STEPS
    return CORRECTED_CYCLES if sweeps else CYCLES


def assemble(subject: DisplayedFile, scene: BudgetScene, model: str) -> None:
    """Solve once, so that later solves under new light only do what new light takes."""
    subject.solve(next(iter(scene.lights.values())), model=model)


def known_share(subject: DisplayedFile, truth_vertices: int) -> float:
    """Share of a file's error that a truth with so many vertices on its surface shows.

    Errors of two solutions add by their squares, which fall no slower than the number of vertices rises
    (docs/accuracy.md).
    """
    return float(np.sqrt(1 - min(subject.surface_vertices / truth_vertices, 0.5)))


def trial(
    subject: DisplayedFile,
    scene: BudgetScene,
    truths: Mapping[str, DisplayedTruth],
    known: float,
    setting: Setting,
) -> Trial:
    """One setting on one file; known: of `known_share`."""
    errors, costs = {}, []
    for name, lights in scene.lights.items():
        solved = subject.solve(lights, setting.sweeps, model=setting.model, cycles=setting.cycles)
        errors[name] = {part: error / known for part, error in truths[name].error(solved).items()}
        costs.append(solved.cost)
    return Trial(subject.surface_vertices, subject.levels, **asdict(setting), cost=float(np.mean(costs)), errors=errors)


@dataclass(frozen=True)
class Forecast:
    """A setting at the number of vertices where it is expected to meet an error, and its expected cost."""

    setting: Setting
    surface_vertices: float
    cost: float


def forecast(trials: Sequence[Trial], wanted: float) -> Forecast | None:
    """The cheapest setting that meets an error, by lines through the logarithms; None if none does.

    Beyond the trials of a setting its error falls, with fewer vertices rises, by the order of the nearest two.
    """
    found = []
    for setting in sorted({trial.setting for trial in trials}):
        of = sorted((t for t in trials if t.setting == setting), key=lambda t: t.surface_vertices)
        if len(of) > 1 and (meets := _meets(of, wanted)) is not None:
            found.append(Forecast(setting, *meets))
    return min(found, key=lambda f: f.cost, default=None)


def _meets(trials: list[Trial], wanted: float) -> tuple[float, float] | None:
    """Vertices and cost where the error of one setting comes down to `wanted`, not beyond its finest trial."""
    if trials[-1].error > wanted:
        return None
    fine = len(trials) - 1
    while fine > 1 and trials[fine - 1].error <= wanted:
        fine -= 1
    a, b = trials[fine - 1], trials[fine]
    n, cost, error = (np.log([getattr(t, name) for t in (a, b)]) for name in ("surface_vertices", "cost", "error"))
    order = -(error[1] - error[0]) / (n[1] - n[0])
    if not a.error > wanted:
        order = np.clip(order, _LOWEST_ORDER, _HIGHEST_ORDER)
    at = n[1] + (error[1] - np.log(wanted)) / order
    growth = (cost[1] - cost[0]) / (n[1] - n[0])
    return float(np.exp(at)), float(np.exp(cost[1] + growth * (at - n[1])))
