"""Triangles cut at the middles of some of their edges, so that neighbours still meet and none becomes thin.

Where an edge is cut, the longest of each triangle at it is cut, too [Rivara 1984]: then the angles of all triangles
that ever come of one are at least half of its smallest.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from quadgraph.mesh.surface import Surface

# Triangles that a triangle becomes, as corners 0, 1, 2 and middles 3, 4, 5 of the edges that begin there, of which edge
# 0 is the longest: by whether edges 1 and 2 are cut besides it.
_CHILDREN = {
    (False, False): ((0, 3, 2), (3, 1, 2)),
    (True, False): ((0, 3, 2), (3, 1, 4), (3, 4, 2)),
    (False, True): ((0, 3, 5), (5, 3, 2), (3, 1, 2)),
    (True, True): ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
}
_PLACES = np.vstack([np.eye(3), [[0.5, 0.5, 0], [0, 0.5, 0.5], [0.5, 0, 0.5]]])  # of these six in the triangle


@dataclass(frozen=True, eq=False)
class Cut:
    """What triangles become: triangles (k, 3), the old one of each, and their corners in it, (k, 3, 3) barycentric.

    Whole ones come first, in their order.
    """

    triangles: np.ndarray
    parent: np.ndarray
    places: np.ndarray

    def carried(self, at_corners: np.ndarray) -> np.ndarray:
        """Values (m, 3, c) at the corners of the old triangles as those (k, 3, c) of the new ones."""
        return np.einsum("kij,kjc->kic", self.places, at_corners[self.parent])


def edge_lengths(surface: Surface) -> np.ndarray:
    """(e,) mm, by the topology."""
    ends = surface.vertices[surface.topology.edges]
    return np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)


def closed(surface: Surface, marked: np.ndarray) -> np.ndarray:
    """(e,) edges to cut where `marked` ones are: with the longest of each triangle that has one."""
    face_edges, longest = surface.topology.face_edges, _longest(surface)
    of_face = np.take_along_axis(face_edges, longest[:, None], axis=1)[:, 0]
    marked = marked.copy()
    while True:
        lacking = marked[face_edges].any(axis=1) & ~marked[of_face]
        if not lacking.any():
            return marked
        marked[of_face[lacking]] = True


def cut(surface: Surface, marked: np.ndarray) -> Cut:
    """Cut the triangles at `marked` edges (e,), which are `closed`; their middles are new vertices, in their order."""
    face_edges = surface.topology.face_edges
    middle = len(surface.vertices) + np.cumsum(marked) - 1
    turn = (_longest(surface)[:, None] + np.arange(3)) % 3
    points = np.concatenate([surface.triangles, middle[face_edges]], axis=1)
    points = np.take_along_axis(points, np.concatenate([turn, 3 + turn], axis=1), axis=1)
    is_cut = np.take_along_axis(marked[face_edges], turn, axis=1)
    whole = np.flatnonzero(~is_cut[:, 0])
    found = [(surface.triangles[whole], whole, np.tile(np.eye(3), (len(whole), 1, 1)))]
    for others, children in _CHILDREN.items():
        rows = np.flatnonzero(is_cut[:, 0] & (is_cut[:, 1:] == others).all(axis=1))
        unturned = np.argsort(turn[rows], axis=1)
        for child in children:
            places = np.take_along_axis(
                np.broadcast_to(_PLACES[list(child)], (len(rows), 3, 3)), unturned[:, None, :].repeat(3, axis=1), axis=2
            )
            found.append((points[rows][:, child], rows, places))
    return Cut(*(np.concatenate(each) for each in zip(*found, strict=True)))


def _longest(surface: Surface) -> np.ndarray:
    """(m,) which edge of each triangle is longest; of equal ones all triangles choose the same."""
    lengths = edge_lengths(surface)
    rank = np.empty(len(lengths), np.int64)
    rank[np.argsort(lengths, kind="stable")] = np.arange(len(lengths))
    return rank[surface.topology.face_edges].argmax(axis=1)
