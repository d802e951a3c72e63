"""Small .qgraph files made from generated surfaces, without repair or decimation."""

from __future__ import annotations

from pathlib import Path

from quadgraph.file.graph_file import write
from quadgraph.mesh.surface import Surface
from quadgraph.tets import graph
from quadgraph.tets.tetrahedralise import tetrahedralise


def write_levels(path: Path, surfaces: list[Surface], rays: int = 0) -> Path:
    """Tetrahedralise each surface (finest first) and write them as the levels of a file; `rays` per face see others."""
    return write(path, [graph.build(tetrahedralise(surface, mesher="tetgen")) for surface in surfaces], rays)
