"""How steady the chart's methods are in motion: a sequence of frames in which light and camera move."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np

from quadgraph_validation.chart.chart_body import CAMERA_DEGREES, MOTION_DEGREES, ChartBody, view_at
from quadgraph_validation.chart.chart_method import MovingMethod
from quadgraph_validation.chart.engine_methods import EngineMethod
from quadgraph_validation.truth import blocks, steadiness
from quadgraph_validation.truth.steadiness import ConvergedFrames

FRAMES = 7  # that are judged; those before them are a method's own affair
MOVEMENTS = ("light", "camera")
_SEEDS = (1, 2)  # of the two estimates of what frames converge to
_STEPS = tuple(range(FRAMES - 1, -1, -1))


class MotionCourse:
    """One scene's light and camera on their way, and which blocks of its first view the body covers all along."""

    def __init__(self, body: ChartBody) -> None:
        self._body = body

    def steadiness(self, method: MovingMethod) -> dict[str, Any]:
        """Flicker, relative, and lag in frames with its standard error, by movement; ready for JSON.

        Raises what the method's frames raise.
        """
        method.begin(self._body, FRAMES)
        frames = self._blocks([method.moving(step) for step in _STEPS])
        halves = [self._at_rest(method, seed) for seed in _SEEDS[: 1 + method.noisy]]
        converged = ConvergedFrames(halves[0], halves[-1])
        behind = steadiness.lag(frames, converged, self._earlier)
        lags = zip(MOVEMENTS, behind.frames, behind.error, strict=True)
        return {
            "flicker": steadiness.flicker(frames, converged),
            "lag": {name: {"frames": float(value), "error": float(error)} for name, value, error in lags},
        }

    def _at_rest(self, method: MovingMethod, seed: int) -> np.ndarray:
        return self._blocks([method.at_rest(step, [step], seed)[0] for step in _STEPS])

    @cached_property
    def _earlier(self) -> list[np.ndarray]:
        """What pictures differ by whose light, and whose camera, is a frame behind: by a solve without any noise, the
        same for all methods.
        """
        seen = self._body.chain.seen
        method = EngineMethod(inter_reflection=seen is not None)
        method.begin(self._body, FRAMES)
        now, light, camera = [], [], []
        for step in _STEPS:
            light += method.at_rest(step + 1, [step], 0)
            found = method.at_rest(step, [step, step + 1], 0)
            now.append(found[0])
            camera.append(found[1])
        present = self._blocks(now)
        return [self._blocks(behind) - present for behind in (light, camera)]

    @cached_property
    def _covered(self) -> np.ndarray:
        views = [view_at(self._body.scene, step) for step in (*_STEPS, FRAMES)]
        return np.logical_and.reduce([blocks.covered(self._body.coverage_from(view)) for view in views])

    def _blocks(self, pictures: Sequence[np.ndarray]) -> np.ndarray:
        """(t, n) means of the covered blocks of pictures, in as many channels as the scene has."""
        channels = range(3 if self._body.scene.coloured else 1)
        return np.array(
            [np.concatenate([blocks.means(picture[..., c])[self._covered] for c in channels]) for picture in pictures]
        )


def conditions() -> dict[str, Any]:
    """What holds for all of it, for the record."""
    return {"frames": FRAMES, "light_turns_degrees": MOTION_DEGREES, "camera_turns_degrees": CAMERA_DEGREES}
