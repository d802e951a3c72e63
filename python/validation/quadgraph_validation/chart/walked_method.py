"""The engine's own random walks on the chart, plain and guided: the exitance of faces by walks for some time.

They make no pictures: a picture of their exitance as of a diffuser's would have an error of the angle at which light
leaves that no number of walks takes away.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from quadgraph.base.errors import SolverError
from quadgraph.core import load_core
from quadgraph_validation.chart.chart_body import ChartBody
from quadgraph_validation.chart.chart_method import SWING, ChartMethod, MethodChain, register
from quadgraph_validation.chart.engine_methods import EngineMethod

SECONDS = (1.0, 4.0, 16.0)


@dataclass
class WalkedMethod(EngineMethod):
    """The walks that certify a corrected solve, for `seconds`; guided: led by importance."""

    seconds: float = 1.0
    guided: bool = False

    @property
    def family(self) -> str:
        """Plain or guided."""
        return f"random walks, {'guided' if self.guided else 'plain'}"

    @property
    def name(self) -> str:
        """Bake and seconds."""
        return " · ".join([self.family, *self._bake_words, f"{self.seconds:g} s"])

    @property
    def settings(self) -> dict[str, Any]:
        """Its equations are those of transport, and it shows nothing."""
        equations = {"method": "random-walks", "model": "transport", "source": "paths", "solver": "walks"}
        told = super().settings | equations | {"radiance": None, "tolerance": None}
        return told | {"runs_on": "device, by the clock on the wall; of walks alone, without a solve for importance"}

    @property
    def moves(self) -> bool:
        """It knows nothing of frames before."""
        return False

    def prepare(self, body: ChartBody) -> None:
        """Walk for a moment: a first solve compiles shaders and makes room."""
        first, self._given = self._given is not body, body
        if first:
            self._walk(SWING[0], 1e-3)

    def frame(self, step: int) -> dict[str, float]:
        """Walks with the light at a step; ms that they take."""
        return {"random walks": 1e3 * self._walk(step, self.seconds)["seconds"]}

    def exitance(self) -> np.ndarray:
        """(n_f, 3) W/mm^2."""
        return np.asarray(load_core().walked_exitance(self._engine)[0], np.float64)

    def picture(self, view: str) -> np.ndarray:
        """Raises SolverError: it knows what leaves in all directions, and not what leaves towards an eye."""
        raise SolverError("random walks from the light make exitance of faces, and no pictures")

    def _walk(self, step: int, seconds: float) -> dict[str, Any]:
        self._set_light(step, 1.0)
        asked = {"correction": True, "sweeps": 1, "warm": False, "certify": seconds, "guided_walks": self.guided}
        return self._engine.solve(**self._options | asked)["certificate"]


@register
def walked_methods(chain: MethodChain) -> Iterator[ChartMethod]:
    """On the default bake, both kinds by several times."""
    choices = [choice for choice in chain.others if choice.grading is None and choice.cells is None]
    for choice in choices:
        default = WalkedMethod(inter_reflection=True, choice=choice)
        yield from (replace(default, seconds=each, guided=guided) for guided in (False, True) for each in SECONDS)
