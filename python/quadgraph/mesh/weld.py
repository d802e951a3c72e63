"""Repairs that change no shape: joined vertices, dropped faces, and faces turned to look outward."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import breadth_first_order, connected_components
from scipy.spatial import cKDTree

from quadgraph.mesh.surface import Surface
from quadgraph.mesh.winding import winding_number


def merge_vertices(surface: Surface, tolerance_mm: float) -> tuple[Surface, int]:
    """Join vertices nearer than the tolerance (0: at the same position); also says how many went."""
    n = len(surface.vertices)
    if tolerance_mm > 0:
        pairs = cKDTree(surface.vertices).query_pairs(tolerance_mm, output_type="ndarray")
        graph = sparse.coo_matrix((np.ones(len(pairs), bool), (pairs[:, 0], pairs[:, 1])), shape=(n, n))
        _, label = connected_components(graph, directed=False)
    else:
        _, label = np.unique(surface.vertices + 0.0, axis=0, return_inverse=True)
        label = label.reshape(-1)
    # The first vertex of each group stands for it, so that a clean surface keeps its order.
    _, first = np.unique(label, return_index=True)
    kept, rank = np.unique(first[label], return_inverse=True)
    return Surface(surface.vertices[kept], rank.reshape(-1)[surface.triangles]), n - len(kept)


def drop_degenerate(surface: Surface) -> tuple[Surface, int]:
    """Drop triangles without area."""
    keep = (surface.doubled_normals != 0).any(axis=1)
    return Surface(surface.vertices, surface.triangles[keep]), int((~keep).sum())


def drop_duplicates(surface: Surface) -> tuple[Surface, int]:
    """Keep one of triangles over the same vertices, or none where as many look one way as the other (a flap)."""
    ordered = np.sort(surface.triangles, axis=1)
    _, first, group = np.unique(ordered, axis=0, return_index=True, return_inverse=True)
    group = group.reshape(-1)
    smallest = surface.triangles.argmin(axis=1)[:, None]
    turned = np.take_along_axis(surface.triangles, (smallest + np.arange(3)) % 3, axis=1)
    sense = np.where(turned[:, 1] < turned[:, 2], 1, -1)
    net = np.bincount(group, weights=sense, minlength=len(first))
    keep = np.zeros(len(surface.triangles), bool)
    for direction in (1, -1):
        _, chosen = np.unique(np.where(sense == direction, group, -1), return_index=True)
        chosen = chosen[sense[chosen] == direction]
        keep[chosen[net[group[chosen]] * direction > 0]] = True
    return Surface(surface.vertices, surface.triangles[keep]), int((~keep).sum())


def face_components(surface: Surface) -> np.ndarray:
    """(m,) label of the connected piece each triangle belongs to."""
    _, labels = np.unique(surface.vertex_components[1][surface.triangles[:, 0]], return_inverse=True)
    return labels.reshape(-1)


def drop_tiny_pieces(surface: Surface, area_share: float) -> tuple[Surface, int]:
    """Drop connected pieces with less than `area_share` of the whole area; says how many pieces went."""
    labels = face_components(surface)
    area = np.bincount(labels, weights=np.linalg.norm(surface.doubled_normals, axis=1))
    tiny = area < area_share * area.sum()
    return Surface(surface.vertices, surface.triangles[~tiny[labels]]), int(tiny.sum())


def orient(surface: Surface) -> tuple[Surface, int] | None:
    """Turn triangles so that neighbours agree and the whole looks outward; None if the surface is one-sided.

    surface: each edge with one or two triangles. Pieces inside another one (cavities) look into the cavity. Also says
    how many triangles were turned.
    """
    topology = surface.topology
    m = len(surface.triangles)
    order = np.argsort(topology.face_edges.ravel(), kind="stable")
    edge = topology.face_edges.ravel()[order]
    paired = np.flatnonzero(edge[1:] == edge[:-1])
    a, b = order[paired] // 3, order[paired + 1] // 3
    # Two triangles agree at an edge when they run along it in opposite directions.
    differ = topology.balance[edge[paired]] != 0
    # Twice as many nodes: triangle i as it is, and turned (m + i); a one-sided piece joins both to one component.
    rows, columns = np.concatenate([a, a + m]), np.concatenate([np.where(differ, b + m, b), np.where(differ, b, b + m)])
    graph = sparse.coo_matrix((np.ones(2 * len(a), bool), (rows, columns)), shape=(2 * m, 2 * m)).tocsr()
    count, label = connected_components(graph, directed=False)
    if (label[:m] == label[m:]).any():
        return None
    turn = np.zeros(m, bool)
    seen = np.zeros(count, bool)
    for face in np.unique(label[:m], return_index=True)[1]:
        if not seen[label[face]]:
            reached = breadth_first_order(graph, face, directed=False, return_predecessors=False)
            turn[reached[reached >= m] - m] = True
            seen[[label[face], label[face + m]]] = True
    consistent = _turned(surface, turn)
    outward = turn ^ _inward_pieces(consistent)
    return _turned(surface, outward), int(outward.sum())


def _turned(surface: Surface, which: np.ndarray) -> Surface:
    triangles = surface.triangles.copy()
    triangles[which] = triangles[which][:, ::-1]
    return Surface(surface.vertices, triangles)


def _inward_pieces(surface: Surface) -> np.ndarray:
    """(m,) whether a triangle's piece must be turned: by its volume's sign and how many pieces lie around it."""
    labels = face_components(surface)
    pieces = [Surface(surface.vertices, surface.triangles[labels == k]) for k in range(labels.max() + 1)]
    turn = np.zeros(len(pieces), bool)
    for k, piece in enumerate(pieces):
        inside = sum(abs(winding_number(other, piece.corners[0, 0])) > 0.5 for j, other in enumerate(pieces) if j != k)
        turn[k] = (piece.compacted().volume < 0) != (inside % 2 == 1)
    return turn[labels]
