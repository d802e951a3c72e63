"""The chart's measurements: methods settle in turn, round after round, and each draws its frames of a moving light."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from statistics import median
from typing import Any

import numpy as np

from quadgraph.base.errors import SolverError, ToolError
from quadgraph.base.progress import ProgressCallback
from quadgraph_validation.chart import motion_measure
from quadgraph_validation.chart.chart_body import MOTION_DEGREES, STEP_DEGREES, STEP_SHARE, ChartBody
from quadgraph_validation.chart.chart_judge import ChartJudge
from quadgraph_validation.chart.chart_method import (
    SETTLED,
    SWING,
    ChartMethod,
    ClockedMethod,
    MovingMethod,
    StatingMethod,
    bake_settings,
)
from quadgraph_validation.chart.motion_measure import MotionCourse
from quadgraph_validation.truth.path_tracing import BATCH

# What a frame consists of, by the passes of the engine and of others; the rest is the solver's.
STAGES = {
    "light": ("shadow maps", "irradiance", "path light"),
    "source": ("source walk", "surface share", "right-hand side"),
    "exitance": ("exitance", "energy", "path field"),
    "picture": (
        *("gather points", "uncollided", "gathered exitance", "gather scale", "visibility", "coverage", "shading"),
        *("gather", "surface", "resolve"),
        "path tracing",
        "converging picture",
    ),
}


@dataclass
class ChartPoint:
    """A method, the passes of all its frames in ms, processor seconds of those that say them, its errors and pictures,
    what it states of these itself (None: nothing), how steady it is in motion (None: not judged so), or why there are
    none.
    """

    method: ChartMethod
    frames: list[dict[str, float]] = field(default_factory=list)
    processor: list[float] = field(default_factory=list)
    errors: dict[str, dict[str, float] | None] = field(default_factory=dict)
    pictures: dict[str, np.ndarray] = field(default_factory=dict)
    stated: dict[str, Any] | None = None
    motion: dict[str, Any] | None = None
    failed: str = ""

    def record(self) -> dict[str, Any]:
        """Ready for JSON: ms of the median frame, and by stage and pass the medians over all frames."""
        told = {"name": self.method.name, "family": self.method.family, "settings": self.method.settings}
        if self.failed:
            return told | {"failed": self.failed}
        passes = {name: median(frame.get(name, 0.0) for frame in self.frames) for name in self.frames[0]}
        whole = [sum(frame.values()) for frame in self.frames]
        return told | {
            "ms": round(median(whole), 4),
            "ms_range": [round(min(whole), 4), round(max(whole), 4)],
            "processor_s": round(median(self.processor), 4) if self.processor else None,
            "stages": {name: round(ms, 4) for name, ms in stages(passes).items()},
            "passes": {name: round(ms, 4) for name, ms in passes.items()},
            "errors": self.errors,
            "stated": self.stated,
            "motion": self.motion,
        }


def stages(passes: dict[str, float]) -> dict[str, float]:
    """Time by stage of a frame, ms."""
    stage_of = {name: stage for stage, names in STAGES.items() for name in names}
    spent = dict.fromkeys(("light", "source", "solve", "exitance", "picture"), 0.0)
    for name, ms in passes.items():
        spent[stage_of.get(name, "solve")] += ms
    return spent


def measure(
    body: ChartBody, judge: ChartJudge, methods: Sequence[ChartMethod], repeats: int, tell: ProgressCallback
) -> list[ChartPoint]:
    """Every method's point. Rounds alternate between all methods, so that a slower minute slows them all."""
    tell(f"{body.scene.name}: truth")
    judge.noise()  # what is unlit is found on an engine that methods share: before they do
    points = [ChartPoint(method) for method in methods]
    for number in range(repeats):
        for index, point in enumerate(points):
            progress = f"round {number + 1} of {repeats}, method {index + 1} of {len(points)}"
            tell(f"{body.scene.name}: {progress}: {point.method.name}")
            if not point.failed:
                _round(body, judge, point)
    if body.original is not None:
        _in_motion(body, points, tell)
    return points


def _in_motion(body: ChartBody, points: Sequence[ChartPoint], tell: ProgressCallback) -> None:
    """Judge what moves, after all times: what frames converge to takes long."""
    course = MotionCourse(body)
    done = [(point, point.method) for point in points if not point.failed]
    moving = [(point, method) for point, method in done if isinstance(method, MovingMethod) and method.moves]
    for number, (point, method) in enumerate(moving):
        tell(f"{body.scene.name}: in motion, method {number + 1} of {len(moving)}: {method.name}")
        try:
            point.motion = course.steadiness(method)
        except (SolverError, ToolError) as error:
            point.failed = str(error)


def _round(body: ChartBody, judge: ChartJudge, point: ChartPoint) -> None:
    try:
        point.method.prepare(body)
        for step in SWING[1:]:
            point.frames.append(point.method.frame(step))
            point.processor += [point.method.processor_seconds] if isinstance(point.method, ClockedMethod) else []
        if not point.errors:
            shown = body.scene.views if point.method.settings["radiance"] else ()
            point.pictures = {view: point.method.picture(view) for view in shown}
            point.errors = judge.errors(point.method, point.pictures)
            point.stated = point.method.stated() if isinstance(point.method, StatingMethod) else None
    except (SolverError, ToolError) as error:
        point.failed = str(error)


def scene_record(body: ChartBody, judge: ChartJudge, points: Sequence[ChartPoint]) -> dict[str, Any]:
    """One scene of the record."""
    samples = {name: image.batches * BATCH for name, image in judge.images.items()}
    return {
        "name": body.scene.name,
        "mesh": body.scene.mesh,
        "height_mm": body.scene.height,
        "eta": body.scene.eta,
        "light": body.scene.light,
        "levels": body.levels(),
        "bakes": _bakes(body, points),
        "truth": judge.noise() | {"samples": samples},
        "points": [point.record() for point in points],
    }


def _bakes(body: ChartBody, points: Sequence[ChartPoint]) -> list[dict[str, Any]]:
    """Levels of the chains other than the truth's that points were measured on."""
    used = [point.method.settings for point in points if not point.failed]
    ways = [(bake_settings(choice), choice) for choice in body.others]
    return [
        told | {"levels": body.levels(choice)}
        for told, choice in ways
        if any(told.items() <= settings.items() for settings in used)
    ]


def conditions(repeats: int, pixels: int) -> dict[str, Any]:
    """What holds for all points of a scene, for the record."""
    frame = {"pixels": pixels, "light_turns_degrees": STEP_DEGREES, "even_light_dims": STEP_SHARE}
    frame |= {"light_turns_degrees_in_motion": MOTION_DEGREES}
    return {"repeats": repeats, "settled": SETTLED, "frame": frame, "motion": motion_measure.conditions()}
