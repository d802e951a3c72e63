"""Pictures that converge on the chart: asked for an error, as a user asks for it, and what they state of themselves."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from quadgraph_validation.bodies.scenes import PIXELS
from quadgraph_validation.chart.chart_body import ChartBody
from quadgraph_validation.chart.chart_method import SWING, ChartMethod, MethodChain, register
from quadgraph_validation.chart.engine_methods import EngineMethod

ERRORS = (0.04, 0.02, 0.01)  # asked for
SECONDS = 60.0  # that a picture may take after its first solve


@dataclass
class ConvergingMethod(EngineMethod):
    """A picture that is the mean of solves, until the error that it states is `converge`, or cannot be, or a limit of
    time is there. A frame is a picture from nothing: its solve at rest and all that follow.
    """

    converge: float = 0.01
    _processor: float = field(default=0.0, init=False, repr=False)
    _shown: dict[str, Any] = field(default_factory=dict, init=False, repr=False)

    @property
    def family(self) -> str:
        """What it is, whatever it is asked for."""
        return "converging picture"

    @property
    def name(self) -> str:
        """Bake, and what is asked for."""
        return " · ".join([self.family, *self._bake_words, f"to {100 * self.converge:g}%"])

    @property
    def settings(self) -> dict[str, Any]:
        """As of the engine's methods; sweeps are as many as the engine chooses."""
        told = super().settings | {"sweeps": "auto", "time_limit": SECONDS}
        return told | {"runs_on": "device, by the clock on the wall: all that a user waits for"}

    @property
    def moves(self) -> bool:
        """It begins anew in every frame."""
        return False

    def prepare(self, body: ChartBody) -> None:
        """Solve once: a first solve compiles shaders and makes room."""
        first, self._given = self._given is not body, body
        self._shown.clear()
        if first:
            self._set_light(SWING[0], 1.0)
            self._engine.solve(**self._options)

    def frame(self, step: int) -> dict[str, float]:
        """The first view; ms from the light to the picture."""
        self._shown.clear()
        began, processor = time.perf_counter(), time.process_time()
        self._set_light(step, 1.0)
        self._converged(next(iter(self._body.scene.views)), self._body.pixels)
        self._processor = time.process_time() - processor
        return {"converging picture": 1e3 * (time.perf_counter() - began)}

    @property
    def processor_seconds(self) -> float:
        """All of a frame."""
        return self._processor

    def picture(self, view: str) -> np.ndarray:
        """(PIXELS, PIXELS, 3) W/(mm^2 sr): the one that was timed, where its pixels are parts of these."""
        edge = self._body.pixels if self._body.pixels % PIXELS == 0 else PIXELS
        if view not in self._shown or len(self._shown[view].alpha) != edge:
            self._converged(view, edge)
        found, parts = self._seen(self._shown[view]), edge // PIXELS
        return found.reshape(PIXELS, parts, PIXELS, parts, 3).mean(axis=(1, 3))

    def stated(self) -> dict[str, Any]:
        """Of each view its error by parts, the solves that it is the mean of, the sweeps of each, and why it ended."""
        weight = {view: float((self._seen(found) ** 2).sum()) for view, found in self._shown.items()}
        square = sum(weight[view] * found.error["whole"] ** 2 for view, found in self._shown.items())
        views = {view: _told(found) for view, found in self._shown.items()}
        return {"whole": float(np.sqrt(square / sum(weight.values()))), "views": views}

    @property
    def _options(self) -> dict[str, Any]:
        return super()._options | {"correction": True, "warm": False}

    def _converged(self, view: str, pixels: int) -> None:
        self._engine.solve(**self._options)
        asked = {"converge": self.converge, "time_limit": SECONDS}
        self._shown[view] = self._show(self._body.scene.views[view].text, pixels, **asked)


def _told(found: Any) -> dict[str, Any]:
    told = found.convergence
    last = {name: told["steps"][-1][name] for name in ("solves", "sweeps", "seconds", "noise")}
    return {"error": found.error, **last, "reached": told["reached"], "limit": told["limit"]}


@register
def converging_methods(chain: MethodChain) -> Iterator[ChartMethod]:
    """On the default bake, to several errors."""
    choices = [choice for choice in chain.others if choice.grading is None and choice.cells is None]
    for choice in choices:
        yield from (ConvergingMethod(inter_reflection=True, choice=choice, converge=error) for error in ERRORS)
