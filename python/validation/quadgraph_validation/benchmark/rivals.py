"""Other people's solvers on the identical matrix and right-hand side, in the same run: SciPy's conjugate gradients and
PyAMG's smoothed aggregation.

All start from zero and get exactly the iterations that bring them, in each channel, to the residual of our solution or
to its error; finding that number is not timed. The channels run one after the other and on as many threads as there
are cores, and the faster counts.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from statistics import median
from typing import Any

import numpy as np
from scipy.sparse import csr_matrix, diags
from scipy.sparse.linalg import cg

from quadgraph.base.errors import SolverError
from quadgraph.base.progress import ProgressCallback
from quadgraph_validation.base import extra_module
from quadgraph_validation.benchmark import figures
from quadgraph_validation.benchmark import linear_system as systems
from quadgraph_validation.benchmark.bench_scene import DIRECTION, BenchScene, Device
from quadgraph_validation.benchmark.contest import Contest, Iterate, counts_for_residual
from quadgraph_validation.benchmark.linear_system import System
from quadgraph_validation.benchmark.solver_convergence import (
    DIAGONAL,
    OURS,
    TARGETS,
    CurvePoint,
    SolverRunner,
    SolverWay,
)


@dataclass(frozen=True)
class Rival:
    """A solver by name, and how it is set up for one matrix."""

    name: str
    set_up: Callable[[csr_matrix], Iterate]
    precision: type = np.float64


def _scipy(preconditioned: bool) -> Callable[[csr_matrix], Iterate]:
    def set_up(matrix: csr_matrix) -> Iterate:
        scaling = diags(1 / matrix.diagonal()).astype(matrix.dtype) if preconditioned else None

        def iterate(b: np.ndarray, count: int, callback: Callable | None = None) -> np.ndarray:
            return cg(matrix, b, rtol=0, atol=0, maxiter=count, M=scaling, callback=callback)[0]

        return iterate

    return set_up


def _pyamg(accelerated: bool) -> Callable[[csr_matrix], Iterate]:
    def set_up(matrix: csr_matrix) -> Iterate:
        hierarchy = load_pyamg().smoothed_aggregation_solver(matrix)

        def iterate(b: np.ndarray, count: int, callback: Callable | None = None) -> np.ndarray:
            accel = "cg" if accelerated else None
            return hierarchy.solve(b, tol=1e-30, maxiter=count, accel=accel, callback=callback)

        return iterate

    return set_up


RIVALS = (
    Rival("SciPy CG", _scipy(False)),
    Rival("SciPy CG, diagonal", _scipy(True)),
    Rival("SciPy CG, diagonal, single precision", _scipy(True), np.float32),
    Rival("PyAMG", _pyamg(False)),
    Rival("PyAMG + CG", _pyamg(True)),
    Rival("PyAMG + CG, single precision", _pyamg(True), np.float32),
)


def load_pyamg() -> Any:
    """Import PyAMG. Raises InputError if it is absent."""
    return extra_module.load("pyamg", "bench")


class Entrant:
    """A rival set up for all three channels."""

    def __init__(self, rival: Rival, system: System) -> None:
        self.rival = rival
        matrices = [matrix.astype(rival.precision) for matrix in system.matrices]
        self.b: np.ndarray = system.b.T.astype(rival.precision)
        start = time.perf_counter()
        self.iterates = [rival.set_up(matrix) for matrix in matrices]
        self.set_up_ms = 1e3 * (time.perf_counter() - start)

    def solve(self, counts: Sequence[int]) -> np.ndarray:
        """All channels in turn; x (n, 3)."""
        return np.column_stack(
            [iterate(b, k, None) for iterate, b, k in zip(self.iterates, self.b, counts, strict=True)]
        )

    def time_ms(self, counts: Sequence[int]) -> float:
        """Time of a solve, channels in turn or on threads, whichever is faster; after one that is not timed."""
        self.solve(counts)
        start = time.perf_counter()
        self.solve(counts)
        in_turn = time.perf_counter() - start
        start = time.perf_counter()
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(lambda iterate, b, k: iterate(b, k, None), self.iterates, self.b, counts))
        return 1e3 * min(in_turn, time.perf_counter() - start)


def run(
    scene: BenchScene,
    device: Device,
    repeats: int,
    tell: ProgressCallback,
    ways: Sequence[SolverWay] = (OURS, DIAGONAL),
) -> dict[str, Any]:
    """Our solvers by `ways` and the rivals, each to the targets of convergence.py; times are medians of `repeats`.

    Raises InputError if PyAMG is absent, SolverError if somebody does not converge.
    """
    load_pyamg()
    engine = device.open(scene.path, scene.material, scene.lights)
    q = systems.give_irradiance(engine, DIRECTION)
    tell(f"{scene.name}: the system and its exact solution")
    contest = Contest(systems.assemble(engine.graph, scene.material, q, DIRECTION), q)
    runners = []
    for way in ways:
        runners.append(SolverRunner(engine, way, contest.judge))
        tell(f"{scene.name}: {way.label}")
        runners[-1].explore()
    entrants = []
    for rival in RIVALS:
        tell(f"{scene.name}: {rival.name}, set-up")
        entrants.append(Entrant(rival, contest.system))
    last = runners[0].front()[-1]
    runners[0].time(last)
    agreement = contest.judge.error_of(engine)
    return {
        "name": scene.name,
        "material": scene.material,
        "unknowns": len(contest.exact),
        "entries": contest.system.matrices[0].nnz,
        "repeats": repeats,
        "agreement": agreement,
        "set_up_ms": {entrant.rival.name: entrant.set_up_ms for entrant in entrants},
        "targets": [_to_target(target, contest, runners, entrants, repeats, tell) for target in TARGETS],
    }


def _to_target(
    target: float,
    contest: Contest,
    runners: Sequence[SolverRunner],
    entrants: Sequence[Entrant],
    repeats: int,
    tell: ProgressCallback,
) -> dict[str, Any]:
    """Everybody to the same error, and the rivals to the residual that our first solver then has."""
    points = [_reached(runner, target) for runner in runners]
    counts = [iterations_wanted(contest, entrant, target, points[0].residual) for entrant in entrants]
    times: list[dict[str, list[float]]] = [{goal: [] for goal in found} for found in counts]
    for number in range(repeats):
        tell(f"error {target:g}: round {number + 1} of {repeats}")
        for runner, point in zip(runners, points, strict=True):
            runner.time(point)
        for entrant, found, kept in zip(entrants, counts, times, strict=True):
            for goal, iterations in found.items():
                kept[goal].append(entrant.time_ms(iterations))
    return {
        "unlit": target,
        "residual": points[0].residual,
        "ours": {runner.way.label: point.record() for runner, point in zip(runners, points, strict=True)},
        "rivals": {
            entrant.rival.name: {
                goal: {"iterations": found[goal], "time_ms": median(kept[goal]), "time": figures.times(kept[goal])}
                for goal in ("error", "residual")
            }
            for entrant, found, kept in zip(entrants, counts, times, strict=True)
        },
    }


def _reached(runner: SolverRunner, target: float) -> CurvePoint:
    point = runner.reaching(target)
    if point is None:
        raise SolverError(f"{runner.way.label}: error {target:g} not reached")
    return point


def iterations_wanted(contest: Contest, entrant: Entrant, target: float, residual: float) -> dict[str, list[int]]:
    """Iterations per channel that reach an "error" of the unlit part, and a "residual". Raises SolverError."""
    histories = [
        contest.history(iterate, b, channel, target, residual)
        for channel, (iterate, b) in enumerate(zip(entrant.iterates, entrant.b, strict=True))
    ]
    return {
        "error": contest.counts_for_error(histories, target),
        "residual": counts_for_residual(histories, residual),
    }
