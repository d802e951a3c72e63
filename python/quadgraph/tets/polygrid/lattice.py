"""The polygrid of a polycube before it has a shape: nodes, links, and the tets between the nodes.

Every fine cell of the polycube, n x n x n of them in a cube, is an interior node. Those on the polycube's surface have
one boundary node each: on an edge or a corner of the polycube, where a cell has two or three outside faces, their
nodes are merged, so that each boundary node has one interior neighbour and each interior node at most one boundary node
(the paper removes nodes there for the same end). An interior node has six links, in three pairs of opposite ones:
 - inside, and under a face of the polycube: the six neighbours across the cell's faces, one of them the boundary node;
 - under an edge: along the edge; to the two neighbours inwards, which the body's smooth surface will have on opposite
   sides; to the boundary node and, opposite to it, to the cell across the inner edge. That last link goes one way;
 - under a corner: to the boundary node and the cell across the inner corner, one way; to the three inner neighbours;
   the sixth is missing and names the node itself.

Tets: around every corner of cells the nodes of the solid ones and the boundary nodes there span a polyhedron, a
hexahedron wherever the grid is regular. Its faces are polygons around the lattice's edges, cut from their first vertex
in one order of all nodes, and the polyhedron is cut from its first vertex, so that neighbours agree.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

_BLOCK = np.array(list(product((0, 1), repeat=3)))  # cell number 4 x + 2 y + z of a 2x2x2 block
# The four cells of a block around each of the six half-edges from its centre, counter-clockwise seen from outside.
_TURN = ((0, 0), (1, 0), (1, 1), (0, 1))
MISSING = -1


@dataclass(frozen=True, eq=False)
class TetLattice:
    """Nodes of a polygrid: interior ones first, then the boundary nodes.

    cells: (n_i, 3) int64, the fine cell of each interior node; owners: (n_b,) int64, the interior neighbour of each
    boundary node; outward: (n_b, 3) int64, sum of the outward directions of the owner's outside faces;
    links: (n_i, 6) int64 node numbers in pairs (0, 1), (2, 3), (4, 5) of opposite ones, MISSING where there is none;
    tets: (n_t, 4) int64, positively oriented; across: (n_e, 2) int64 node pairs, smaller first: edges between boundary
    nodes.
    """

    cells: np.ndarray
    owners: np.ndarray
    outward: np.ndarray
    links: np.ndarray
    tets: np.ndarray
    across: np.ndarray

    @property
    def interior(self) -> int:
        """How many interior nodes there are."""
        return len(self.cells)

    @property
    def nodes(self) -> int:
        """How many nodes there are."""
        return len(self.cells) + len(self.owners)

    @property
    def positions(self) -> np.ndarray:
        """(n, 3) positions in the polycube, in cells: centres, and half a cell outwards from them."""
        centres = self.cells + 0.5
        return np.concatenate([centres, centres[self.owners] + 0.5 * self.outward])


def build(solid: np.ndarray, resolution: int) -> TetLattice:
    """The lattice of a polycube, `resolution` >= 2 cells along a cube's side; its surface must be a manifold."""
    fine = np.pad(solid, 1)
    for axis in range(3):
        fine = np.repeat(fine, resolution, axis=axis)
    cells = np.argwhere(fine)
    number = np.full(fine.shape, MISSING)
    number[tuple(cells.T)] = np.arange(len(cells))
    around = np.stack(
        [number[tuple((cells + side * np.eye(3, dtype=int)[axis]).T)] for axis in range(3) for side in (-1, 1)], axis=1
    )
    outward = (around[:, 1::2] == MISSING).astype(int) - (around[:, ::2] == MISSING)
    owners = np.flatnonzero(outward.any(axis=1))
    boundary = np.full(len(cells), MISSING)
    boundary[owners] = len(cells) + np.arange(len(owners))
    links = _links(number, cells, around, outward, boundary)
    tets, across = _tets(number, cells, boundary)
    return TetLattice(cells, owners, outward[owners], links, tets, across)


def _links(
    number: np.ndarray, cells: np.ndarray, around: np.ndarray, outward: np.ndarray, boundary: np.ndarray
) -> np.ndarray:
    links = around.copy()
    sides = np.abs(outward).sum(axis=1)
    for row in np.flatnonzero(sides == 1):
        links[row][links[row] == MISSING] = boundary[row]
    for row in np.flatnonzero(sides > 1):
        inwards = [around[row, 2 * axis + (outward[row, axis] < 0)] for axis in np.flatnonzero(outward[row])]
        diagonal = number[tuple(cells[row] - outward[row])]
        if sides[row] == 2:
            along = int(np.flatnonzero(outward[row] == 0)[0])
            links[row] = [*around[row, 2 * along : 2 * along + 2], *inwards, boundary[row], diagonal]
        else:
            links[row] = [boundary[row], diagonal, *inwards, MISSING]
    return links


def _tets(number: np.ndarray, cells: np.ndarray, boundary: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    corners = [n - 1 for n in number.shape]
    code = np.zeros(corners, int)
    for bit, (i, j, k) in enumerate(_BLOCK):
        code |= (number[i : i + corners[0], j : j + corners[1], k : k + corners[2]] >= 0).astype(int) << bit
    parity = np.indices(corners).sum(axis=0) % 2
    tets, across = [], []
    for pattern in np.unique(code[code > 0]):
        for odd in (0, 1):
            places = np.argwhere((code == pattern) & (parity == odd))
            template, edges = _template(int(pattern), odd)
            if not len(places):
                continue
            inner = np.stack([number[tuple((places + offset).T)] for offset in _BLOCK], axis=1)
            nodes = np.concatenate([inner, np.where(inner >= 0, boundary[inner], MISSING)], axis=1)
            tets.append(nodes[:, template].reshape(-1, 4))
            across.append(nodes[:, edges].reshape(-1, 2))
    return np.concatenate(tets), np.unique(np.sort(np.concatenate(across), axis=1), axis=0)


def _template(pattern: int, odd: int) -> tuple[np.ndarray, np.ndarray]:
    """Tets (n, 4) and edges of the outside polygon (m, 2) around a corner whose solid cells are the bits of `pattern`.

    Cell c of the block is c, its boundary node 8 + c. Cells of even sum come first in the order that cuts, so that the
    diagonals of a regular grid alternate; `odd`: the sum of the block's first cell.
    """
    rank = {c: (0, (int(_BLOCK[c].sum()) + odd) % 2, c) for c in range(8)}
    rank |= {8 + c: (1, *rank[c][1:]) for c in range(8)}
    faces, outside = [], {}
    for axis, side in product(range(3), (0, 1)):
        ring = [_cell(axis, side, turn) for turn in (_TURN if side else _TURN[::-1])]
        polygon, gap = _polygon(ring, pattern)
        if gap is not None and gap[0] != gap[1]:
            outside[gap[1]] = gap[0]
        faces.append(polygon)
    faces.append(_cycle(outside))
    faces = [face for face in faces if len(face) > 2]
    if not faces:
        return np.empty((0, 4), int), np.empty((0, 2), int)
    apex = min((v for face in faces for v in face), key=rank.__getitem__)
    tets = [(apex, *triangle) for face in faces if apex not in face for triangle in _fan(face, rank)]
    # Where two faces share a triangle, the two tets on it are one and its mirror image: they cancel.
    corners = [frozenset(tet) for tet in tets]
    tets = [tet for tet, same in zip(tets, corners, strict=True) if corners.count(same) == 1]
    edges = list(outside.items())
    return np.array(tets, int).reshape(-1, 4), np.array(edges, int).reshape(-1, 2)


def _cell(axis: int, side: int, turn: tuple[int, int]) -> int:
    place = [0, 0, 0]
    place[axis], place[(axis + 1) % 3], place[(axis + 2) % 3] = side, *turn
    return 4 * place[0] + 2 * place[1] + place[2]


def _polygon(ring: list[int], pattern: int) -> tuple[list[int], tuple[int, int] | None]:
    """The solid cells of a ring of four, with the boundary nodes beside the gap between them, if there is one."""
    solid = [bool(pattern >> c & 1) for c in ring]
    if all(solid) or not any(solid):
        return (ring if all(solid) else []), None
    start = next(i for i in range(4) if solid[i] and not solid[i - 1])
    kept = [ring[(start + i) % 4] for i in range(4) if solid[(start + i) % 4]]
    gap = (8 + kept[-1], 8 + kept[0])
    return ([*kept, *gap] if len(kept) > 1 else []), gap


def _cycle(following: dict[int, int]) -> list[int]:
    if len(following) < 3:
        return []
    cycle = [next(iter(following))]
    while following[cycle[-1]] != cycle[0]:
        cycle.append(following[cycle[-1]])
    return cycle


def _fan(face: list[int], rank: dict[int, tuple]) -> list[tuple[int, int, int]]:
    first = face.index(min(face, key=rank.__getitem__))
    turned = face[first:] + face[:first]
    return [(turned[0], turned[k], turned[k + 1]) for k in range(1, len(turned) - 1)]
