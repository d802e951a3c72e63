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
    inner = graph.inner
    for _ in range(steps):
        target = inner + _push(graph, inner)
        inner = _held_inside(corners.mean(axis=1), barycentric(gradients, target - corners[:, 0]), target)
    return replace(graph, inner=inner)


def _offsets(graph: Graph, inner: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """From each linked node to each inner node (n_t, 4, 3), mm, and their lengths (n_t, 4)."""
    nodes = np.concatenate([inner, graph.surface])
    offset = inner[:, None] - nodes[graph.links]
    return offset, np.linalg.norm(offset, axis=2)


def _push(graph: Graph, inner: np.ndarray) -> np.ndarray:
    offset, length = _offsets(graph, inner)
    typical = length.mean(axis=1)
    # A surface node's radius is that of its one inner node.
    of_nodes = np.concatenate([typical, typical[graph.face_tets]])
    radius = 0.5 * (typical[:, None] + of_nodes[graph.links])
    missing = np.maximum(radius - length, 0) / np.maximum(length, np.finfo(float).tiny)
    return _STRENGTH * np.einsum("ij,ijk->ik", missing, offset)


def _held_inside(centroid: np.ndarray, coordinates: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Shorten the way from the centroid to `target` so that no barycentric coordinate falls below the margin."""
    share = (0.25 - _MARGIN) / np.maximum(0.25 - coordinates.min(axis=1), np.finfo(float).tiny)
    return centroid + np.minimum(share, 1)[:, None] * (target - centroid)


def link_length_variation(graph: Graph) -> dict[str, float]:
    """Coefficients of variation of the link lengths: "overall", and "local", each over its nodes' mean length."""
    _, length = _offsets(graph, graph.inner)
    typical = length.mean(axis=1)
    of_nodes = np.concatenate([typical, typical[graph.face_tets]])
    relative = length / (0.5 * (typical[:, None] + of_nodes[graph.links]))
    return {
        "overall": float(length.std() / length.mean()),
        "local": float(relative.std() / relative.mean()),
    }
