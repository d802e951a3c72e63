"""A mesh with colours where a baked body is: in its millimetres, with its side up."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from quadgraph import core
from quadgraph.base import regular_file
from quadgraph.base.errors import FormatError, InputError
from quadgraph.file import qgraph_file
from quadgraph.file.shapes_file import up_of
from quadgraph.mesh.looks.parts import ColouredMesh
from quadgraph.mesh.mesh_io import stood_up
from quadgraph.mesh.surface import Surface

FAR = 0.01  # of the body's diagonal: half of its surface farther than that from the mesh is another body's
_LOOKED_AT = 4000  # vertices of the body


@dataclass(frozen=True, eq=False)
class PlacedMesh:
    """looks: parts and their colours; surface: all their triangles in the same order, mm, as the body lies; unit_mm:
    length of one unit of the mesh file; edge: median edge of the body's finest simulation surface, mm.
    """

    looks: ColouredMesh
    surface: Surface
    unit_mm: float
    edge: float

    @cached_property
    def areas(self) -> np.ndarray:
        """Of each triangle, (m,) mm²."""
        return 0.5 * np.linalg.norm(self.surface.doubled_normals, axis=1)

    @property
    def part_areas(self) -> np.ndarray:
        """Of each part, mm²."""
        return np.add.reduceat(self.areas, self.looks.begins[:-1])


def place(looks: ColouredMesh, mesh: Path, body: Path) -> PlacedMesh:
    """Lay a mesh where the body is that was baked of it, or of a file of the same shape.

    Raises InputError where no unit makes it lie there, FormatError for a broken body.
    """
    file = qgraph_file.read(body)
    shown = file.sections["display/vertices"].astype(np.float64)
    stood = stood_up(looks.vertices, up_of(file, body))
    used = stood[np.unique(looks.triangles)]
    if not np.isfinite(used).all():
        raise InputError(f"{mesh}: a vertex that is not finite found")
    far = []
    for unit_mm in _units(file, body, mesh, used, shown):
        surface = Surface(stood * unit_mm, looks.triangles)
        far.append(_distance(surface, shown))
        diagonal = float(np.linalg.norm(np.ptp(shown, axis=0)))
        if far[-1] <= FAR * diagonal:
            return PlacedMesh(looks, surface, unit_mm, _edge(file))
    raise InputError(
        f"{mesh}: half of the surface of {body} is {min(far):.3g} mm or more from it, at most {FAR * diagonal:.3g} mm "
        "are allowed; give the body that was baked of this mesh, or bake it again"
    )


def _units(file: qgraph_file.QGraphFile, body: Path, mesh: Path, used: np.ndarray, shown: np.ndarray) -> list[float]:
    """Lengths of one unit of the mesh, mm, to try: that of the bake, and of another file what gives it its size."""
    baked, source = file.metadata.get("unit_mm"), file.metadata.get("source")
    if not isinstance(baked, int | float) or not 0 < baked < np.inf or not isinstance(source, dict):
        raise FormatError(
            f"{body}: metadata: unit_mm {str(baked)[:40]} and source {str(source)[:40]} found, wanted are a number "
            "above 0 and an object"
        )
    same = hashlib.sha256(regular_file.read_bytes(mesh)).hexdigest() == source.get("sha256")
    longest = float(np.ptp(used, axis=0).max())
    if same or longest == 0:
        return [float(baked)]
    return [float(baked), float(np.ptp(shown, axis=0).max()) / longest]


def _distance(surface: Surface, shown: np.ndarray) -> float:
    """How far half of the body's shown vertices are from the mesh, mm."""
    some = shown[:: max(len(shown) // _LOOKED_AT, 1)]
    with np.errstate(over="ignore"):
        vertices = surface.vertices.astype(np.float32)
    if not np.isfinite(vertices).all():
        return float("inf")
    return float(np.median(core.nearest_faces(vertices, surface.triangles, some)[1]))


def _edge(file: qgraph_file.QGraphFile) -> float:
    """Median edge of the finest surface that is solved on, or of what is shown of a body without levels, mm."""
    prefix = ("level0/vertices", "level0/faces") if file.level_count else ("display/vertices", "display/triangles")
    vertices, triangles = (file.sections[name] for name in prefix)
    corners = vertices.astype(np.float64)[triangles]
    return float(np.median(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)))
