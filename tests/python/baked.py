"""Small .qgraph files made from generated surfaces, without repair or decimation."""

from __future__ import annotations

from pathlib import Path

from quadgraph import graph
from quadgraph.reference.meshes import face_frames, write
from quadgraph.surface import Surface
from quadgraph.tetrahedralise import tetrahedralise

__all__ = ["face_frames", "write_levels"]


def write_levels(path: Path, surfaces: list[Surface], rays: int = 0) -> Path:
    """Tetrahedralise each surface (finest first) and write them as the levels of a file; `rays` per face see others."""
    return write(path, [graph.build(tetrahedralise(surface, mesher="tetgen")) for surface in surfaces], rays)
