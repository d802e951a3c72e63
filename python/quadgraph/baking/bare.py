"""A mesh file as a .qgraph without levels: a surface to look at, which only the shortest-path method can show."""

from __future__ import annotations

import platform
from pathlib import Path

import numpy as np

from quadgraph.base import outputs
from quadgraph.base.version import __version__
from quadgraph.file import qgraph_file, sections
from quadgraph.mesh import display_map, front, mesh_io
from quadgraph.mesh.surface import SourceMesh


def write(
    mesh: Path,
    output: Path,
    unit: str | None = None,
    height_mm: float | None = None,
    longest_mm: float | None = None,
    front_degrees: float | None = None,
    up: str = "y",
) -> SourceMesh:
    """Write a mesh as it is, open, broken or not, with nothing repaired.

    unit, height_mm, longest_mm, up: as mesh_io.read_surface. front_degrees: azimuth from where it is shown when nobody
    says so; found out if it is None. Raises InputError for a file that cannot be read.
    """
    front.check(front_degrees)
    outputs.check_outputs([Path(output)], [mesh])
    source = mesh_io.read_surface(mesh, unit=unit, height_mm=height_mm, longest_mm=longest_mm, up=up)
    surface = source.surface.compacted()
    normals = display_map.vertex_normals(surface)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.where(length > 0.5, normals, [0.0, 0.0, 1.0])  # of vertices whose triangles have no area
    metadata = {
        "generator": f"quadgraph {__version__}",
        "source": source.metadata(),
        "unit_mm": source.unit_mm,
        "mesher": {"name": "none", "version": "", "options": "", "grading": None},
        "options": {"up": up},
        "repairs": [],
        "levels": [],
        "front": front.azimuth(surface) if front_degrees is None else front_degrees,
        "tools": {"python": platform.python_version()},
    }
    qgraph_file.write(output, metadata, sections.display_alone(surface, normals))
    return source
