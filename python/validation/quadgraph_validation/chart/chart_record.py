"""The chart's record: scenes, each measured in one run, and all that the drawings are made from."""

from __future__ import annotations

import json
from dataclasses import dataclass
from math import log
from pathlib import Path
from typing import Any

from quadgraph.base.errors import InputError
from quadgraph_validation.chart.pareto import front

FORMAT = 3
PARTS = ("whole", "unlit")
TRUTHS = {
    "pde": "PDE truth: error of mesh and solver",
    "transport": "path tracing: error of the picture",
    "walks": "random walks: error of the exitance of patches",
}
_OF_EXITANCE = ("pde", "walks")  # truths that no picture enters
MOTION = "motion"  # in place of a truth, for what flickers
_NEEDED = ("format", "scenes")


@dataclass(frozen=True)
class Panel:
    """The points of a scene that have an error against one truth over one part, by time, and which make the front; or
    flicker in motion, beside no truth.

    times: ms of a frame, for truths of the exitance without its picture, which does not enter; noise: of the truth,
    relative; the largest of the PDE truths'.
    """

    truth: str
    part: str
    points: list[dict[str, Any]]
    times: list[float]
    errors: list[float]
    front: list[int]
    noise: float

    @property
    def title(self) -> str:
        """In words."""
        if self.truth == MOTION:
            return "in motion: flicker, of converged frames"
        return f"{TRUTHS[self.truth]}, {'whole' if self.part == 'whole' else 'unlit part'}"

    @property
    def stated(self) -> list[float]:
        """Of each point the error that it states itself, its error here where it states none of what is shown."""
        shown = self.truth == "transport" and self.part == PARTS[0]
        told = (stated(point) if shown else None for point in self.points)
        return [error if own is None else own for own, error in zip(told, self.errors, strict=True)]

    @property
    def time_words(self) -> str:
        """What the times are of."""
        return "ms a frame without its picture" if self.truth in _OF_EXITANCE else "ms a frame"


def panels(scene: dict[str, Any]) -> list[Panel]:
    """Those of a scene that have any points: truth by truth, the whole first, and last what flickers."""
    found = [*(_panel(scene, truth, part) for truth in TRUTHS for part in PARTS), _flicker_panel(scene)]
    return [panel for panel in found if panel.points]


def _flicker_panel(scene: dict[str, Any]) -> Panel:
    moving = [point for point in scene["points"] if (point.get("motion") or {}).get("flicker")]
    points = sorted(moving, key=lambda point: point["ms"])
    times = [point["ms"] for point in points]
    flickers = [point["motion"]["flicker"] for point in points]
    return Panel(MOTION, PARTS[0], points, times, flickers, front(list(zip(times, flickers, strict=True))), 0.0)


def _panel(scene: dict[str, Any], truth: str, part: str) -> Panel:
    done = [point for point in scene["points"] if not point.get("failed")]
    if truth in _OF_EXITANCE:
        done = [point for point in done if kind(point) != "lambertian"]
    points = [point for point in done if part in errors_of(point, truth)]
    points = sorted(points, key=lambda point: _time(point, truth))
    times = [_time(point, truth) for point in points]
    errors = [errors_of(point, truth)[part] for point in points]
    noise = scene["truth"].get(truth, {})
    levels = [of.get(part, 0.0) for of in noise.values()] if truth == "pde" else [noise.get(part, 0.0)]
    best = front(list(zip(times, errors, strict=True)))
    return Panel(truth, part, points, times, errors, best, max(levels, default=0.0))


def _time(point: dict[str, Any], truth: str) -> float:
    return without_picture(point) if truth in _OF_EXITANCE else point["ms"]


def errors_of(point: dict[str, Any], truth: str) -> dict[str, float]:
    """A point's errors against a truth by part; none where that did not judge it."""
    return point["errors"].get(truth) or {}


def stated(point: dict[str, Any]) -> float | None:
    """The error of the picture that a point states itself, None of one that states none."""
    return told["whole"] if (told := point.get("stated")) else None


def without_picture(point: dict[str, Any]) -> float:
    """Time of a frame until the exitance is known, ms."""
    return sum(ms for stage, ms in point["stages"].items() if stage != "picture")


def flicker_text(point: dict[str, Any]) -> str:
    """How much a point's frames flicker in motion, of converged ones; empty if it was not judged so."""
    motion = point.get("motion")
    return f"{100 * motion['flicker']:.2g}%" if motion else ""


def lag_text(point: dict[str, Any]) -> str:
    """By how many frames a point's pictures are behind light and camera, with standard errors; empty as above."""
    motion = point.get("motion")
    lags = (motion["lag"][name] for name in ("light", "camera")) if motion else ()
    return " / ".join(f"{lag['frames']:.2f} ± {lag['error']:.2f}" for lag in lags)


def families(record: dict[str, Any]) -> list[str]:
    """All families, in the order of their first points."""
    return list(dict.fromkeys(point["family"] for scene in record["scenes"] for point in scene["points"]))


def read(path: Path) -> dict[str, Any]:
    """Read a record. Raises InputError, naming file and field, if it is not one that can be drawn."""
    try:
        record = json.loads(path.read_text())
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read as JSON: {error}") from error
    missing = [key for key in _NEEDED if not isinstance(record, dict) or key not in record]
    if missing:
        raise InputError(f"{path}: {missing[0]}: not there; `quadgraph chart --json` writes a record")
    if record["format"] != FORMAT:
        raise InputError(f"{path}: format: {record['format']!r} found, {FORMAT} allowed")
    try:
        for scene in record["scenes"]:
            panels(scene)
            run_text(scene)
        families(record)
    except (KeyError, TypeError, AttributeError) as error:
        raise InputError(f"{path}: scenes: {type(error).__name__} of {error}, which a record has") from error
    return record


def added(record: dict[str, Any], more: dict[str, Any]) -> dict[str, Any]:
    """A record with the scenes of another, which replace those of the same name.

    Times are compared within a scene alone, and each scene is of one run: so nothing is mixed.
    """
    scenes = {scene["name"]: scene for scene in (*record["scenes"], *more["scenes"])}
    return record | {"scenes": list(scenes.values())}


# What labels leave out: what is the default, or clear from the rest.
_USUAL = (" · fmg-pcg", " · numpy", " a frame", "fem, ")
_PUBLISHED = (", as published", " · cascade")  # together


def short(point: dict[str, Any]) -> str:
    """A point's name for a label: without what is usual."""
    name = point["name"]
    elsewhere: tuple[str, ...] = () if point["settings"]["bake"] == "chain" else (" · level 0",)
    elsewhere += (" · polygrid",) if name.startswith("polygrid") else ()
    for usual in (*_USUAL, *elsewhere, *(_PUBLISHED if all(part in name for part in _PUBLISHED) else ())):
        name = name.replace(usual, "")
    return name.replace(" · ", ", ")


def kind(point: dict[str, Any]) -> str:
    """What a point is a variation of its family in: one of KINDS."""
    settings = point["settings"]
    if settings.get("converge"):
        return "converging"
    if settings.get("seconds"):
        return "walks"
    if settings["bake"] != "chain":  # path tracing, too, which bakes nothing
        return settings["bake"]
    if settings.get("cycles"):
        return "cycles"
    if "Lambertian" in point["name"]:
        return "lambertian"
    other = settings.get("method") == "fem" and settings.get("solver") != "fmg-pcg"
    return "solver" if other else "settled"


def coarseness(point: dict[str, Any]) -> float:
    """By how much its mesh is coarser than others of its series: the level; of the paper's meshes the base-3 logarithm
    of K / 0.3.
    """
    settings = point["settings"]
    return settings["level"] + (log(settings["K"] / 0.3, 3) if settings["K"] else 0.0)


# Kind to its marker, as matplotlib and plotly call it, and words.
KINDS = {
    "settled": ("o", "circle", "solved to the tolerance; smaller: coarser level"),
    "cycles": ("s", "square", "fixed number of cycles a frame"),
    "solver": ("^", "triangle-up", "another solver"),
    "lambertian": ("D", "diamond", "shown as a diffuser"),
    "default": ("*", "star", "on the mesh that `bake` makes by default"),
    "polygrid": ("X", "x", "on a polygrid of the body"),
    "K": ("P", "cross", "on the paper's meshes, smaller: larger K"),
    "converging": ("H", "hexagon2", "converges; bar: to what it states"),
    "walks": ("d", "diamond-tall", "random walks, by seconds"),
    "traced": ("v", "triangle-down", "path tracing, by samples a pixel"),
}
_COLOURS = {
    "fem, SP₃": "#1f77b4",
    "fem, SP₃, inter-reflection": "#0b3c6f",
    "fem, SP₃, corrected": "#d62ba8",
    "fem, SP₃, inter-reflection, corrected": "#d62ba8",
    "fem, diffusion": "#2ca02c",
    "fem, diffusion, inter-reflection": "#14591a",
    "fem, diffusion, published source": "#e6953a",
    "quadgraph-fv, SP₃": "#8c6bb1",
    "quadgraph-fv, diffusion": "#c79fd4",
    "quadgraph-fdm, as published": "#c44e52",
    "polygrid, as published": "#d4a017",
    "polygrid-divergence, diffusion": "#8a6d0b",
    "dipole per vertex": "#7f7f7f",
    "path tracing": "#111111",
    "path tracing, 15 scatterings at most": "#e34a33",
    "converging picture": "#008b8b",
    "random walks, plain": "#7a5195",
    "random walks, guided": "#b8860b",
}
_MORE = ("#17a2a2", "#bcbd22", "#8c564b", "#e377c2")


def colours(names: list[str]) -> dict[str, str]:
    """A colour for each family, those that are not known by turns."""
    unknown = [name for name in names if name not in _COLOURS]
    return _COLOURS | {name: _MORE[i % len(_MORE)] for i, name in enumerate(unknown)}


def device_text(scene: dict[str, Any]) -> str:
    """What the times of a scene are of, in words."""
    run = scene["run"]
    machine = f"{run['device'].split(' (')[0]}, {run['cores']} cores under load {run['load']}"
    return f"{machine}, pictures of {run['frame']['pixels']}² pixels"


def run_text(scene: dict[str, Any]) -> str:
    """By what a scene was measured, in words."""
    run = scene["run"]
    return (
        f"{run['device']}, {run['driver']}, {run['cores']} cores under load {run['load']}, pictures of "
        f"{run['frame']['pixels']}² pixels, commit {run['commit']}"
    )
