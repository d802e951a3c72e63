"""Baked chains of levels for a study: with their finest levels taken off, and with a solution carried up to them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import trimesh

from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph.base.errors import InputError
from quadgraph.file import qgraph_file
from quadgraph.mesh import display_map
from quadgraph.mesh.surface import Surface


def _sphere(detail: int) -> trimesh.Trimesh:
    return trimesh.creation.icosphere(subdivisions=detail)


def _torus(detail: int) -> trimesh.Trimesh:
    sections = {"major_sections": 2 ** (detail + 2), "minor_sections": 7 * 2 ** (detail - 2)}
    return trimesh.creation.torus(major_radius=1, minor_radius=0.4, **sections)


def _box(detail: int) -> trimesh.Trimesh:
    box = trimesh.creation.box((1, 0.8, 0.5))
    for _ in range(detail):
        box = box.subdivide()
    box.merge_vertices()
    return box


def _lobes(detail: int) -> trimesh.Trimesh:
    ball = _sphere(detail)
    x, y, z = ball.vertices.T
    radius = 1 + 0.25 * np.sin(3 * x + 1) * np.cos(4 * y) + 0.2 * np.sin(5 * z + 2 * x)
    return trimesh.Trimesh(ball.vertices * radius[:, None], ball.faces, process=False)


# Name to a surface of about 10 * 4^detail vertices.
SHAPES: dict[str, Callable[[int], trimesh.Trimesh]] = {"sphere": _sphere, "torus": _torus, "box": _box, "lobes": _lobes}


@dataclass(frozen=True)
class ChainSubject:
    """A body to bake. mesh: a file of the meshes' folder, or a name in SHAPES with `detail`.

    height: mm along y; vertices: about how many the finest surface gets, None for all; levels: how many at most.
    """

    name: str
    mesh: str
    height: float
    vertices: int | None = None
    levels: int = 5
    detail: int = 6


def chosen(subjects: Sequence[ChainSubject], names: Sequence[str]) -> list[ChainSubject]:
    """Those of the given names, all if there are none. Raises InputError for a name that is not among them."""
    known = {subject.name: subject for subject in subjects}
    for name in names:
        if name not in known:
            raise InputError(f"scene '{name}': allowed are {', '.join(known)}")
    return [known[name] for name in names or known]


def baked(subject: ChainSubject, mesh_folder: Path, folder: Path) -> Path:
    """Bake a subject into `folder`, without what its faces see. Raises as quadgraph.baking.pipeline.bake does."""
    source = mesh_folder / subject.mesh
    if subject.mesh in SHAPES:
        source = folder / f"{subject.name}.ply"
        SHAPES[subject.mesh](subject.detail).export(source)
    output = folder / f"{subject.name}.qgraph"
    options = BakeOptions(
        height_mm=subject.height,
        levels=subject.levels,
        surface_vertices=subject.vertices,
        visibility_rays=0,
    )
    bake(source, output, options)
    return output


def without_finest(path: Path, count: int, output: Path, same_display: bool = False) -> Path:
    """Write the levels of a .qgraph but its `count` finest.

    What is displayed is the finest level that is left, or, with same_display, the display mesh that the file has.
    """
    file = qgraph_file.read(path)
    kept = {}
    for name, array in file.sections.items():
        level, _, field = name.removeprefix("level").partition("/")
        if name.startswith("level") and int(level) >= count:
            kept[f"level{int(level) - count}/{field}"] = array
    metadata = file.metadata | {"levels": file.metadata["levels"][count:]}
    faces = kept["level0/faces"]
    vertices = kept["level0/vertices"][: int(faces.max()) + 1]
    surface = Surface(vertices.astype(np.float64), faces.astype(np.int64))
    if same_display:
        shown = {name: file.sections[f"display/{name}"] for name in ("vertices", "normals", "triangles")}
    else:
        normals = display_map.vertex_normals(surface).astype(np.float32)
        shown = {"vertices": np.ascontiguousarray(vertices), "normals": normals, "triangles": faces}
    face, coordinates = display_map.nearest_faces(shown["vertices"].astype(np.float64), surface)
    shown |= {"face": face.astype(np.uint32), "barycentric": coordinates.astype(np.float32)}
    qgraph_file.write(output, metadata, kept | {f"display/{name}": array for name, array in shown.items()})
    return output


def carried(levels: list, values: np.ndarray, first: int) -> np.ndarray:
    """Values (n, 3) at the surface vertices of levels[first], carried to the faces of levels[0], (n_f, 3)."""
    return to_vertices(levels, values, first)[np.asarray(levels[0].faces)].mean(axis=1)


def to_vertices(levels: list, values: np.ndarray, first: int) -> np.ndarray:
    """Values (n, 3) at the surface vertices of levels[first], carried to those of levels[0].

    levels: of a loaded file. By the file's barycentric transfers; where a fine vertex lies inside the coarse body only
    the coarse surface counts, for what is carried lives there.
    """
    for level in reversed(levels[:first]):
        index, weight = (np.asarray(part) for part in level.barycentric)
        index, weight = (part[: level.surface_vertex_count] for part in (index, weight))
        weight = np.where(index < len(values), weight, 0)
        whole = weight.sum(axis=1, keepdims=True)
        index = np.minimum(index, len(values) - 1)
        values = np.einsum("ij,ijc->ic", weight / np.where(whole > 0, whole, 1), values[index])
    return values
