"""What other people's solvers are asked: iterations until a system's error, or its residual, is small enough."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import diags
from scipy.sparse.linalg import cg

from quadgraph.baking.budget.surface_errors import unlit_part
from quadgraph.base.errors import SolverError
from quadgraph_validation.benchmark.algebraic_error import AlgebraicJudge
from quadgraph_validation.benchmark.linear_system import System

_MOST_ITERATIONS = 1000
_EXACT = 1e-12  # relative residual of the solution that errors are measured against

# Runs k iterations from zero on b (n,), calling back with every iterate; returns the last.
Iterate = Callable[[np.ndarray, int, Callable[[np.ndarray], None] | None], np.ndarray]


@dataclass
class History:
    """Residual and squared error of the unlit part, W^2/mm^2, after every iteration in one channel."""

    residual: list[float]
    squared: list[float]


class _EnoughError(Exception):
    """Raised by a callback to end an iteration that would go on."""


class Contest:
    """One system, its exact solution, and how far from it an iterate is. q (m, 3) as the system's right-hand side."""

    def __init__(self, system: System, q: np.ndarray) -> None:
        self.system = system
        self.exact = np.column_stack([self._solve_exactly(c) for c in range(3)])
        self.judge = AlgebraicJudge(
            system.area, unlit_part(system.area, q), system.exitance(self.exact), system.exitance
        )
        weight = system.area[self.judge.unlit]
        self._weight = weight
        self.sizes = (weight[:, None] * self.judge.exitance[self.judge.unlit] ** 2).sum(axis=0)

    def _solve_exactly(self, channel: int) -> np.ndarray:
        matrix, b = self.system.matrices[channel], self.system.b[:, channel]
        x, failed = cg(matrix, b, rtol=_EXACT, M=diags(1 / matrix.diagonal()), maxiter=100_000)
        if failed:
            raise SolverError(f"the exact solution of channel {channel}: not converged to {_EXACT:.0e}")
        return x

    def history(self, iterate: Iterate, b: np.ndarray, channel: int, target: float, residual: float) -> History:
        """Run until the channel has both the target's share of the error and the residual."""
        unlit, truth = self.judge.unlit, self.judge.exitance[:, channel]
        seen = History([], [])

        def watch(x: np.ndarray) -> None:
            found = self.system.exitance(np.asarray(x, np.float64)[:, None])[:, 0]
            seen.squared.append(float(self._weight @ (found - truth)[unlit] ** 2))
            seen.residual.append(self.system.residual(x, channel))
            if seen.squared[-1] <= target**2 * self.sizes[channel] and seen.residual[-1] <= residual:
                raise _EnoughError

        try:
            iterate(b, _MOST_ITERATIONS, watch)
        except _EnoughError:
            return seen
        raise SolverError(f"error {target:g} and residual {residual:.1e} not reached in {_MOST_ITERATIONS} iterations")

    def counts_for_error(self, histories: Sequence[History], target: float) -> list[int]:
        """Iterations per channel that bring the error of all channels to the target: each its own, or all alike."""
        own = [
            1 + next(k for k, squared in enumerate(history.squared) if squared <= target**2 * size)
            for history, size in zip(histories, self.sizes, strict=True)
        ]
        for k in range(1, max(own)):
            squared = sum(history.squared[min(k, len(history.squared)) - 1] for history in histories)
            if squared <= target**2 * self.sizes.sum():
                alike = [min(k, len(history.squared)) for history in histories]
                return min(alike, own, key=sum)
        return own


def counts_for_residual(histories: Sequence[History], residual: float) -> list[int]:
    """Iterations per channel that bring it to the residual."""
    return [1 + next(k for k, r in enumerate(history.residual) if r <= residual) for history in histories]
