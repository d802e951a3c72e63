"""The error of a solution of the linear system, as it shows on the surface."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from quadgraph.baking.budget.surface_errors import unlit_part
from quadgraph.base.errors import SolverError
from quadgraph.base.relative_error import relative_rms

if TYPE_CHECKING:
    from quadgraph.core import Engine

_TRUTH_TOLERANCE = 1e-6  # asked for; single precision may stall a little before
_TRUTH_RESIDUAL = 1e-5  # demanded; leaves an error of the unlit part of some 1e-5
_TRUTH_ITERATIONS = 100_000


@dataclass(frozen=True)
class AlgebraicJudge:
    """Area (n,) mm^2 and exitance (n, 3) W/mm^2 of the exact solution at the outside faces; unlit (n,) bool."""

    area: np.ndarray
    unlit: np.ndarray
    exitance: np.ndarray
    # From fluence (n, 3) at the vertices to exitance, where the truth is not made even; None: as it is shown.
    of_phi: Callable[[np.ndarray], np.ndarray] | None = None

    def error_of(self, engine: Engine) -> dict[str, float]:
        """That of what an engine solved last, as `error`."""
        if self.of_phi is None:
            return self.error(engine.surface_field()["exitance"])
        return self.error(self.of_phi(np.asarray(engine.phi(), np.float64)))

    def error(self, exitance: np.ndarray) -> dict[str, float]:
        """Relative RMS over area of the difference to the truth, channels together: "whole" surface, "unlit" part."""
        weights = {"whole": self.area, "unlit": self.area * self.unlit}
        return {part: relative_rms(weight, exitance - self.exitance, self.exitance) for part, weight in weights.items()}


def judge(engine: Engine, **way: Any) -> AlgebraicJudge:
    """Solve the same system far beyond what is asked of the solvers; `way` as for Engine.solve, less the solver.

    Raises SolverError if that does not converge.
    """
    report = engine.solve(
        **way, solver="dpcg", tolerance=_TRUTH_TOLERANCE, max_iterations=_TRUTH_ITERATIONS, inter_reflection=False
    )
    residual = report["levels"][-1]["residual"]
    if residual > _TRUTH_RESIDUAL:
        raise SolverError(f"the exact solution: residual {residual:.1e} found, {_TRUTH_RESIDUAL:.0e} wanted")
    field = engine.surface_field()
    area = np.asarray(field["area"], np.float64)
    return AlgebraicJudge(area, unlit_part(area, field["q"]), np.asarray(field["exitance"], np.float64))
