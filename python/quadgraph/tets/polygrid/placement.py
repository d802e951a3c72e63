"""Where the nodes of a polygrid lie in the body (Wang et al. 2008, section 5.1).

The polycube's boundary nodes are drawn to the surface on coarse grids first, while the cells between keep their shape
(`untangle`), so that they spread evenly and do not fold; each finer grid starts from the coarser one's shape. On the
finest they lie on the surface; their interior partners at a tenth of the spacing along the inward normal; the rest
where the variance of the lengths of each node's links is least.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.interpolate import RBFInterpolator
from scipy.sparse.linalg import factorized

from quadgraph.mesh import display_map
from quadgraph.mesh.surface import Surface
from quadgraph.tets.polygrid.lattice import MISSING, TetLattice
from quadgraph.tets.polygrid.untangle import Distortion, Pull, improve, untangle

PARTNER_SHARE = 0.1  # of the spacing between boundary nodes: depth of their interior neighbours
_PULLS = tuple(0.1 * 3.0**k for k in range(7))  # weights of the springs to the surface, one round after the other
_FINER_PULLS = (10.0, 100.0)
_EVENING = 10  # rounds in which boundary nodes move to the middle of their neighbours on the surface
_VARIANCE_STEPS = 30
_NEIGHBOURS = 24  # of the interpolation from a coarser grid


@dataclass(frozen=True, eq=False)
class Placed:
    """Positions (n, 3), mm, of a lattice's nodes, and what it took for cells that are not inverted.

    inverted: tets that were where the paper puts the nodes; moved: nodes that were moved for that, "" if none.
    """

    positions: np.ndarray
    inverted: int
    moved: str


class OnSurface:
    """The nearest points of a surface."""

    def __init__(self, surface: Surface) -> None:
        self.surface = surface
        self.normals = display_map.vertex_normals(surface)

    def nearest(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Nearest points (n, 3), mm, and unit outward normals (n, 3) there."""
        face, share = display_map.nearest_faces(points, self.surface)
        corners = self.surface.triangles[face]
        normals = np.einsum("ij,ijk->ik", share, self.normals[corners])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
        return np.einsum("ij,ijk->ik", share, self.surface.vertices[corners]), normals


def draw_to(
    surface: OnSurface, lattice: TetLattice, reference: np.ndarray, start: np.ndarray, coarsest: bool
) -> np.ndarray:
    """Positions with the boundary nodes near the surface and the cells near their shape in `reference` (n, 3), mm."""
    distortion = Distortion(reference, lattice.tets)
    positions, everywhere = start, np.ones(lattice.nodes, bool)
    boundary = np.arange(lattice.interior, lattice.nodes)
    for weight in _PULLS if coarsest else _FINER_PULLS:
        for _ in range(2):
            targets, _ = surface.nearest(positions[boundary])
            positions = improve(distortion, positions, everywhere, Pull(boundary, targets, weight))
    return positions


def refine(coarse: TetLattice, coarse_positions: np.ndarray, fine: TetLattice) -> np.ndarray:
    """Positions of a lattice of twice the resolution from those of the coarse one, smoothly in between."""
    known = 2 * coarse.positions
    count = min(_NEIGHBOURS, len(known))
    return RBFInterpolator(known, coarse_positions, neighbors=count, kernel="linear")(fine.positions)


def settle(surface: OnSurface, lattice: TetLattice, start: np.ndarray) -> Placed:
    """Nodes where the paper puts them, from positions whose boundary nodes are near the surface."""
    positions = start.copy()
    boundary, first = positions[lattice.interior :], lattice.interior
    neighbours = _neighbours(lattice.across - first, len(boundary))
    for _ in range(_EVENING):
        boundary, normals = surface.nearest(neighbours @ boundary)
    positions[first:] = boundary
    spacing = np.linalg.norm(boundary[lattice.across[:, 0] - first] - boundary[lattice.across[:, 1] - first], axis=1)
    local = (_incidence(lattice.across - first, len(boundary)) @ spacing)[:, None]
    positions[lattice.owners] = boundary - PARTNER_SHARE * local * normals
    fixed = np.zeros(lattice.nodes, bool)
    fixed[first:] = fixed[lattice.owners] = True
    positions = least_variance(lattice, positions, fixed)
    return _without_inversions(lattice, start, positions, fixed)


def _without_inversions(lattice: TetLattice, start: np.ndarray, positions: np.ndarray, fixed: np.ndarray) -> Placed:
    """Near inverted cells first the nodes deep inside move, then the partners too, then boundary nodes."""
    distortion = Distortion(start, lattice.tets)
    inverted = int((distortion.determinants(positions) <= 0).sum())
    inner = np.arange(lattice.nodes) < lattice.interior
    moved = ""
    for name, movable in (
        ("inner nodes", ~fixed),
        ("inner nodes and partners of boundary nodes", inner),
        ("inner nodes, partners of boundary nodes and boundary nodes", np.ones(lattice.nodes, bool)),
    ):
        if distortion.determinants(positions).min() > 0:
            break
        positions, moved = untangle(distortion, positions, movable), name
    return Placed(positions, inverted, moved)


def _neighbours(across: np.ndarray, count: int) -> sparse.csr_matrix:
    """(count, count) mean over the nodes across an edge, rows of the mean and the node itself in equal parts."""
    rows, columns = np.concatenate([across, across[:, ::-1]]).T
    matrix = sparse.csr_matrix((np.ones(len(rows)), (rows, columns)), shape=(count, count))
    degree = np.asarray(matrix.sum(axis=1)).ravel()
    return 0.5 * (sparse.diags(1 / degree) @ matrix + sparse.identity(count))


def _incidence(across: np.ndarray, count: int) -> sparse.csr_matrix:
    """(count, edges) mean over the edges at each node."""
    edge = np.arange(len(across))
    rows, columns = np.concatenate([across[:, 0], across[:, 1]]), np.concatenate([edge, edge])
    matrix = sparse.csr_matrix((np.ones(len(rows)), (rows, columns)), shape=(count, len(across)))
    return sparse.diags(1 / np.asarray(matrix.sum(axis=1)).ravel()) @ matrix


def pairs_of(lattice: TetLattice) -> np.ndarray:
    """(k, 2) pairs of linked nodes, smaller number first, each once."""
    rows = np.repeat(np.arange(lattice.interior), 6)
    links = lattice.links.ravel()
    pairs = np.stack([rows, links], axis=1)[links != MISSING]
    return np.unique(np.sort(pairs, axis=1), axis=0)


def least_variance(
    lattice: TetLattice, positions: np.ndarray, fixed: np.ndarray, steps: int = _VARIANCE_STEPS
) -> np.ndarray:
    """Interior nodes where the sum over nodes of the variance of their links' lengths is least, `fixed` ones held.

    By majorisation (SMACOF): with every link's wanted length the mean of those at its ends, the sum of squares of the
    differences falls with each solution of one system of linear equations, that of the plain graph's Laplacian; after
    none of them each node is in the middle of its neighbours.
    """
    pairs = pairs_of(lattice)
    count = len(positions)
    edge = np.arange(len(pairs))
    ends = sparse.csr_matrix(
        (np.repeat([1.0, -1.0], len(pairs)), (np.concatenate([edge, edge]), pairs.T.ravel())), shape=(len(pairs), count)
    )
    laplacian = (ends.T @ ends).tocsc()
    free = np.flatnonzero(~fixed)
    if not len(free):
        return positions
    solve = factorized(laplacian[free][:, free])
    held = laplacian[free][:, np.flatnonzero(fixed)] @ positions[fixed]
    of_node = _incidence(pairs, count)
    result = positions.copy()
    wanted = np.zeros((len(pairs), 3))
    for _ in range(1 + steps):
        right = (ends.T @ wanted)[free] - held
        result[free] = np.stack([solve(np.ascontiguousarray(right[:, k])) for k in range(3)], axis=1)
        offset = ends @ result
        length = np.linalg.norm(offset, axis=1)
        mean = of_node @ length
        target = 0.5 * (mean[pairs[:, 0]] + mean[pairs[:, 1]])
        wanted = offset * (target / np.maximum(length, 1e-12))[:, None]
    return result
