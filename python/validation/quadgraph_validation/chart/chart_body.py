"""A scene ready for all methods: its chain of levels, an engine for each system of equations, its light on the move."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from quadgraph.baking.budget.surface_errors import unlit_part
from quadgraph.core import load_core
from quadgraph.file import qgraph_file, sections
from quadgraph.mesh.surface import Surface
from quadgraph_validation.bodies import level_chains
from quadgraph_validation.bodies.scene_bakes import Choice, SceneBake
from quadgraph_validation.bodies.scenes import StudyScene, View
from quadgraph_validation.chart.chart_method import MethodChain
from quadgraph_validation.chart.pixels import Hits, hits

if TYPE_CHECKING:
    from quadgraph.core import Engine
    from quadgraph_validation.truth.truth_run import TracedSubject

STEP_DEGREES = 5.0  # by which a parallel light turns from frame to frame
STEP_SHARE = 0.05  # by which a uniform light dims, which has no direction to turn
MOTION_DEGREES = 3.0  # by which a light turns for methods in motion, and uniform light dims in proportion
MOTION_SHARE = MOTION_DEGREES / STEP_DEGREES  # of a step of the light, that it goes on by there
CAMERA_DEGREES = 1.0  # by which the camera goes around where it moves


def light_at(scene: StudyScene, step: float) -> str:
    """The scene's light as the engine reads it, `step` frames before it has arrived."""
    way = direction_at(scene, step)
    if way is None:
        return f"ambient:{strength_at(scene, step):g}"
    return f"directional:{','.join(f'{x:.9g}' for x in way)}:1"


def direction_at(scene: StudyScene, step: float) -> tuple[float, float, float] | None:
    """The way (3,) that parallel light travels, `step` frames before it has arrived; None of uniform light."""
    if scene.direction is None:
        return None
    way = np.array(scene.direction, float)
    axis = np.cross(way, [0.0, 1.0, 0.0] if abs(way[1]) < 0.9 * np.linalg.norm(way) else [1.0, 0.0, 0.0])
    axis /= np.linalg.norm(axis)
    angle = np.radians(STEP_DEGREES * step)
    x, y, z = way * np.cos(angle) + np.cross(axis, way) * np.sin(angle)
    return float(x), float(y), float(z)


def strength_at(scene: StudyScene, step: float) -> float:
    """The light over the scene's own, `step` frames before it has arrived."""
    return 1 - STEP_SHARE * step if scene.direction is None else 1.0


def view_at(scene: StudyScene, step: float) -> View:
    """The scene's first view from where the camera is, `step` frames before it has arrived there."""
    view = next(iter(scene.views.values()))
    return replace(view, azimuth=view.azimuth - CAMERA_DEGREES * step)


@dataclass(frozen=True)
class Display:
    """For each vertex of the display mesh the nearest face of a level (n,), and where in it, barycentric (n, 3)."""

    face: np.ndarray
    barycentric: np.ndarray


@dataclass
class ChartBody:
    """A scene's baked chain, at `path`; files of its coarser levels go to `folder`. pixels: edge of a frame's picture;
    others: the same body baked in further ways, made when they are first asked for; original: the scene with its own
    mesh, for path tracing, None where no path-traced truth judges.

    The first engine of each system is kept, so that frames assemble nothing, and methods that differ in the solver
    alone share it.
    """

    scene: StudyScene
    path: Path
    folder: Path
    device: str
    pixels: int
    others: Mapping[Choice, SceneBake] = field(default_factory=dict)
    original: TracedSubject | None = None
    _engines: dict[tuple, Engine] = field(default_factory=dict)
    _hits: dict[View, Hits] = field(default_factory=dict)

    @cached_property
    def file(self) -> qgraph_file.QGraphFile:
        """The chain as it was baked."""
        return qgraph_file.read(self.path)

    @cached_property
    def chain(self) -> MethodChain:
        """What there is to choose methods by."""
        seen = sections.read_exchange(self.file)
        faces = (len(self.file.sections[f"level{level}/faces"]) for level in range(self.file.level_count))
        seeing = None if seen is None else seen.level
        return MethodChain(tuple(faces), seeing, tuple(self.others), self.original is not None)

    def level_path(self, level: int, choice: Choice | None = None) -> Path:
        """A file whose finest level that is, of the chain or of the body baked in another way.

        Raises ToolError if that cannot be baked.
        """
        whole = self.path if choice is None else self.others[choice].made()
        path = self.folder / f"{whole.stem}-from-{level}.qgraph"
        if level == 0:
            return whole
        return path if path.exists() else level_chains.without_finest(whole, level, path, same_display=True)

    def engine(self, level: int, system: tuple[str, ...], choice: Choice | None = None) -> Engine:
        """The engine of that system, e.g. (method, model, source), on the chain from a level down, or on another."""
        key = (level, choice, *system)
        if key not in self._engines:
            engine = load_core().Engine(self.level_path(level, choice), device=self.device)
            self._set_coefficients(engine)
            self._engines[key] = engine
        return self._engines[key]

    def levels(self, choice: Choice | None = None) -> list[dict[str, Any]]:
        """Sizes by level, for the record."""
        file = self.file if choice is None else qgraph_file.read(self.others[choice].made())
        names = ("surface_vertices", "tets", "faces")
        return [{name: entry[name] for name in names} for entry in file.metadata["levels"]]

    @cached_property
    def default_surface(self) -> Surface:
        """The finest level's, as `bake` makes it by default. Raises KeyError where that is not among `others`."""
        sections = qgraph_file.read(self.others[Choice()].made()).sections
        vertices, triangles = (sections[f"level0/{name}"] for name in ("vertices", "faces"))
        return Surface(vertices.astype(np.float64), triangles.astype(np.int64))

    @cached_property
    def display(self) -> Surface:
        """The mesh that pictures show."""
        vertices, triangles = (self.file.sections[f"display/{name}"] for name in ("vertices", "triangles"))
        return Surface(vertices.astype(np.float64), triangles.astype(np.int64))

    def level_display(self, level: int) -> Display:
        """Where the display mesh lies on the surface of a level."""
        sections = qgraph_file.read(self.level_path(level)).sections
        return Display(sections["display/face"], sections["display/barycentric"])

    def hits(self, view: str) -> Hits:
        """Where the rays of a view of the scene meet the display mesh."""
        return self._hits_from(self.scene.views[view])

    def _hits_from(self, view: View) -> Hits:
        if view not in self._hits:
            self._hits[view] = hits(self.display, self.file.sections["display/normals"], view)
        return self._hits[view]

    def coverage(self, view: str) -> np.ndarray:
        """Share (PIXELS, PIXELS) of each pixel that the body covers."""
        return self.coverage_from(self.scene.views[view])

    def coverage_from(self, view: View) -> np.ndarray:
        """The same from anywhere."""
        return self._hits_from(view).shown(self.display.triangles, np.ones((len(self.display.vertices), 1)))[..., 0]

    def lit(self) -> np.ndarray:
        """(n_d,) bool, whether where a vertex of the display mesh lies is not unlit."""
        engine = self.engine(0, ("fem", "diffusion", "buried"))
        engine.set_lights([self.scene.light])
        engine.solve(model="diffusion", inter_reflection=False)
        found = engine.surface_field()
        unlit = unlit_part(np.asarray(found["area"], np.float64), found["q"])
        return ~unlit[self.level_display(0).face]

    def _set_coefficients(self, engine: Engine) -> None:
        for level, of in enumerate(engine.graph.levels):
            values = self.scene.in_channels(np.asarray(of.nodes, np.float64))
            scattering, absorption = (value.astype(np.float32) for value in values)
            engine.set_optical(level, scattering, absorption, self.scene.eta)
