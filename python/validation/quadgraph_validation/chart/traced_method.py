"""Path tracing on the chart: Mitsuba by few samples a pixel, also with paths that end after some scatterings."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from quadgraph.base.errors import InputError, SolverError, ToolError
from quadgraph_validation.bodies.scenes import PIXELS, StudyScene, View
from quadgraph_validation.chart.chart_body import MOTION_SHARE, ChartBody, direction_at, strength_at, view_at
from quadgraph_validation.chart.chart_method import SWING, ChartMethod, MethodChain, PreparedMethod, register
from quadgraph_validation.truth import path_tracing
from quadgraph_validation.truth.path_tracing import PathEnds, Tracer
from quadgraph_validation.truth.truth_run import TracedSubject

TRACED = "traced"  # `bake` of what is not baked
CUT = 15  # scatterings: `omni:rtx:rtpt:maxVolumeBounces` of NVIDIA's RTX renderer in real time, unless one changes it
_SAMPLES = (1, 4, 16)  # of a pixel
_MOST_MOVING = 4  # of a pixel, in frames that are judged in motion: further ones take too long
_ROULETTE = 50  # events from which on paths may end by chance: from Mitsuba's 5 on, dense bodies get heavy tails
_AT_REST = 16  # samples of a pixel of PIXELS, in a frame that stands for a converged one
_REFLECTED = 64  # the same of what the surface reflects, which is no noise of the method's
_SEED = 1 << 20  # the first one: the truth's are below
_VIEW = "from here"


@dataclass
class TracedMethod(PreparedMethod):
    """Mitsuba's `volpath` by `samples` a pixel of a frame, its paths ended after `most` scatterings, None for never.

    variant: Mitsuba's, which are programs of their own; shared: pictures at rest, which methods that differ in their
    samples alone share.
    """

    samples: int
    most: int | None = None
    variant: str = path_tracing.SCALAR
    shared: dict[tuple[float, float, int], np.ndarray] = field(default_factory=dict, repr=False)
    _drawn: int = field(default=0, repr=False)
    _step: float = field(default=0.0, repr=False)
    _processor: float = field(default=0.0, repr=False)

    @property
    def family(self) -> str:
        """What all numbers of samples converge to."""
        return "path tracing" + (f", {self.most} scatterings at most" if self.most else "")

    @property
    def name(self) -> str:
        """Family and samples."""
        compiled = "" if self.variant == path_tracing.SCALAR else f" · {self.variant}"
        return f"{self.family} · {self.samples} sample{'s' if self.samples > 1 else ''} a pixel{compiled}"

    @property
    def settings(self) -> dict[str, Any]:
        """Of all methods, and its own: samples and scatterings."""
        equations = {"method": "path-tracing", "model": "transport", "source": "paths", "solver": "volpath"}
        display = {"level": 0, "inter_reflection": True, "radiance": "traced", "cycles": 0, "tolerance": None}
        told = equations | display | {"bake": TRACED, "K": None, "samples": self.samples, "scatterings": self.most}
        told |= {"roulette": _ROULETTE, "variant": self.variant}
        return told | {"runs_on": f"processor (Mitsuba {path_tracing.MITSUBA}); its scene is made untimed"}

    @property
    def moves(self) -> bool:
        """With few samples, in the variant that the truth is made by."""
        return self.samples <= _MOST_MOVING and self.variant == path_tracing.SCALAR

    @property
    def noisy(self) -> bool:
        """Always."""
        return True

    def prepare(self, body: ChartBody) -> None:
        """See that it can be traced: there is nothing to settle; what is compiled draws once. Raises ToolError without
        Mitsuba, or its variant.
        """
        first, self._given = self._given is not body, body
        try:
            path_tracing.load_mitsuba(self.variant)
        except InputError as error:
            raise ToolError(str(error)) from error
        if first and self.variant != path_tracing.SCALAR:
            self.frame(SWING[0])

    def frame(self, step: int) -> dict[str, float]:
        """A picture of the first view; ms that Mitsuba takes, once it has the scene."""
        self._step = step
        ms = self._processor = 0.0
        for channel in self._channels:
            with self._tracer(step, next(iter(self._body.scene.views.values())), channel, self._body.pixels) as tracer:
                start, processor = time.perf_counter(), time.process_time()
                tracer.whole(self.samples, self._seed())
                ms += 1e3 * (time.perf_counter() - start)
                self._processor += time.process_time() - processor
        return {"path tracing": ms}

    @property
    def processor_seconds(self) -> float:
        """Of the same."""
        return self._processor

    def exitance(self) -> np.ndarray:
        """Raises SolverError: it makes pictures alone, and answers no PDE."""
        raise SolverError("path tracing makes pictures, and no exitance of faces")

    def picture(self, view: str) -> np.ndarray:
        """(PIXELS, PIXELS, 3) W/(mm^2 sr), of as many samples as a frame of the same pixels' area has."""
        return self._picture(self._step, self._body.scene.views[view], self._samples_of_a_frame, self._seed())

    def begin(self, body: ChartBody, step: float) -> None:
        """Take the body."""
        self.prepare(body)

    def moving(self, step: float) -> np.ndarray:
        """(PIXELS, PIXELS, 3) W/(mm^2 sr)."""
        view = view_at(self._body.scene, step)
        return self._picture(MOTION_SHARE * step, view, self._samples_of_a_frame, self._seed())

    def at_rest(self, light: float, views: Sequence[float], seed: int) -> list[np.ndarray]:
        """(PIXELS, PIXELS, 3) W/(mm^2 sr) each, by many samples."""
        for step in views:
            if (light, step, seed) not in self.shared:
                view = view_at(self._body.scene, step)
                self.shared[light, step, seed] = self._picture(MOTION_SHARE * light, view, _AT_REST, self._seed())
        return [self.shared[light, step, seed] for step in views]

    @property
    def _samples_of_a_frame(self) -> int:
        return max(round(self.samples * (self._body.pixels / PIXELS) ** 2), 1)

    @property
    def _subject(self) -> TracedSubject:
        assert self._body.original is not None, "offered where it is there alone"
        return self._body.original

    @property
    def _channels(self) -> range:
        return range(len(self._subject.grids))

    def _seed(self) -> int:
        self._drawn += 2
        return _SEED * (1 + self.samples) + (_SEED // 2 if self.most else 0) + self._drawn

    def _picture(self, step: float, view: View, samples: int, seed: int) -> np.ndarray:
        strength = strength_at(self._body.scene, step)
        found = []
        for channel in self._channels:
            with self._tracer(step, view, channel, PIXELS) as tracer:
                found.append(tracer.whole(samples, seed) - tracer.reflected(_REFLECTED, seed + 1))
        return strength * np.stack(found * (3 // len(found)), axis=-1)

    @contextmanager
    def _tracer(self, step: float, view: View, channel: int, pixels: int) -> Iterator[Tracer]:
        found = self._subject
        scene: StudyScene = replace(found.scene, direction=direction_at(found.scene, step), views={_VIEW: view})
        how = (PathEnds(self.most, _ROULETTE), pixels, self.variant)
        with path_tracing.tracer(scene, found.surface, found.grids[channel], _VIEW, *how) as tracer:
            yield tracer


@register
def traced_methods(chain: MethodChain) -> Iterator[ChartMethod]:
    """By a few numbers of samples, each with any number of scatterings and with few, and of the most samples also
    compiled for the processor; where there is a mesh to trace.
    """
    for most in (None, CUT) if chain.original else ():
        at_rest: dict[tuple[float, float, int], np.ndarray] = {}
        yield from (TracedMethod(samples, most, shared=at_rest) for samples in _SAMPLES)
    if chain.original:
        yield TracedMethod(_SAMPLES[-1], variant=path_tracing.COMPILED)
