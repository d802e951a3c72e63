"""The published method and our default on one body: frames of a turning light in turn, errors, and work to equal
errors.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Any

import numpy as np

from quadgraph.baking.budget.surface_errors import unlit_part
from quadgraph.base.errors import SolverError
from quadgraph.base.pass_report import PICTURE_PURPOSES, ms_by_pass
from quadgraph.base.progress import ProgressCallback
from quadgraph.core import load_core
from quadgraph_validation.benchmark.algebraic_error import AlgebraicJudge
from quadgraph_validation.benchmark.frame_passes import PICTURE_PASSES
from quadgraph_validation.chart.chart_measure import stages
from quadgraph_validation.chart.chart_method import SWING

if TYPE_CHECKING:
    from quadgraph.core import Engine

MATERIAL = "marble"
DEFAULT = "ours, default"
TARGET = 0.01  # relative RMS error of the exitance, whole and unlit, to which work is compared
_STEP_DEGREES = 5.0  # by which the light turns from frame to frame
_NEVER = 1e-9  # tolerance that no relaxation meets: the iterations asked for are all done
_TRUTH = {"solver": "dpcg", "tolerance": 1e-6, "max_iterations": 100_000, "warm": False}
_TRUTH_RESIDUAL = 1e-5  # demanded
_MOST = 3000  # iterations to TARGET after which a search gives up


@dataclass(frozen=True)
class TableWay:
    """A method as it runs in every frame.

    system: what is solved, in the words of Engine.solve; iterations: on every level, 0 for as many as `tolerance`
    takes; radiance: of its picture.
    """

    name: str
    system: dict[str, Any]
    solver: str
    tolerance: float
    iterations: int = 0
    radiance: str = "auto"

    @property
    def frame(self) -> dict[str, Any]:
        """Options of a frame's solve. The published method starts each from zero, as its Figure 9 says."""
        if self.iterations:
            return self.budget(self.iterations)
        return self.system | {"solver": self.solver, "tolerance": self.tolerance, "warm": True}

    def budget(self, iterations: int) -> dict[str, Any]:
        """Options of a solve from zero: so many iterations on every level, or cycles on the finest one."""
        options = self.system | {"solver": self.solver, "warm": False}
        if self.iterations:
            return options | {"tolerance": _NEVER, "max_iterations": iterations}
        return options | {"tolerance": TARGET, "cycles": iterations}


_PUBLISHED = {"method": "quadgraph-fdm", "model": "diffusion", "source": "diffuse", "inter_reflection": False}


def ways(iterations: int) -> tuple[TableWay, ...]:
    """The published method with its iterations per level; ours for the same equation, and for SP₃; and our default,
    which computes inter-reflection too.
    """
    ours = {"model": "sp3", "inter_reflection": False}
    return (
        TableWay("published", _PUBLISHED, "cascade", _NEVER, iterations, "lambertian"),
        TableWay("ours, diffusion", {"model": "diffusion", "inter_reflection": False}, "fmg-pcg", 1e-3),
        TableWay("ours, SP₃", ours, "fmg-pcg", 1e-3),
        TableWay(DEFAULT, ours | {"inter_reflection": True}, "fmg-pcg", 1e-3),
    )


NAMES = tuple(way.name for way in ways(1))


def light(step: int) -> str:
    """Parallel light of 1 W/mm^2 from the front, above and a side; it turns about y as `step` falls to 0."""
    angle = np.radians(_STEP_DEGREES * step)
    x, z = -0.5 * np.cos(angle) - 0.7 * np.sin(angle), 0.5 * np.sin(angle) - 0.7 * np.cos(angle)
    return f"directional:{x:.9g},-0.5,{z:.9g}:1"


@dataclass
class TableRunner:
    """One way on an engine of its own."""

    way: TableWay
    engine: Engine
    pixels: int
    frames: list[dict[str, float]] = field(default_factory=list)
    walls: list[float] = field(default_factory=list)
    report: dict[str, Any] = field(default_factory=dict)
    failed: str = ""

    def round(self) -> None:
        """Settle two steps before the light's place, then draw a frame at each step up to it."""
        self.engine.set_lights([light(SWING[0])])
        self.engine.solve(**self.way.frame | {"warm": False})
        if not self.frames:
            self._frame(SWING[0])  # compiles shaders and makes room
        for step in SWING[1:]:
            start = time.perf_counter()
            self.frames.append(self._frame(step))
            self.walls.append(1e3 * (time.perf_counter() - start))

    def _frame(self, step: int) -> dict[str, float]:
        self.engine.set_lights([light(step)])
        self.report = self.engine.solve(**self.way.frame)
        self.engine.render(width=self.pixels, height=self.pixels, samples=4, radiance=self.way.radiance)
        return ms_by_pass(self.engine.passes)

    def error(self, judged: AlgebraicJudge) -> dict[str, float]:
        """Error of the last solve against the converged solution of its equations."""
        return judged.error(np.asarray(self.engine.surface_field()["exitance"], np.float64))

    def judge(self) -> AlgebraicJudge:
        """The converged solution under the light of step 0. Raises SolverError if that fails."""
        self.engine.set_lights([light(0)])
        report = self.engine.solve(**self.way.system | _TRUTH)
        residual = report["levels"][-1]["residual"]
        if residual > _TRUTH_RESIDUAL:
            raise SolverError(
                f"{self.way.name}: residual {residual:.1e} of the exact solution, {_TRUTH_RESIDUAL:.0e} wanted"
            )
        found = self.engine.surface_field()
        area = np.asarray(found["area"], np.float64)
        return AlgebraicJudge(area, unlit_part(area, found["q"]), np.asarray(found["exitance"], np.float64))

    def least(self, judged: AlgebraicJudge) -> dict[str, Any] | None:
        """The fewest iterations, from zero, after which neither error exceeds TARGET, with work and errors; None if
        _MOST are not enough. That more iterations leave less is taken for granted.
        """
        tried: dict[int, dict[str, Any]] = {}

        def meets(count: int) -> bool:
            report = self.engine.solve(**self.way.budget(count))
            error = self.error(judged)
            tried[count] = {"iterations": count, "work": report["work"], **error}
            return max(error.values()) <= TARGET

        high = 1
        while not meets(high):
            high *= 2
            if high > _MOST:
                return None
        low = high // 2
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (low, middle) if meets(middle) else (middle, high)
        return tried[high]

    def solve_ms(self, iterations: int) -> float:
        """Device time of such a solve after the light has changed, exitance included, without shadow maps and
        picture.
        """
        self.engine.set_lights([light(0)])
        self.engine.solve(**self.way.budget(iterations))
        return sum(entry["time_ms"] for entry in self.engine.passes if entry["name"] not in PICTURE_PASSES)

    def record(self) -> dict[str, Any]:
        """Ready for JSON: the quickest frame with its stages, the range, frames per second; memory; the last report."""
        if self.failed:
            return {"failed": self.failed}
        whole = [sum(frame.values()) for frame in self.frames]
        best = stages(self.frames[whole.index(min(whole))])
        purposes = {use["purpose"]: use["bytes"] for use in self.engine.memory()}
        solved = [self.report[name] for name in ("method", "model", "source", "solver")]
        return {
            "method": ", ".join(solved),
            "iterations": [level["iterations"] for level in self.report["levels"]],
            "work": round(self.report["work"], 2),
            "ms": round(min(whole), 3),
            "ms_median": round(median(whole), 3),
            "wall_ms": round(min(self.walls), 3),
            "stages": {name: round(ms, 3) for name, ms in best.items()},
            "frames_per_s": round(1e3 / min(whole), 3),
            "solve_bytes": sum(size for purpose, size in purposes.items() if purpose not in PICTURE_PURPOSES),
            "all_bytes": sum(purposes.values()),
        }


def measure(
    path: Path, iterations: int, repeats: int, pixels: int, device: str, tell: ProgressCallback
) -> dict[str, Any]:
    """All ways on a baked body: frames in turn, what they leave, and the work and time to TARGET.

    A way that fails says why. Raises FormatError, DeviceError.
    """
    runners = [TableRunner(way, _engine(path, device), pixels) for way in ways(iterations)]
    for number in range(repeats):
        for runner in runners:
            tell(f"frames, round {number + 1} of {repeats}: {runner.way.name}")
            _guarded(runner, runner.round)
    found = {runner.way.name: runner.record() for runner in runners}
    load = round(os.getloadavg()[0], 2)
    for runner in runners:
        tell(f"to {100 * TARGET:g}%: {runner.way.name}")
        if not runner.failed:
            _guarded(runner, partial(_judged, runner, found[runner.way.name]))
    _time_least(runners, found, repeats, tell)
    failed = {runner.way.name: {"failed": runner.failed} for runner in runners if runner.failed}
    return {"load": load, "ways": found | failed}


def _judged(runner: TableRunner, entry: dict[str, Any]) -> None:
    settled = np.asarray(runner.engine.surface_field()["exitance"], np.float64)
    judged = runner.judge()
    entry["error"] = judged.error(settled)
    entry["least"] = runner.least(judged)


def _time_least(runners: list[TableRunner], found: dict[str, Any], repeats: int, tell: ProgressCallback) -> None:
    ready = [(runner, found[runner.way.name].get("least")) for runner in runners]
    ready = [(runner, least) for runner, least in ready if least and not runner.failed]
    times: dict[str, list[float]] = {runner.way.name: [] for runner, _ in ready}
    for number in range(repeats):
        for runner, least in ready:
            tell(f"time to {100 * TARGET:g}%, round {number + 1} of {repeats}: {runner.way.name}")
            times[runner.way.name].append(runner.solve_ms(least["iterations"]))
    for runner, least in ready:
        least["ms"] = round(min(times[runner.way.name]), 3)


def _guarded(runner: TableRunner, work: Callable[[], None]) -> None:
    if runner.failed:
        return
    try:
        work()
    except SolverError as error:
        runner.failed = str(error)


def _engine(path: Path, device: str) -> Engine:
    engine = load_core().Engine(path, device=device)
    engine.set_material(MATERIAL)
    return engine
