"""Surfaces of blocks around the origin."""

from __future__ import annotations

import numpy as np

from quadgraph.mesh.surface import Surface


def surface(sides: np.ndarray, per_mm: float) -> Surface:
    """A block of `sides` (3,) mm around the origin, of so many pairs of triangles a mm along each edge."""
    corners = []
    for axis in range(3):
        across = [(axis + 1) % 3, (axis + 2) % 3]
        u, v = (np.linspace(-1, 1, round(sides[k] * per_mm) + 1) * sides[k] / 2 for k in across)
        first, second = (part.ravel() for part in np.meshgrid(np.arange(len(u) - 1), np.arange(len(v) - 1)))
        for side in (-1, 1):
            quad = np.empty((len(first), 4, 3))
            for corner, (i, j) in enumerate([(0, 0), (1, 0), (1, 1), (0, 1)]):
                quad[:, corner, axis] = side * sides[axis] / 2
                quad[:, corner, across[0]], quad[:, corner, across[1]] = u[first + i], v[second + j]
            corners.append(quad if side > 0 else quad[:, ::-1])
    quads = np.concatenate(corners)
    vertices, index = np.unique(np.round(quads.reshape(-1, 3), 6), axis=0, return_inverse=True)
    index = index.reshape(-1, 4)
    return Surface(vertices, np.concatenate([index[:, [0, 1, 2]], index[:, [0, 2, 3]]])).rounded()
