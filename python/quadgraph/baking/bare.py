"""A mesh file as a .qgraph without levels: a surface to look at, which only the shortest-path method can show."""

from __future__ import annotations

import platform
from pathlib import Path

from quadgraph.base import outputs
from quadgraph.base.version import __version__
from quadgraph.file import qgraph_file, sections
from quadgraph.mesh import display_map, front, mesh_io
from quadgraph.mesh.creases import parted_by
from quadgraph.mesh.looks import file_normals
from quadgraph.mesh.surface import SourceMesh, Surface


def write(
    mesh: Path,
    output: Path,
    unit: str | None = None,
    height_mm: float | None = None,
    longest_mm: float | None = None,
    front_degrees: float | None = None,
    up: str = "y",
    normals: str = "file",
) -> SourceMesh:
    """Write a mesh as it is, open, broken or not, with nothing repaired.

    unit, height_mm, longest_mm, up: as mesh_io.read_surface; normals: as BakeOptions. front_degrees: azimuth from where
    it is shown when nobody says so; found out if it is None. Raises InputError for a file that cannot be read.
    """
    front.check(front_degrees)
    file_normals.check(normals)
    outputs.check_outputs([Path(output)], [mesh])
    source = mesh_io.read_surface(mesh, unit=unit, height_mm=height_mm, longest_mm=longest_mm, up=up)
    surface = source.surface.compacted()
    found = file_normals.find(mesh, surface, source.frame.placed) if normals == "file" else file_normals.COMPUTED
    smooth = display_map.vertex_normals(surface)[surface.triangles]
    vertex, triangles, at_vertices = parted_by(surface, surface.triangles, smooth, found.at_corners, found.parting)
    metadata = {
        "generator": f"quadgraph {__version__}",
        "source": source.metadata(),
        "unit_mm": source.unit_mm,
        "mesher": {"name": "none", "version": "", "options": "", "grading": None},
        "options": {"up": up},
        "repairs": [],
        "normals": found.metadata(),
        "levels": [],
        "front": front.azimuth(surface) if front_degrees is None else front_degrees,
        "tools": {"python": platform.python_version()},
    }
    qgraph_file.write(
        output,
        metadata,
        sections.display_alone(Surface(surface.vertices[vertex], triangles), at_vertices, found.texture),
    )
    return source
