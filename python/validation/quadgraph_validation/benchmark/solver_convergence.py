"""Error against work and against time of every solver: curves, and the least that reaches a given error.

Work is counted in applications of the finest operator, products on all levels by their entries (SolveReport). Every
solver is run with 1, 2, 3, 5, ... iterations on the finest level, and the least number that reaches a target is
found exactly, by bisection. Where coarser levels are solved first, each to a tolerance, that is free: all of
COARSE_TOLERANCES are tried, and the best counts.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from statistics import median
from typing import TYPE_CHECKING, Any

from quadgraph.base.errors import SolverError
from quadgraph.base.progress import ProgressCallback
from quadgraph_validation.benchmark import figures
from quadgraph_validation.benchmark.algebraic_error import AlgebraicJudge, judge
from quadgraph_validation.benchmark.bench_scene import BenchScene, Device
from quadgraph_validation.benchmark.frame_passes import PICTURE_PASSES

if TYPE_CHECKING:
    from quadgraph.core import Engine

TARGETS = (0.01, 0.001)  # error of the unlit part
END = 5e-4  # where a curve ends
MOST_ITERATIONS = 1600  # on the finest level; a solver that needs more is cut off there
COARSE_TOLERANCES = (0.03, 0.01, 0.1)

_LADDER = (1, 2, 3, 5, 8, 13, 21, 34, 55, 89, 144, 233, 377, 610, 987, 1597)


@dataclass(frozen=True)
class SolverWay:
    """A solver and what it solves, in the words of Engine.solve."""

    solver: str
    method: str = "fem"
    source: str = "buried"
    coarse_tolerances: tuple[float, ...] = (1e-3,)
    name: str = ""
    model: str = "diffusion"

    @property
    def label(self) -> str:
        """For tables and charts."""
        return self.name or self.solver

    @property
    def system(self) -> dict[str, Any]:
        """What is solved, apart from how."""
        return {"method": self.method, "source": self.source, "model": self.model}


PUBLISHED = SolverWay("cascade", "quadgraph-fdm", "diffuse", COARSE_TOLERANCES, "published")
OURS = SolverWay("fmg-pcg")
DIAGONAL = SolverWay("dpcg", coarse_tolerances=COARSE_TOLERANCES)
WAYS = (
    OURS,
    SolverWay("vcycle"),
    DIAGONAL,
    SolverWay("cascade", coarse_tolerances=COARSE_TOLERANCES),
    SolverWay("jacobi"),
    PUBLISHED,
)


@dataclass
class CurvePoint:
    """One solve: iterations on the finest level after coarser ones to `tolerance`; what came out; times of all repeats.

    residual: sqrt(r^T D^-1 r / b^T D^-1 b) of the worst channel.
    """

    iterations: int
    tolerance: float
    work: float
    residual: float
    whole: float
    unlit: float
    time_ms: list[float] = field(default_factory=list)
    wall_ms: list[float] = field(default_factory=list)

    def record(self) -> dict[str, float]:
        """The figures as plain values, times as medians: `time_ms` on the device's clock, `wall_ms` of the whole call.

        `time` and `wall` are the same as figures.
        """
        medians = {"time_ms": median(self.time_ms), "wall_ms": median(self.wall_ms)}
        return vars(self) | medians | self.timed()

    def timed(self) -> dict[str, figures.Figure]:
        """The times of all repeats."""
        return {"time": figures.times(self.time_ms), "wall": figures.times(self.wall_ms)}


class SolverRunner:
    """Runs one way on one engine; remembers every point it has seen."""

    def __init__(self, engine: Engine, way: SolverWay, judged: AlgebraicJudge) -> None:
        self.way = way
        self._engine = engine
        self._judge = judged
        self._points: dict[tuple[int, float], CurvePoint] = {}

    def at(self, iterations: int, tolerance: float) -> CurvePoint:
        """The point, run once if it is new."""
        key = (iterations, tolerance)
        if key not in self._points:
            report, _ = self._solve(*key)
            error = self._judge.error_of(self._engine)
            residual = report["levels"][-1]["residual"]
            self._points[key] = CurvePoint(*key, report["work"], residual, error["whole"], error["unlit"])
        return self._points[key]

    def time(self, point: CurvePoint) -> None:
        """Run a point again and keep its times.

        A run before it, whose time is not kept, takes back the caches from whom was timed last: in a window solves
        follow each other.
        """
        self._solve(point.iterations, point.tolerance)
        _, wall_ms = self._solve(point.iterations, point.tolerance)
        point.wall_ms.append(wall_ms)
        passes = [p for p in self._engine.passes if p["name"] not in PICTURE_PASSES]
        point.time_ms.append(sum(p["time_ms"] for p in passes))

    def reaching(self, target: float) -> CurvePoint | None:
        """The point of least work whose error of the unlit part is no larger."""
        return next((point for point in self.front() if point.unlit <= target), None)

    def front(self) -> list[CurvePoint]:
        """Points that none other beats in both work and error of the unlit part, by growing work."""
        chosen: list[CurvePoint] = []
        for point in sorted(self._points.values(), key=lambda p: (p.work, p.unlit)):
            if not chosen or point.unlit < chosen[-1].unlit:
                chosen.append(point)
        return chosen

    def curve(self) -> list[CurvePoint]:
        """What is worth timing: the front without what bisection tried on the way."""
        wanted = [self.reaching(target) for target in TARGETS]
        return [point for point in self.front() if point.iterations in _LADDER or point in wanted]

    def explore(self) -> None:
        """Run the ladder of iterations and, between its rungs, look for the least that reach the targets.

        A tolerance of the coarser levels is given up where another has already arrived with less work.
        """
        for tolerance in self.way.coarse_tolerances:
            rungs = self._climb(tolerance)
            for target in TARGETS:
                self._bisect(rungs, tolerance, target)

    def _climb(self, tolerance: float) -> list[CurvePoint]:
        rungs: list[CurvePoint] = []
        for iterations in _LADDER:
            arrived = self.reaching(END)
            if iterations > MOST_ITERATIONS or (rungs and arrived and rungs[-1].work >= arrived.work):
                break
            rungs.append(self.at(iterations, tolerance))
            if rungs[-1].unlit <= END:
                break
        return rungs

    def _bisect(self, rungs: list[CurvePoint], tolerance: float, target: float) -> None:
        reached = next((i for i, point in enumerate(rungs) if point.unlit <= target), 0)
        low, high = (rungs[reached - 1], rungs[reached]) if reached else (rungs[0], rungs[0])
        while high.iterations - low.iterations > 1:
            best = self.reaching(target)
            if best is None or low.work >= best.work:
                break
            middle = self.at((low.iterations + high.iterations) // 2, tolerance)
            low, high = (low, middle) if middle.unlit <= target else (middle, high)

    def _solve(self, iterations: int, tolerance: float) -> tuple[dict, float]:
        start = time.perf_counter()
        report = self._engine.solve(
            **self.way.system,
            solver=self.way.solver,
            cycles=iterations,
            tolerance=tolerance,
            inter_reflection=False,
        )
        wall_ms = 1e3 * (time.perf_counter() - start)
        if report["replaced"]:
            raise SolverError(f"{self.way.label}: {report['replaced']}")
        return report, wall_ms


def run(
    scene: BenchScene, device: Device, repeats: int, tell: ProgressCallback, ways: tuple[SolverWay, ...] = WAYS
) -> dict[str, Any]:
    """Curves and targets of every way on a scene; times are medians of `repeats` rounds over all of them in turn.

    Each system has an engine of its own, so that no solve assembles. Raises InputError, SolverError.
    """
    engines: dict[tuple, tuple[Engine, AlgebraicJudge]] = {}
    runners = []
    for way in ways:
        key = tuple(way.system.values())
        if key not in engines:
            engine = device.open(scene.path, scene.material, scene.lights)
            engines[key] = engine, judge(engine, **way.system)
        runners.append(SolverRunner(engines[key][0], way, engines[key][1]))
    for runner in runners:
        tell(f"{scene.name}: {runner.way.label}")
        runner.explore()
    for number in range(repeats):
        tell(f"{scene.name}: times, round {number + 1} of {repeats}")
        for runner in runners:
            for point in runner.curve():
                runner.time(point)
    level = runners[0]._engine.graph.levels[0]
    return {
        "name": scene.name,
        "material": scene.material,
        "lights": scene.lights,
        "vertices": len(level.vertices),
        "tets": len(level.tets),
        "repeats": repeats,
        "ways": [_entry(runner) for runner in runners],
    }


def _entry(runner: SolverRunner) -> dict[str, Any]:
    reached = [(target, runner.reaching(target)) for target in TARGETS]
    return {"name": runner.way.label, "solver": runner.way.solver, **runner.way.system} | {
        "points": [point.record() for point in runner.curve()],
        "targets": [{"unlit": target, "reached": point and point.record()} for target, point in reached],
    }
