"""A ball as a polygrid, one cube blown up; run as a script, this writes tests/data/polygrid.qgraph, two levels."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from quadgraph.file import qgraph_file, sections
from quadgraph.tets.graph import Graph
from quadgraph.tets.polygrid import build, lattice, placement
from tiny import metadata

PATH = Path(__file__).parents[1] / "data" / "polygrid.qgraph"
RADIUS = 10.0


class RoundSurface:
    """The sphere of radius RADIUS, without facets."""

    def nearest(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Nearest points and outward normals."""
        normals = points / np.linalg.norm(points, axis=1, keepdims=True)
        return RADIUS * normals, normals


def one_cube(cells: int) -> lattice.TetLattice:
    """The lattice of a single cube."""
    return lattice.build(np.ones((1, 1, 1), bool), cells)


def blown_up(grid: lattice.TetLattice) -> np.ndarray:
    """Positions of a cube's nodes in the ball, mm."""
    low, high = grid.positions.min(axis=0), grid.positions.max(axis=0)
    x, y, z = (2 * (grid.positions - low) / (high - low) - 1).T
    turns = (x, y, z), (y, z, x), (z, x, y)
    return RADIUS * np.stack([a * np.sqrt(1 - b**2 / 2 - c**2 / 2 + b**2 * c**2 / 3) for a, b, c in turns], axis=1)


def balls(cells: int, levels: int = 1) -> list[Graph]:
    """Levels of a ball of `cells`^3 cells, placed as the paper does, finest first; each ready for a file."""
    grid = one_cube(cells)
    placed = placement.settle(RoundSurface(), grid, blown_up(grid))
    assert placed.moved == ""
    graphs, positions = [build.as_graph(grid, placed.positions)], placed.positions
    for _ in range(levels - 1):
        cells //= 2
        coarse = one_cube(cells)
        positions = build.averaged(grid, positions, coarse, RoundSurface())
        grid = coarse
        graphs.append(build.as_graph(grid, positions))
    return [build.by_layers(graph) for graph in graphs]


def write(path: Path, graphs: list[Graph]) -> Path:
    """Write a file of these levels whose display mesh is the surface of the finest."""
    display = replace(graphs[0].boundary, triangles=graphs[0].faces).compacted()
    qgraph_file.write(path, metadata(graphs), sections.whole_file(graphs, display))
    return path


if __name__ == "__main__":
    write(PATH, balls(4, 2))
