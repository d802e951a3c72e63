"""How good a polygrid is: inverted and skewed cells, and what of the surface it does not reach."""

from __future__ import annotations

from typing import Any

import numpy as np

from quadgraph.mesh import display_map
from quadgraph.mesh.surface import Surface
from quadgraph.tets.graph import Graph
from quadgraph.tets.polygrid import weights
from quadgraph.tets.polygrid.polycube import Polycube


def offsets(graph: Graph) -> np.ndarray:
    """(n_i, 6, 3) from each node below the surface to its six neighbours, mm; zero for a missing link."""
    assert graph.grid_links is not None
    return graph.vertices[graph.grid_links] - graph.vertices[graph.surface_vertex_count :, None]


def report(graph: Graph, polycube: Polycube, cells: int, inverted: int, moved: str, surface: Surface) -> dict[str, Any]:
    """What there is to tell of the finest level, as plain values.

    inverted: tets that the paper's placement leaves inverted, of all; moved: which nodes were moved so that none is.
    skew_degrees: angle between links and the axes of their node's frame (Appendix B takes it for small);
    straight_weights: share of nodes whose weights are not those of Appendix B because one would not be positive;
    uncovered: share of the surface's area more than a cell away from the polygrid's; farthest_mm: the largest distance.
    """
    links = offsets(graph)
    angles = weights.skew(links)
    length = np.linalg.norm(links, axis=2)
    covered = length > 0
    distance = _distances(surface, graph)
    areas = np.linalg.norm(surface.doubled_normals, axis=1)
    cell = polycube.edge / cells
    far = distance[surface.triangles].max(axis=1) > cell
    return {
        "cubes": polycube.count,
        "cells": cells,
        "cube_mm": polycube.edge,
        "cubes_left_out": polycube.left_out,
        "nodes": len(graph.vertices),
        "boundary_nodes": graph.surface_vertex_count,
        "inverted": inverted,
        "tets": len(graph.tets),
        "moved": moved,
        "skew_degrees": {
            "mean": float(angles[covered].mean()),
            "percentile_95": float(np.percentile(angles[covered], 95)),
            "max": float(angles[covered].max()),
        },
        "straight_weights": float(weights.laplacian(links)[1].mean()),
        "uncovered": float(areas[far].sum() / areas.sum()),
        "farthest_mm": float(distance.max()),
        "volume_share": graph.volume / surface.volume,
    }


def _distances(surface: Surface, graph: Graph) -> np.ndarray:
    """(n,) from each vertex of the surface to the polygrid's outside faces, mm."""
    face, share = display_map.nearest_faces(surface.vertices, graph.boundary)
    reached = np.einsum("ij,ijk->ik", share, graph.boundary.corners[face])
    return np.linalg.norm(reached - surface.vertices, axis=1)


def sentences(found: dict[str, Any]) -> list[str]:
    """The report in words."""
    skew = found["skew_degrees"]
    lines = [
        f"polygrid: {found['cubes']:,} cubes of {found['cells']}^3 cells, {found['nodes']:,} nodes, "
        f"{found['boundary_nodes']:,} of them on the surface",
        f"links are {skew['mean']:.1f} degrees from their axes on average, 5% more than {skew['percentile_95']:.0f}, "
        f"the worst {skew['max']:.0f}; {100 * found['straight_weights']:.1f}% of the nodes have no positive weights of "
        "their own",
        f"{100 * found['uncovered']:.2f}% of the surface is more than a cell away, the farthest point "
        f"{found['farthest_mm']:.2f} mm; the volume is {100 * found['volume_share']:.2f}% of the body's",
    ]
    if found["moved"]:
        lines.append(
            f"{found['inverted']:,} of {found['tets']:,} tets were inverted where the paper puts the nodes: moved were "
            f"{found['moved']}"
        )
    if found["cubes_left_out"]:
        lines.append(f"{found['cubes_left_out']} cubes apart from the body's pieces were left out")
    return lines
