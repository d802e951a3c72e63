"""Graphs that were made without a mesh file, written as a .qgraph."""

from __future__ import annotations

from pathlib import Path

from quadgraph.file import qgraph_file, sections
from quadgraph.mesh.surface import Surface
from quadgraph.tets import exchange
from quadgraph.tets.graph import Graph


def write(path: Path, graphs: list[Graph], rays: int = 0) -> Path:
    """Write levels, finest first, as a .qgraph with the finest boundary as the display mesh.

    rays: per face, that tell what the faces of a level see of each other; 0: that is left out.
    """
    boundary = graphs[0].boundary
    used = int(boundary.triangles.max()) + 1
    display = Surface(boundary.vertices[:used], boundary.triangles)
    metadata = {
        "generator": "quadgraph.file.graph_file",
        "source": {"name": "generated", "sha256": "", "vertices": 0, "triangles": 0},
        "unit_mm": 1.0,
        "mesher": {"name": "generated", "version": "", "options": "", "grading": None},
        "repairs": [],
        "levels": [sections.level_metadata(g) for g in graphs],
        "tools": {},
    }
    qgraph_file.write(path, metadata, sections.whole_file(graphs, display, exchange.bake(graphs, rays)))
    return path
