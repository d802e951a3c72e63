"""Even spreading of the inner nodes (QuadGraph paper, section 4.1, after Turk 1991): linked nodes repel each other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from quadgraph.tets.graph import Graph, barycentric, barycentric_gradients

DEFAULT_STEPS = 16  # where the unlit side of a sphere is nearest to the closed form (quadgraph-fdm)
_STRENGTH = 0.25  # share of the missing distance that one link makes up in one step
_MARGIN = 0.05  # smallest barycentric coordinate of a node in its tet; the centroid has 0.25


def relax(graph: Graph, steps: int) -> Graph:
    """Move the inner nodes for `steps` steps; each stays strictly inside its tet, surface nodes stay where they are.

    A link shorter than the mean of its two nodes' typical link lengths pushes them apart, as Turk's points do within
    their radius of repulsion; the typical length is local, since the tets are graded.
    """
    corners = graph.vertices[graph.tets]
    gradients = barycentric_gradients(corners)
    inner, centroid, first = graph.inner, corners.mean(axis=1), np.ascontiguousarray(corners[:, 0])
    for _ in range(steps):
        target = inner + _push(graph, inner)
        inner = _held_inside(centroid, barycentric(gradients, target - first), target)
    return replace(graph, inner=inner)


def _offsets(graph: Graph, inner: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """From each linked node to each inner node (n_t, 4, 3), mm, and their lengths (n_t, 4)."""
    nodes = np.concatenate([inner, graph.surface])
    offset = inner[:, None] - nodes[graph.links]
    x, y, z = (offset[:, :, k] for k in range(3))
    return offset, np.sqrt(x * x + y * y + z * z)


def _typical(length: np.ndarray) -> np.ndarray:
    """Mean of each row of four, by columns: NumPy takes an axis of four entry by entry."""
    a, b, c, d = length.T
    return (a + b + c + d) / 4


def _push(graph: Graph, inner: np.ndarray) -> np.ndarray:
    offset, length = _offsets(graph, inner)
    typical = _typical(length)
    # A surface node's radius is that of its one inner node.
    of_nodes = np.concatenate([typical, typical[graph.face_tets]])
    radius = 0.5 * (typical[:, None] + of_nodes[graph.links])
    missing = np.maximum(radius - length, 0) / np.maximum(length, np.finfo(float).tiny)
    return _STRENGTH * np.einsum("ij,ijk->ik", missing, offset)


def _held_inside(centroid: np.ndarray, coordinates: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Shorten the way from the centroid to `target` so that no barycentric coordinate falls below the margin."""
    a, b, c, d = coordinates.T
    smallest = np.minimum(np.minimum(a, b), np.minimum(c, d))
    share = (0.25 - _MARGIN) / np.maximum(0.25 - smallest, np.finfo(float).tiny)
    return centroid + np.minimum(share, 1)[:, None] * (target - centroid)


def link_length_variation(graph: Graph) -> dict[str, float]:
    """Coefficients of variation of the link lengths: "overall", and "local", each over its nodes' mean length."""
    _, length = _offsets(graph, graph.inner)
    typical = _typical(length)
    of_nodes = np.concatenate([typical, typical[graph.face_tets]])
    relative = length / (0.5 * (typical[:, None] + of_nodes[graph.links]))
    return {
        "overall": float(length.std() / length.mean()),
        "local": float(relative.std() / relative.mean()),
    }
