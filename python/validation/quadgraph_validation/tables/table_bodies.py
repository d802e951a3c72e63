"""The bodies of the tables: which they are, baked at a number of surface nodes, and kept for the next run."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from scipy.spatial import cKDTree

from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph.base import atomic_file
from quadgraph.base.errors import InputError
from quadgraph.base.progress import ProgressCallback
from quadgraph.base.version import __version__
from quadgraph.file import qgraph_file
from quadgraph.mesh import mesh_io
from quadgraph.mesh.surface import Surface
from quadgraph_validation.base import store
from quadgraph_validation.bodies import generated_shapes, scene_meshes
from quadgraph_validation.bodies.bunny import bunny_mesh
from quadgraph_validation.bodies.scenes import StudyScene

EXTENT_MM = 60.0  # largest edge of a body's bounding box
_ENOUGH = 0.9  # share of the wanted surface vertices from which a mesh is taken as it is
_LIMITS: dict[str, Any] = {"time_limit_s": 3600.0, "memory_limit_bytes": 24 << 30}
_GRADED_LIMITS: dict[str, Any] = {"time_limit_s": 900.0, "memory_limit_bytes": 8 << 30}  # CGAL's refinement may not end


@dataclass(frozen=True)
class TableSubject:
    """A body. mesh: a file of the folder of meshes, "bunny" (pymeshlab's) or a name in shapes.GENERATED; paper: its
    row of Table 1, "" if it has none; other: in what it is not the paper's body, "" if it is.
    """

    name: str
    mesh: str
    paper: str = ""
    other: str = ""

    def present(self, meshes: Path) -> bool:
        """Whether its mesh is there: a generated one always is."""
        return not self.mesh.endswith(".ply") or (meshes / self.mesh).is_file()


TABLE_1 = (
    TableSubject("armadillo", "armadillo.ply", "Thai", "no copy of the Thai statue could be had"),
    TableSubject("gargoyle", "gargoyle.ply", "Gargoyle"),
    TableSubject("shell", "shell", "Topmod", "no copy of the Topmod ball could be had: a perforated shell of genus 23"),
    TableSubject("buddha", "buddha.ply", "Buddha"),
    TableSubject("fertility", "fertility.ply", "Fertility"),
    TableSubject("twirl", "twirl.ply", "Twirl"),
    TableSubject("heptoroid", "heptoroid.ply", "Heptoroid"),
    TableSubject("lucy", "lucy.ply", "Lucy"),
)
BUNNY = TableSubject("bunny", "bunny")
DONUT = TableSubject("donut", "donut")
FERTILITY = TABLE_1[4]


@dataclass(frozen=True)
class Baked:
    """A file, and what its bake told: see `_report`."""

    path: Path
    report: dict[str, Any]


@dataclass(frozen=True)
class Store:
    """Where mesh files are, and where baked bodies are kept."""

    meshes: Path
    folder: Path

    def body(self, subject: TableSubject, faces: int, tell: ProgressCallback, **options: Any) -> Baked:
        """The subject with about `faces` surface nodes and further options of the bake, made if it is not there yet.

        Raises as quadgraph.baking.pipeline.bake does.
        """
        surface = self._surface(subject, faces)
        wanted = faces // 2 + surface.euler
        count = wanted if wanted < _ENOUGH * len(surface.vertices) else None
        digest = hashlib.sha256(surface.vertices.astype(np.float32).tobytes()).hexdigest()

        def run(working: Path) -> dict[str, float]:
            mesh = working.with_suffix(".ply")
            try:
                trimesh.Trimesh(surface.vertices, surface.triangles, process=False).export(mesh)
                chosen = BakeOptions(unit="mm", surface_vertices=count, **_LIMITS, **options)
                return bake(mesh, working, chosen).seconds
            finally:
                mesh.unlink(missing_ok=True)

        return self._kept(f"{subject.name}-{faces}", {"mesh": digest, "count": count} | options, run, tell)

    def graded(self, scene: StudyScene, vertices: int, grading: float, tell: ProgressCallback) -> Baked:
        """A scene's body as path tracing sees it, with about so many vertices on the finest surface, by the CGAL
        mesher with that K.

        Raises as quadgraph.baking.pipeline.bake does.
        """
        mesh = scene_meshes.file(scene, self.meshes)
        source = mesh_io.read_surface(mesh, height_mm=scene.height)
        count = vertices if vertices < _ENOUGH * source.vertices else None
        options: dict[str, Any] = {"height_mm": scene.height, "surface_vertices": count}
        options |= {"mesher": "cgal", "grading": grading}

        def run(working: Path) -> dict[str, float]:
            return bake(mesh, working, BakeOptions(**options, **_GRADED_LIMITS)).seconds

        return self._kept(f"{scene.name}-K{grading:g}", {"mesh": source.sha256} | options, run, tell)

    def _kept(self, name: str, made_of: dict[str, Any], run: Callable[[Path], dict], tell: ProgressCallback) -> Baked:
        """The file that `run` bakes to the path it is given, telling seconds, and its report, unless both are there."""
        digest = store.digest(made_of | {"versions": [__version__, qgraph_file.VERSION]})
        path = self.folder / f"{name}-{digest[:12]}.qgraph"
        told = path.with_suffix(".json")

        def make(working: Path) -> None:
            tell(f"{name}: baking")
            atomic_file.write_json(told, _report(run(working), working))

        if not told.exists():
            path.unlink(missing_ok=True)
        store.kept(path, make)
        return Baked(path, json.loads(told.read_text()))

    def _surface(self, subject: TableSubject, faces: int) -> Surface:
        """Its mesh, subdivided where it has too few faces, with a largest extent of EXTENT_MM."""
        if subject.mesh in generated_shapes.GENERATED:
            return scaled(generated_shapes.smooth(subject.mesh, faces))
        path = bunny_mesh() if subject.mesh == "bunny" else self.meshes / subject.mesh
        surface = scaled(mesh_io.read_surface(path, unit="mm").surface)
        while len(surface.triangles) < _ENOUGH * faces:
            surface = Surface(*trimesh.remesh.subdivide_loop(surface.vertices, surface.triangles, iterations=1))
        return surface


def _report(seconds: dict[str, float], path: Path) -> dict[str, Any]:
    """Report of a baked file: seconds of its bake, MB, and by level surface and inner nodes; K as measured."""
    sections = qgraph_file.read(path).sections
    levels = sum(name.endswith("/tets") for name in sections)
    counts = [[len(sections[f"level{level}/{name}"]) for name in ("faces", "tets")] for level in range(levels)]
    return {
        "bake_s": round(seconds["total"], 2),
        "file_bytes": path.stat().st_size,
        "nodes": [{"surface": faces, "inner": tets} for faces, tets in counts],
        "grading": round(grading(*(sections[f"level0/{name}"] for name in ("vertices", "tets", "faces"))), 3),
    }


def grading(vertices: np.ndarray, tets: np.ndarray, faces: np.ndarray) -> float:
    """K as tets show it: the median over those deeper than their surface's edges of (size - local size) / depth.

    vertices (n, 3) mm, tets (m, 4), faces (k, 3). size: mean edge length of a tet, local size: that of the nearest
    face; K of the paper's sizing field is the same slope. 0 if no tet is so deep.
    """
    vertices = np.asarray(vertices, np.float64)

    def size(cells: np.ndarray) -> np.ndarray:
        corners = vertices[cells]
        pairs = np.triu_indices(cells.shape[1], 1)
        return np.linalg.norm(corners[:, pairs[0]] - corners[:, pairs[1]], axis=2).mean(axis=1)

    depth, nearest = cKDTree(vertices[faces].mean(axis=1)).query(vertices[tets].mean(axis=1))
    local = size(faces)[nearest]
    deep = depth > local
    return float(np.median((size(tets)[deep] - local[deep]) / depth[deep])) if deep.any() else 0.0


def scaled(surface: Surface) -> Surface:
    """The surface with a largest extent of EXTENT_MM."""
    extent = float(np.ptp(surface.vertices, axis=0).max())
    if not extent > 0:
        raise InputError("the mesh has no extent")
    return Surface(surface.vertices * (EXTENT_MM / extent), surface.triangles)
