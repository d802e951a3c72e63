"""A polycube of the same topology as a surface, from a coarse solid voxelisation of it.

The paper's (Wang et al. 2008, section 5.1) is assembled by hand. Here cubes lie on a lattice and are solid where the
body takes up enough of them; what is not a manifold is filled up, and the first lattice and threshold are taken whose
cubes have as many pieces and handles as the surface. Thinner parts than that are reached cube by cube, as long as the
topology stays.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import trimesh
from scipy import ndimage

from quadgraph.base.errors import InputError, ToolError
from quadgraph.mesh.surface import Surface

FEWEST, MOST = 2, 32  # cubes along the longest side
DEFAULT_CUBES = 8
_SAMPLES = 4  # along each side of a cube
_THRESHOLDS = (0.5, 0.4, 0.6, 0.3, 0.7)  # share of a cube that makes it solid
_FAR = 0.5  # of a cube's side: what is farther from all cubes is to be reached by more
_TRIALS = 6  # lattices tried where the number of cubes is not given
_BLOCK = np.array(list(product((0, 1), repeat=3)))


@dataclass(frozen=True, eq=False)
class Polycube:
    """Cubes of side `edge` mm: cube (i, j, k) is solid[i, j, k] and lies between origin + (i, j, k) edge and the next.

    left_out: solid cubes apart from the body's pieces, which were dropped.
    """

    solid: np.ndarray
    origin: np.ndarray
    edge: float
    left_out: int = 0

    @property
    def count(self) -> int:
        """Solid cubes."""
        return int(self.solid.sum())


def build(surface: Surface, cubes: int | None = None) -> Polycube:
    """The polycube of a closed 2-manifold, mm; `cubes` along its longest side, None for about DEFAULT_CUBES.

    Raises InputError for a bad number, ToolError where no lattice that was tried keeps the topology, saying what came
    out instead.
    """
    if cubes is not None and not FEWEST <= cubes <= MOST:
        raise InputError(f"cubes: {cubes} found, {FEWEST} to {MOST} allowed")
    tried = [cubes] if cubes else range(DEFAULT_CUBES, DEFAULT_CUBES + _TRIALS)
    body = trimesh.Trimesh(surface.vertices, surface.triangles, process=False)
    found = []
    for number in tried:
        inside, origin, edge = _samples(body, surface, number)
        shares = _blocks(inside).mean(axis=(1, 3, 5))
        for threshold in _THRESHOLDS:
            solid = manifold(shares >= threshold, shares)
            solid, left_out = _largest(solid, surface.components)
            pieces, genus = topology(solid)
            if (pieces, genus) == (surface.components, surface.genus):
                return Polycube(_grown(solid, inside, shares), origin, edge, left_out)
            found.append(f"{pieces} and {genus} of {number}")
    raise ToolError(
        f"polygrid: no polycube with the body's {surface.components} pieces and {surface.genus} handles; "
        f"pieces and handles of those tried, by cubes along the longest side: {', '.join(dict.fromkeys(found))}; "
        "another number of cubes may have them"
    )


def _samples(body: trimesh.Trimesh, surface: Surface, cubes: int) -> tuple[np.ndarray, np.ndarray, float]:
    """Which of _SAMPLES^3 points in each cube lie in the body, with one empty layer of cubes around it; origin and side
    of the lattice, mm.
    """
    low, size = surface.vertices.min(axis=0), np.ptp(surface.vertices, axis=0)
    edge = float(size.max()) / cubes
    counts = np.maximum(np.rint(size / edge).astype(int), 1) + 2
    origin = low + 0.5 * size - 0.5 * counts * edge
    steps = [(np.arange(n * _SAMPLES) + 0.5) * edge / _SAMPLES for n in counts]
    points = origin + np.stack(np.meshgrid(*steps, indexing="ij"), axis=-1).reshape(-1, 3)
    return body.contains(points).reshape(_SAMPLES * counts), origin, edge


def _blocks(samples: np.ndarray) -> np.ndarray:
    """(n_x, s, n_y, s, n_z, s) samples of each cube."""
    return samples.reshape([part for n in samples.shape for part in (n // _SAMPLES, _SAMPLES)])


def _grown(solid: np.ndarray, inside: np.ndarray, shares: np.ndarray) -> np.ndarray:
    """`solid` with cubes at its surface, fullest first, that hold parts of the body far from it and whose addition
    keeps the topology.
    """
    wanted, refused = topology(solid), np.zeros_like(solid)
    while True:
        fine = solid
        for axis in range(3):
            fine = np.repeat(fine, _SAMPLES, axis=axis)
        distance = ndimage.distance_transform_edt(~fine)
        far = _blocks(inside & (distance > _FAR * _SAMPLES)).any(axis=(1, 3, 5))
        candidates = np.argwhere(far & ndimage.binary_dilation(solid) & ~solid & ~refused)
        if not len(candidates):
            return solid
        best = tuple(candidates[np.argmax(shares[tuple(candidates.T)])])
        trial = solid.copy()
        trial[best] = True
        trial = manifold(trial, shares)
        if topology(trial) == wanted:
            solid = trial
        else:
            refused[best] = True


def manifold(solid: np.ndarray, shares: np.ndarray) -> np.ndarray:
    """`solid` with as many empty cubes filled, fullest first, as it takes for its surface to be a manifold."""
    solid = np.pad(solid, 1)
    shares = np.pad(shares, 1)
    while True:
        corners = bad_corners(solid)
        if not len(corners):
            return solid[1:-1, 1:-1, 1:-1]
        for corner in corners:
            block = corner + _BLOCK
            empty = block[~solid[tuple(block.T)]]
            if not _two_sided(solid[tuple(block.T)]):
                best = empty[np.argmax(shares[tuple(empty.T)])]
                solid[tuple(best)] = True


def bad_corners(solid: np.ndarray) -> np.ndarray:
    """(n, 3) first cubes of the 2x2x2 blocks around whose corner the surface is no disk: solid or empty cubes of the
    block do not hang together through faces.
    """
    code = np.zeros([n - 1 for n in solid.shape], int)
    for bit, (i, j, k) in enumerate(_BLOCK):
        x, y, z = (slice(a, n - 1 + a) for a, n in zip((i, j, k), solid.shape, strict=True))
        code |= solid[x, y, z].astype(int) << bit
    return np.argwhere(~_DISK[code])


def _two_sided(block: Sequence[int]) -> bool:
    """Whether the solid and the empty ones of eight cubes each hang together."""
    cubes = np.asarray(block, bool).reshape(2, 2, 2)
    return ndimage.label(cubes)[1] <= 1 and ndimage.label(~cubes)[1] <= 1


_DISK = np.array([_two_sided([code >> bit & 1 for bit in range(8)]) for code in range(256)])


def _largest(solid: np.ndarray, pieces: int) -> tuple[np.ndarray, int]:
    """The `pieces` largest pieces of `solid`, and how many cubes the others have."""
    labels, count = ndimage.label(solid)
    if count <= pieces:
        return solid, 0
    size = np.bincount(labels.ravel())[1:]
    kept = np.isin(labels, 1 + np.argsort(-size, kind="stable")[:pieces])
    return kept, int(solid.sum() - kept.sum())


def topology(solid: np.ndarray) -> tuple[int, int]:
    """Pieces and handles of the surface of `solid`, which must be a manifold; cavities count as pieces."""
    padded = np.pad(solid, 1)
    pieces = ndimage.label(padded)[1] + ndimage.label(~padded)[1] - 1
    return pieces, pieces - euler(padded) // 2


def euler(solid: np.ndarray) -> int:
    """Vertices - edges + faces of the surface of `solid`, whose outermost layer is empty."""
    faces = sum(int(np.diff(solid.astype(int), axis=axis).astype(bool).sum()) for axis in range(3))
    code = np.zeros([n - 1 for n in solid.shape], int)
    for i, j, k in _BLOCK:
        x, y, z = (slice(a, n - 1 + a) for a, n in zip((i, j, k), solid.shape, strict=True))
        code += solid[x, y, z]
    vertices = int(((code > 0) & (code < 8)).sum())
    # Each face is a quadrilateral, each edge has two of them.
    return vertices - 2 * faces + faces
