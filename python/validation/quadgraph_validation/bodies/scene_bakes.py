"""The bodies of scenes, baked in several ways and kept under names that tell what they were made from."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph.base.version import __version__
from quadgraph.file import qgraph_file
from quadgraph.mesh import mesh_io
from quadgraph_validation.base import store
from quadgraph_validation.bodies import scene_meshes
from quadgraph_validation.bodies.scenes import StudyScene


@dataclass(frozen=True)
class Choice:
    """How to bake: about how many vertices the finest surface has at most, None for all that the mesh has; grading: K
    of the QuadGraph paper's sizing field, by its mesher; None for the default's; cells: of a polygrid along a cube's
    side, None for no polygrid.
    """

    vertices: int | None = None
    grading: float | None = None
    cells: int | None = None


@dataclass(frozen=True)
class SceneBake:
    """A baked body's file, whether it is there or not; its name is its own for whatever it is made from and by."""

    source: Path
    path: Path
    options: BakeOptions

    def made(self) -> Path:
        """The file, baked if it is not there. Raises as quadgraph.baking.pipeline.bake does."""
        return store.kept(self.path, lambda working: bake(self.source, working, self.options))


def of(scene: StudyScene, choice: Choice, meshes: Path, folder: Path) -> SceneBake:
    """A scene's body baked that way, to be kept in `folder`. Raises InputError if its mesh cannot be read."""
    mesh = scene_meshes.file(scene, meshes)
    source = mesh_io.read_surface(mesh, height_mm=scene.height)
    vertices = choice.vertices if choice.vertices is not None and source.vertices > choice.vertices else None
    made_of: dict[str, Any] = {
        "mesh": source.sha256,
        "height_mm": scene.height,
        "vertices": vertices,
        "quadgraph": __version__,
        "format": qgraph_file.VERSION,
    }
    options: dict[str, Any] = {"height_mm": scene.height, "surface_vertices": vertices}
    if choice.grading is not None:
        made_of["grading"] = choice.grading
        options |= {"mesher": "cgal", "grading": choice.grading}
    if choice.cells is not None:
        made_of["polygrid"] = choice.cells
        options |= {"mesher": "polygrid", "cells": choice.cells, "surface_vertices": None}
    name = f"{mesh.stem}-{scene.height:g}mm-{store.digest(made_of)[:12]}.qgraph"
    return SceneBake(mesh, folder / name, BakeOptions(**options))
