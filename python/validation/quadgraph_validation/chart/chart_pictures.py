"""Pictures of a few methods beside path tracing, with differences and scan lines (accuracy/scene_figures.py)."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from quadgraph_validation.accuracy import scene_figures
from quadgraph_validation.accuracy.scenes_study import ScenesCompared
from quadgraph_validation.chart.chart_judge import ChartJudge
from quadgraph_validation.chart.chart_measure import ChartPoint
from quadgraph_validation.chart.traced_method import CUT, TRACED

# Title to the family whose picture is shown, of all its points the one that is closest; None: of all families that do
# not trace paths.
SHOWN = {
    "published": "quadgraph-fdm, as published",
    "ours": None,
    "dipole": "dipole per vertex",
    f"{CUT} scatterings": f"path tracing, {CUT} scatterings at most",
}


def write(folder: Path, judge: ChartJudge, points: Sequence[ChartPoint]) -> list[Path]:
    """Draw pictures-SCENE.png with those of SHOWN that were measured; nothing without path-traced pictures.

    Raises InputError without matplotlib.
    """
    closest = {title: _closest(points, family) for title, family in SHOWN.items()}
    chosen = {title: point for title, point in closest.items() if point is not None}
    if not (judge.images and chosen):
        return []
    compared = {}
    for name, image in judge.images.items():
        pictures = {title: judge.of_picture(name, point.pictures) for title, point in chosen.items()}
        compared[name] = ScenesCompared(image, judge.body.coverage(judge.body.scene.images[name].view), pictures)
    path = folder / f"pictures-{judge.body.scene.name}.png"
    scene_figures.write(path, judge.body.scene, compared, {title: title for title in chosen})
    return [path]


def _closest(points: Sequence[ChartPoint], family: str | None) -> ChartPoint | None:
    known = [
        (errors["whole"], number)
        for number, point in enumerate(points)
        if (errors := point.errors.get("transport")) and _is_of(point, family)
    ]
    return points[min(known)[1]] if known else None


def _is_of(point: ChartPoint, family: str | None) -> bool:
    return point.method.settings["bake"] != TRACED if family is None else point.method.family == family
