"""From a surface to the levels of a polygrid, as graphs whose tet vertices are the polygrid's nodes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from quadgraph.base.errors import InputError, ToolError
from quadgraph.base.version import __version__
from quadgraph.mesh.surface import MesherInfo, Surface, TetMesh
from quadgraph.tets import graph, ordering
from quadgraph.tets.graph import Graph
from quadgraph.tets.polygrid import grid_report, lattice, placement, polycube
from quadgraph.tets.polygrid.lattice import MISSING, TetLattice
from quadgraph.tets.polygrid.placement import OnSurface
from quadgraph.tets.polygrid.untangle import Distortion, untangle
from quadgraph.tets.tet_geometry import determinants
from quadgraph.tets.tet_rounding import round_to_float32

COARSEST = 2  # cells along a cube's side
DEFAULT_CELLS = 4
MOST_CELLS = 32
_DRAWN = 4  # cells up to which the whole grid is drawn to the surface; finer ones interpolate its shape


@dataclass(frozen=True)
class Polygrid:
    """Levels, finest first, and the report of the finest (`quality.report`)."""

    graphs: list[Graph]
    mesher: MesherInfo
    report: dict[str, Any]


def build(
    surface: Surface,
    cubes: int | None = None,
    cells: int | None = None,
    levels: int | None = None,
    progress: Callable[[str], None] | None = None,
) -> Polygrid:
    """The polygrid of a closed 2-manifold, mm: `cubes` along its longest side, `cells`^3 in each on the finest level.

    Every further level has half the cells, its interior nodes in the middle of their eight children, down to 2; at most
    `levels`. Raises InputError for a bad option, ToolError where no polycube keeps the topology and where cells stay
    inverted.
    """
    cells = DEFAULT_CELLS if cells is None else cells
    if not COARSEST <= cells <= MOST_CELLS or cells & (cells - 1):
        raise InputError(f"cells: {cells} found, allowed are 2, 4, 8, 16 and 32")
    tell = progress or (lambda text: None)
    cube = polycube.build(surface, cubes)
    tell(f"polycube: {cube.count} cubes of {cube.edge:.3g} mm")
    on_surface = OnSurface(surface)
    chain = _drawn(cube, cells, on_surface, tell)
    finest, start = chain[-1]
    placed = placement.settle(on_surface, finest, start)
    tell(f"{finest.nodes:,} nodes placed")
    positions, all_levels = placed.positions, [finest, *(grid for grid, _ in chain[-2::-1])][:levels]
    graphs = []
    for number, grid in enumerate(all_levels):
        if number:
            positions = averaged(all_levels[number - 1], positions, grid, on_surface)
        graphs.append(as_graph(grid, positions, number))
    report = grid_report.report(graphs[0], cube, cells, placed.inverted, placed.moved, surface)
    options = f"{cube.count} cubes of {cells}^3 cells, {max(cube.solid.shape) - 2} along the longest side"
    return Polygrid(graphs, MesherInfo("polygrid", __version__, options), report)


def _drawn(
    cube: polycube.Polycube, cells: int, surface: OnSurface, tell: Callable[[str], None]
) -> list[tuple[TetLattice, np.ndarray]]:
    """Lattices from the coarsest to the finest, with positions near the surface."""
    chain: list[tuple[TetLattice, np.ndarray]] = []
    count = COARSEST
    while count <= cells:
        grid = lattice.build(cube.solid, count)
        reference = cube.origin + (grid.positions / count - 1) * cube.edge
        start = placement.refine(*chain[-1], grid) if chain else reference
        if count <= _DRAWN:
            start = placement.draw_to(surface, grid, reference, start, not chain)
            tell(f"{grid.nodes:,} nodes drawn to the surface")
        chain.append((grid, start))
        count *= 2
    return chain


def averaged(fine: TetLattice, positions: np.ndarray, coarse: TetLattice, surface: OnSurface) -> np.ndarray:
    """Interior nodes in the middle of their children, boundary nodes of theirs, on the surface."""
    parent = _rows_of(coarse.cells, fine.cells // 2)
    boundary = np.full(coarse.interior, MISSING)
    boundary[coarse.owners] = coarse.interior + np.arange(len(coarse.owners))
    parent = np.concatenate([parent, boundary[parent[fine.owners]]])
    count = np.bincount(parent, minlength=coarse.nodes)
    sums = np.stack([np.bincount(parent, positions[:, k], coarse.nodes) for k in range(3)], axis=1)
    result = sums / count[:, None]
    result[coarse.interior :], _ = surface.nearest(result[coarse.interior :])
    return _upright(coarse, result)


def _upright(grid: TetLattice, positions: np.ndarray) -> np.ndarray:
    """No cell inverted: interior nodes near those that are move, then boundary nodes."""
    distortion = Distortion(grid.positions, grid.tets)
    inner = np.arange(grid.nodes) < grid.interior
    for movable in (inner, np.ones(grid.nodes, bool)):
        if determinants(positions, grid.tets).min() > 0:
            break
        positions = untangle(distortion, positions, movable)
    return positions


def _rows_of(cells: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """(m,) the row of `cells` (n, 3) that each of (m, 3) `wanted` is."""
    shape = cells.max(axis=0) + 1
    keys = np.ravel_multi_index(cells.T, shape)
    order = np.argsort(keys)
    return order[np.searchsorted(keys[order], np.ravel_multi_index(wanted.T, shape))]


def as_graph(grid: TetLattice, positions: np.ndarray, number: int = 0) -> Graph:
    """A lattice's tets as a graph with `grid_links`, vertices in order of their layers below the surface.

    Raises ToolError naming level `number` if tets are inverted.
    """
    inverted = int((determinants(positions, grid.tets) <= 0).sum())
    if inverted:
        raise ToolError(
            f"polygrid: {inverted} of {len(grid.tets)} tets of level {number} stay inverted; another number of cubes "
            "may fit the body better"
        )
    vertices = round_to_float32(positions, grid.tets, 0)
    built = graph.build(TetMesh(vertices, grid.tets, MesherInfo("polygrid", __version__, "")))
    # Tets keep their places, so that they tell the new number of each node.
    renumbering = np.empty(grid.nodes, np.int64)
    renumbering[grid.tets] = built.tets
    links = np.where(grid.links == MISSING, np.arange(grid.interior)[:, None], grid.links)
    ordered = np.empty_like(links)
    ordered[renumbering[: grid.interior] - len(grid.owners)] = renumbering[links]
    return replace(built, grid_links=ordered)


def by_layers(grid: Graph) -> Graph:
    """A graph with its vertices in order of their layers, otherwise as they come."""
    assert grid.grid_links is not None
    return ordering.with_vertices(grid, np.argsort(layers(grid), kind="stable"))


def layers(grid: Graph) -> np.ndarray:
    """(n_v,) how many links each vertex is from the surface."""
    assert grid.grid_links is not None
    first = grid.surface_vertex_count
    layer = np.full(len(grid.vertices), -1)
    layer[:first] = 0
    depth = 0
    while (layer < 0).any():
        reached = (layer[grid.grid_links] == depth).any(axis=1) & (layer[first:] < 0)
        if not reached.any():
            raise ToolError("polygrid: some nodes are not linked to the surface")
        depth += 1
        layer[first:][reached] = depth
    return layer
