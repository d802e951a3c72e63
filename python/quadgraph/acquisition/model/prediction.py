"""What the engine predicts for the photographs of a capture."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from quadgraph import core
from quadgraph.acquisition.capture.capture import Capture
from quadgraph.api.derivatives import ForwardModel, Views, forward_model
from quadgraph.base.errors import InputError

LEAST_ERROR = 0.005  # relative, of a picture whose own estimate is below that
_UNKNOWN_MESH = 0.02  # relative, taken for the mesh's part where a body of one level leaves it untold
_DIM = 0.2  # of the 95th percentile of what is seen: below, the estimate of the unlit part counts
# Of a pixel. Corrections are factors of pictures so made, and bring what more samples see; without them a pixel is .2%
# off that.
_UNCORRECTED_SAMPLES = 4
_STAGES = 16  # engines at most
# What a capture leaves open: one model for all coefficients, and solves whose differences are derivatives.
_SOLVER = {"model": "sp3", "tolerance": 1e-4}
_AS_USUAL: Mapping[str, Any] = {}
PLACES = ("position", "centre")  # of lights
_ANY = np.ones((2, 3))  # coefficients where lights alone matter, 1/mm
_TOLERANCE = 1e-7  # of the solves of derivatives
NAMES = ("sigma_a", "sigma_s_prime")
CHANNELS = ("red", "green", "blue")


@dataclass(frozen=True, eq=False)
class Predicted:
    """One picture: radiance (h, w, 3) of light that was scattered inside, W/(mm^2 sr); gloss (h, w, 3), what reached
    the camera without; alpha (h, w), share of a pixel that the body covers; error (h, w, 3), relative, as the engine
    estimates its own; band (h, w, 3): 0 bright, 1 dim, 2 of the dimmest third, each with an estimate of its own.
    """

    radiance: np.ndarray
    gloss: np.ndarray
    alpha: np.ndarray
    error: np.ndarray
    band: np.ndarray


@dataclass(frozen=True, eq=False)
class SolvedLights:
    """What a solve under one set of lights gave: a picture for each camera, and the report."""

    pictures: list[Predicted]
    report: dict[str, Any]


# From scenes as JSON, those of one set of lights after the other and in each a scene for each camera, and what is to be
# called after each set, to what their solves give.
SpreadSolves: TypeAlias = Callable[[Sequence[Sequence[str]], Callable[[], None]], list[SolvedLights]]


class Predictor:
    """The engine with a capture's body, ready to predict all its photographs."""

    def __init__(
        self,
        capture: Capture,
        body: Path,
        device: str = "",
        validation: bool = False,
        spread: SpreadSolves | None = None,
    ) -> None:
        """body: the baked file; device, validation: as `Stage` has them; spread: makes corrected predictions elsewhere.
        Raises FormatError, InputError, DeviceError.
        """
        self._body = body
        self._spread = spread
        self._take(capture)
        # One for each set of lights keeps what depends on lights alone, which is most of an uncorrected solve.
        self._stages = [core.Stage(device, validation) for _ in range(min(len(self._solves), _STAGES))]
        # By which capture and lights each was solved last.
        self._lit: list[tuple[Capture, tuple[str, ...]] | None] = [None] * len(self._stages)

    def _take(self, capture: Capture) -> None:
        self._capture = capture
        wanted = [(each.lights, each.camera) for each in capture.photographs]
        self._solves: dict[tuple[str, ...], list[str]] = {}
        for lights, camera in dict.fromkeys(wanted):
            self._solves.setdefault(lights, []).append(camera)
        self.notes: list[str] = []  # what the engine says against its last answers, each once

    def of(self, capture: Capture) -> Predictor:
        """Another capture of the same body, by the same engines."""
        other = copy.copy(self)
        other._take(capture)
        return other

    @property
    def solves(self) -> int:
        """How many solves a prediction of all photographs takes."""
        return len(self._solves)

    @property
    def graph(self) -> core.QuadGraph:
        """The baked body."""
        return core.load(self._body)

    @property
    def size_mm(self) -> float:
        """The middle one of the three sides of the box around the body."""
        low, high = self.box_mm
        return float(np.median(high - low))

    @property
    def box_mm(self) -> np.ndarray:
        """(2, 3) the box around the body as it lies in its file."""
        vertices = self.graph.display["vertices"]
        return np.array([vertices.min(axis=0), vertices.max(axis=0)])

    def predict(
        self,
        coefficients: np.ndarray | Path,
        corrected: bool,
        tell: Callable[[], None] = lambda: None,
        solver: Mapping[str, Any] = _AS_USUAL,
    ) -> list[Predicted]:
        """One picture a photograph.

        coefficients: (2, 3), sigma_a and sigma_s_prime in 1/mm of red, green, blue, or the file of a volume; corrected:
        by sweeps of the transport equation; tell: is called after each solve; solver: further options of it, as scenes
        have them. Raises InputError, SolverError.
        """
        found: dict[tuple[tuple[str, ...], str], Predicted] = {}
        self.notes = []
        scenes = [
            [self._scene(coefficients, corrected, lights, camera, solver) for camera in cameras]
            for lights, cameras in self._solves.items()
        ]
        solve = self._spread if corrected and self._spread else self._solved
        for (lights, cameras), one in zip(self._solves.items(), solve(scenes, tell), strict=True):
            self._note(one.report)
            found |= {(lights, camera): picture for camera, picture in zip(cameras, one.pictures, strict=True)}
        return [found[each.lights, each.camera] for each in self._capture.photographs]

    def _solved(self, scenes: Sequence[Sequence[str]], tell: Callable[[], None]) -> list[SolvedLights]:
        """What `SpreadSolves` finds, by the engines that are here."""
        found = []
        for number, (lights, ones) in enumerate(zip(self._solves, scenes, strict=True)):
            found.append(solved(self._stages[number % len(self._stages)], ones))
            self._lit[number % len(self._stages)] = self._capture, lights
            tell()
        return found

    def rays(self, camera: str, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Where the rays through (n, 2) places of a camera's picture, pixels right and down, come from, mm, and their
        unit directions, (n, 3) each.
        """
        stage = self._stages[0]
        lights = self._capture.photographs[0].lights
        _show(stage, self._scene(_ANY, False, lights, camera))
        self._lit[0] = None
        return stage.view_rays(places)

    def model(
        self,
        lights: tuple[str, ...],
        level: int,
        coefficients: tuple[np.ndarray, np.ndarray],
        views: Views,
        model: str = "sp3",
    ) -> ForwardModel:
        """What leaves a level under lights as a function of coefficients: sigma_a and sigma_s_prime of its tets.

        model: of the fluence, "sp3" or "diffusion".
        """
        number = list(self._solves).index(lights) % len(self._stages)
        stage = self._stages[number]
        lit = self._lit[number]
        if lit is None or lit[0] is not self._capture or lit[1] != lights:
            _show(stage, self._scene(_ANY, False, lights, self._solves[lights][0]))
            stage.solve()
            self._lit[number] = self._capture, lights
        absorption, scattering = coefficients
        return forward_model(stage.engine, level, (scattering, absorption, None), views, model, None, _TOLERANCE)

    def _scene(
        self,
        coefficients: np.ndarray | Path,
        corrected: bool,
        lights: tuple[str, ...],
        camera: str,
        solver: Mapping[str, Any] = _AS_USUAL,
    ) -> str:
        capture = self._capture
        width, height = capture.sizes[camera]
        document = {
            "body": str(self._body.absolute()),
            "material": _material(coefficients, capture.eta),
            "lights": [capture.lights[name] for name in lights],
            "deformation": capture.deformation,
            "camera": capture.cameras[camera],
            "solver": {**_SOLVER, **solver, **capture.solver, "correction": corrected},
            "picture": {
                "width": width,
                "height": height,
                "transmission_roughness": 0,  # as derivatives have it
                "samples": 0 if corrected else _UNCORRECTED_SAMPLES,
            },
        }
        return json.dumps(document)

    def _note(self, report: dict[str, Any]) -> None:
        for name in ("stopped", "mesh_warning", "model_warning", "light_warning"):
            if report[name] and report[name] not in self.notes:
                self.notes.append(report[name])


def solved(stage: core.Stage, scenes: Sequence[str]) -> SolvedLights:
    """What an engine finds for scenes of one set of lights, seen by one camera after the other. Raises SolverError,
    InputError.
    """
    report: dict[str, Any] | None = None
    pictures = []
    for scene in scenes:
        _show(stage, scene)
        report = report or stage.solve()
        pictures.append(_predicted(stage.render(), report))
    if messages := stage.engine.validation_messages:
        raise InputError("Vulkan validation: " + " | ".join(messages))
    return SolvedLights(pictures, report or {})


def _show(stage: core.Stage, scene: str) -> None:
    stage.show(core.scene_file(scene).at(0))


def _material(coefficients: np.ndarray | Path, eta: float) -> str | dict[str, Any]:
    if isinstance(coefficients, Path):
        return str(coefficients.absolute())
    absorption, scattering = coefficients.tolist()
    return {"sigma_s_prime": scattering, "sigma_a": absorption, "eta": eta}


def _predicted(picture: core.Picture, report: dict[str, Any]) -> Predicted:
    radiance = np.array(picture.scattered, np.float64)
    alpha = np.array(picture.alpha, np.float64)
    gloss = np.array(picture.specular, np.float64) + np.array(picture.unscattered, np.float64)
    band = _bands(radiance)
    return Predicted(radiance, gloss, alpha, _errors(report)[band], band)


def _errors(report: dict[str, Any]) -> np.ndarray:
    """(3,) relative errors of the bands of brightness, from the estimates of a solve."""
    estimate, untold = report["error"], 0.0
    if estimate is None:
        estimate, untold = report["model_error"] or dict.fromkeys(("whole", "unlit", "dimmest"), 0.0), _UNKNOWN_MESH
    whole = max(float(np.hypot(estimate["whole"], untold)), LEAST_ERROR)
    unlit = max(estimate["unlit"], whole)
    dimmest = max(estimate["dimmest"], unlit)
    return np.array([whole, unlit, dimmest])


def _bands(radiance: np.ndarray) -> np.ndarray:
    """(h, w, 3) the band of brightness of each pixel."""
    bands = np.zeros(radiance.shape, np.int64)
    for channel in range(3):
        value = radiance[..., channel]
        seen = value[value > 0]
        if seen.size:
            bands[..., channel][value < _DIM * np.quantile(seen, 0.95)] = 1
            bands[..., channel][value < np.quantile(seen, 1 / 3)] = 2
    return bands


def check_seen(capture: Capture, box_mm: np.ndarray, pictures: list[Predicted]) -> None:
    """Raise InputError for a photograph whose camera does not see the body, or sees nothing of it that is lit.

    box_mm: (2, 3), around the body as it lies in its file.
    """
    for stated, picture in zip(capture.photographs, pictures, strict=True):
        where = f"{capture.path}: {stated.path}"
        covered = picture.alpha > 0.999
        if covered.sum() < 16:
            eye = capture.cameras[stated.camera].get("eye")
            inside = _inside(f"cameras.{stated.camera}.eye", eye, box_mm) if eye else ""
            raise InputError(
                f"{where}.camera: the body covers {int(covered.sum())} pixels of '{stated.camera}', allowed are 16 or "
                f"more; {inside}check body, unit (mm), deformation, and the camera's places (mm)"
            )
        if not (picture.radiance[covered] > 0).any():
            why = "".join(_unlit(f"lights.{name}", capture.lights[name], box_mm) for name in stated.lights)
            raise InputError(
                f"{where}.lights: none of {', '.join(stated.lights)} brings light to what '{stated.camera}' sees; "
                f"{why}check directions and places of the lights (mm)"
            )


def _unlit(path: str, light: Mapping[str, Any], box_mm: np.ndarray) -> str:
    """Why a light reaches nothing, where its place and its direction say it."""
    member = next((name for name in PLACES if name in light), None)
    if member is None:
        return ""
    if inside := _inside(f"{path}.{member}", light[member], box_mm):
        return inside
    towards = np.cross(light["u"], light["v"]) if "u" in light else light.get("direction")
    if towards is not None and np.dot(towards, box_mm.mean(axis=0) - light[member]) <= 0:
        what = "u x v" if "u" in light else "direction"
        return f"{path} shines away from the body, by its {what}: one of its axes may be flipped; "
    return ""


def _inside(path: str, place: Sequence[float], box_mm: np.ndarray) -> str:
    """Whether a place lies within the box around the body, in words."""
    if not ((place > box_mm[0]) & (place < box_mm[1])).all():
        return ""
    found, sides = (", ".join(f"{x:.4g}" for x in each) for each in (place, box_mm[1] - box_mm[0]))
    return f"{path}, [{found}] mm, lies inside the box around the body, whose sides are [{sides}] mm: units differ; "
