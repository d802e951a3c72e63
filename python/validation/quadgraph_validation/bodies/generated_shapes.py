"""Bodies that the tables need and no file has: the double-hole donut, and a perforated shell for the Topmod ball."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import trimesh

from quadgraph.mesh.surface import Surface

Mesh = tuple[np.ndarray, np.ndarray]  # vertices (n, 3), triangles (m, 3)


def donut() -> Mesh:
    """Coarse cells of a slab with two holes: genus 2."""
    cells = np.ones((12, 7, 3), bool)
    cells[2:5, 2:5] = cells[7:10, 2:5] = False
    return _boundary(cells)


def perforated_shell() -> Mesh:
    """A thick spherical shell with four holes to each face of its cube: genus 23."""
    count, thickness = 10, 2
    cells = np.ones((count,) * 3, bool)
    inside = slice(thickness, count - thickness)
    cells[inside, inside, inside] = False
    for first in (slice(2, 4), slice(6, 8)):
        for second in (slice(2, 4), slice(6, 8)):
            cells[:, first, second] = cells[first, :, second] = cells[first, second, :] = False
    vertices, triangles = _boundary(cells)
    centred = vertices - count / 2
    radius = np.abs(centred).max(axis=1, keepdims=True)
    return centred * radius / np.linalg.norm(centred, axis=1, keepdims=True), triangles


GENERATED: dict[str, Callable[[], Mesh]] = {"donut": donut, "shell": perforated_shell}


def smooth(name: str, faces: int) -> Surface:
    """A body of GENERATED, its cells rounded by Loop subdivision until it has at least `faces` triangles; units are
    cells.
    """
    vertices, triangles = GENERATED[name]()
    steps = 2  # fewer leave corners
    while len(triangles) * 4**steps < faces:
        steps += 1
    return Surface(*trimesh.remesh.subdivide_loop(vertices.astype(float), triangles, iterations=steps))


def _boundary(cells: np.ndarray) -> Mesh:
    """Faces of cells (nx, ny, nz) bool that no other cell shares, two triangles each, outward; vertices on the grid."""
    full = np.pad(cells, 1)
    corners = []
    for axis in range(3):
        u, v = np.eye(3, dtype=int)[(axis + 1) % 3], np.eye(3, dtype=int)[(axis + 2) % 3]
        for side in (0, 1):
            outside = np.argwhere(full & ~np.roll(full, 1 - 2 * side, axis=axis)) - 1
            outside[:, axis] += side
            around = (0 * u, u, u + v, v) if side else (0 * u, v, u + v, u)
            corners.append(outside[:, None, :] + np.array(around)[None])
    quads = np.concatenate(corners)
    vertices, index = np.unique(quads.reshape(-1, 3), axis=0, return_inverse=True)
    index = index.reshape(-1, 4)
    return vertices, np.concatenate([index[:, [0, 1, 2]], index[:, [0, 2, 3]]])
