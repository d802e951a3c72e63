"""Graphs with every tet cut into eight, and graphs of tets as they come."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from quadgraph.mesh.surface import TetMesh
from quadgraph.tets import graph
from quadgraph.tets.graph import Graph
from quadgraph.tets.tet_geometry import determinants


def refined(mesh: Graph, moved: Callable[[np.ndarray], np.ndarray] | None = None) -> Graph:
    """Cut every tet into eight and every outside face into four: the edge length halves everywhere.

    moved: from the new vertices on the surface (n, 3), mm, to where they go; None leaves the shape as it is.
    """
    vertices, tets = mesh.vertices, mesh.tets
    pairs = np.array([(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)])
    edges = np.sort(tets[:, pairs].reshape(-1, 2), axis=1)
    unique, inverse = np.unique(edges, axis=0, return_inverse=True)
    middles = vertices[unique].mean(axis=1)
    if moved:
        outside = np.sort(mesh.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        on_surface = np.isin(unique @ [len(vertices), 1], outside @ [len(vertices), 1])
        middles[on_surface] = moved(middles[on_surface])
    middle = len(vertices) + inverse.reshape(-1, 6)
    points = np.concatenate([vertices, middles])
    corners = [np.column_stack([tets[:, k], middle[:, (pairs == k).any(axis=1)]]) for k in range(4)]
    return oriented_graph(points, np.concatenate([*corners, *_octahedron(points, middle)]))


def oriented_graph(points: np.ndarray, tets: np.ndarray) -> Graph:
    """Round to what a file holds, turn every tet positive, link."""
    points = points.astype(np.float32).astype(np.float64)
    flipped = determinants(points, tets) < 0
    tets[flipped] = tets[flipped][:, [0, 1, 3, 2]]
    return graph.build(TetMesh(points, tets))


def _octahedron(points: np.ndarray, middle: np.ndarray) -> list[np.ndarray]:
    """Four tets around the shortest diagonal of the octahedron between the edge middles; others would degenerate."""
    rings = np.array([[0, 5, 1, 2, 4, 3], [1, 4, 0, 2, 5, 3], [2, 3, 0, 1, 5, 4]])  # diagonal, then the ring around it
    ends = points[middle[:, rings[:, :2]]]
    choice = rings[np.linalg.norm(ends[:, :, 0] - ends[:, :, 1], axis=2).argmin(axis=1)]
    ordered = np.take_along_axis(middle, choice, axis=1)
    return [ordered[:, [0, 1, 2 + k, 2 + (k + 1) % 4]] for k in range(4)]
