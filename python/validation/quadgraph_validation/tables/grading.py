"""Figure 13: error against K, the growth of tetrahedra with depth, against path tracing and against the same
equations.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from quadgraph.baking.budget import finer_levels, surface_errors
from quadgraph.base.errors import InputError
from quadgraph.base.progress import ProgressCallback
from quadgraph.base.relative_error import relative_rms
from quadgraph.mesh import display_map
from quadgraph.mesh.surface import Surface
from quadgraph_validation.bodies import scene_meshes
from quadgraph_validation.bodies.scenes import SCENES as KNOWN
from quadgraph_validation.bodies.scenes import StudyScene
from quadgraph_validation.chart.chart_body import ChartBody
from quadgraph_validation.chart.chart_judge import ChartJudge
from quadgraph_validation.chart.chart_method import SWING
from quadgraph_validation.chart.engine_methods import EngineMethod
from quadgraph_validation.tables.table_bodies import Baked
from quadgraph_validation.tables.table_row import TableRow, TableSetting
from quadgraph_validation.tables.table_ways import DEFAULT
from quadgraph_validation.truth import truth_run
from quadgraph_validation.truth.stored_truth import StoredTruth

if TYPE_CHECKING:
    from quadgraph.core import Engine

SCENES = ("sphere", "skin", "bunny")
GRADINGS = (1.0, 0.5, 0.3, 0.1)
_VERTICES = 10_000  # of the surface at scale 1
_PIXELS = 128  # edge of a frame's picture; none is timed
_EXACT: dict[str, Any] = {"tolerance": 1e-4, "max_iterations": 100_000, "inter_reflection": False}


@dataclass(frozen=True)
class GradingWay:
    """A method for its picture, solved to the chart's tolerance, and its own equations for the error of the mesh
    alone.
    """

    method: EngineMethod
    solver: str

    @property
    def equations(self) -> dict[str, Any]:
        """In the words of Engine.solve."""
        return {"model": self.method.model, "source": self.method.source}


def _ways() -> dict[str, GradingWay]:
    published = EngineMethod("quadgraph-fdm", "diffusion", "diffuse", "cascade")
    return {
        "published": GradingWay(published, "dpcg"),
        "ours, diffusion": GradingWay(EngineMethod(model="diffusion"), "fmg-pcg"),
        "ours, SP₃": GradingWay(EngineMethod(), "fmg-pcg"),
        DEFAULT: GradingWay(EngineMethod(inter_reflection=True), "fmg-pcg"),
    }


def rows(setting: TableSetting) -> Iterator[TableRow]:
    """One per scene."""
    for name in SCENES:
        mesh = scene_meshes.file(KNOWN[name], setting.store.meshes)
        missing = "" if mesh.is_file() else f"{mesh}: no such file"
        yield TableRow(name, name, missing, partial(measure, KNOWN[name], setting))


def measure(scene: StudyScene, setting: TableSetting, tell: ProgressCallback) -> dict[str, Any]:
    """Errors of every way at every K. Raises InputError if path-traced pictures are not there, ToolError without
    CGAL.
    """
    images = _images(scene, setting)
    vertices = setting.nodes(_VERTICES)
    baked = {k: setting.store.graded(scene, vertices, k, tell) for k in GRADINGS}
    found = []
    with tempfile.TemporaryDirectory(prefix="quadgraph-tables-") as working:
        folder = Path(working)
        tell(f"{scene.name}: reference, K = {min(GRADINGS):g} with every tet cut in eight")
        reference = _Reference(scene, baked[min(GRADINGS)].path, folder, setting.device)
        for k, body in baked.items():
            found.append(
                {"K": k} | body.report | {"errors": _errors(scene, body, images, reference, setting, folder, tell)}
            )
    return {"body": scene.name, "load": round(os.getloadavg()[0], 2), "gradings": found}


def _errors(
    scene: StudyScene,
    baked: Baked,
    images: dict[str, StoredTruth],
    reference: _Reference,
    setting: TableSetting,
    folder: Path,
    tell: ProgressCallback,
) -> dict[str, Any]:
    """By way, of its picture against path tracing and of its exitance against its own equations solved; by part."""
    body = ChartBody(scene, baked.path, folder, setting.device, _PIXELS)
    judge = ChartJudge(body, {}, images)
    judge.noise()  # what is unlit is found on an engine that methods share: before they do
    found = {}
    for name, way in _ways().items():
        tell(f"{scene.name}, {baked.path.stem}: {name}")
        way.method.prepare(body)
        for step in SWING[1:]:
            way.method.frame(step)
        pictures = {view: way.method.picture(view) for view in scene.views}
        errors = judge.errors(way.method, pictures)["transport"]
        found[name] = {"picture": errors}
        if not way.method.inter_reflection:  # which the reference does not know
            engine = body.engine(0, (way.method.method, way.method.model, way.method.source))
            engine.set_lights([scene.light])
            engine.solve(method=way.method.method, solver=way.solver, **way.equations, **_EXACT)
            found[name]["mesh"] = reference.error(engine, way.equations)
    return found


class _Reference:
    """Exitance from the finest mesh cut once more, by equations, at the vertices of the displayed surface."""

    def __init__(self, scene: StudyScene, path: Path, folder: Path, device: str) -> None:
        fine = finer_levels.refined(path, 1, folder / f"{scene.name}-fine.qgraph")
        self._body = ChartBody(scene, fine, folder, device, _PIXELS)
        self._display = ChartBody(scene, path, folder, device, _PIXELS).display
        corners = self._display.triangles.ravel()
        share = np.repeat(np.linalg.norm(self._display.doubled_normals, axis=1) / 6, 3)
        self._area = np.bincount(corners, share, len(self._display.vertices))
        self._true: dict[tuple[str, ...], np.ndarray] = {}
        self._parts: dict[str, np.ndarray] = {}

    def error(self, engine: Engine, equations: dict[str, str]) -> dict[str, float]:
        """By part, of the last solve of an engine, relative RMS over the displayed surface."""
        key = tuple(equations.values())
        if key not in self._true:
            self._true[key] = self._solved(equations)
        difference = self._shown(engine) - self._true[key]
        return {part: relative_rms(area, difference, self._true[key]) for part, area in self._parts.items()}

    def _solved(self, equations: dict[str, Any]) -> np.ndarray:
        engine = self._body.engine(0, ("fem", *equations.values()))
        engine.set_lights([self._body.scene.light])
        engine.solve(method="fem", solver="fmg-pcg", **equations, **_EXACT)
        if not self._parts:
            q = np.asarray(engine.surface_field()["q"], np.float64)
            self._parts = surface_errors.weights(self._area, q[_places(engine, self._display)[0]])
        return self._shown(engine)

    def _shown(self, engine: Engine) -> np.ndarray:
        """(n, 3) W/mm^2 at the vertices of the displayed surface."""
        face, weight = _places(engine, self._display)
        corners = np.asarray(engine.graph.levels[0].faces)[face]
        return np.einsum("ij,ijc->ic", weight, np.asarray(engine.vertex_exitance(), np.float64)[corners])


def _places(engine: Engine, display: Surface) -> tuple[np.ndarray, np.ndarray]:
    """Face (n,) of an engine's finest surface nearest to each vertex of the displayed one, and where in it (n, 3)."""
    level = engine.graph.levels[0]
    surface = np.asarray(level.vertices, np.float64)[: level.surface_vertex_count]
    return display_map.nearest_faces(display.vertices, Surface(surface, np.asarray(level.faces, np.int64)))


def _images(scene: StudyScene, setting: TableSetting) -> dict[str, StoredTruth]:
    found = truth_run.subject(scene, scene_meshes.file(scene, setting.store.meshes))
    images = {name: truth_run.stored(found, setting.truth, name) for name in scene.images}
    for name, image in images.items():
        if image.batches < 2:
            command = f"quadgraph reference {scene.name} --kind transport --samples N"
            raise InputError(f"{found.path(setting.truth, name)}: not there; '{command}' makes it with Mitsuba")
    return images
