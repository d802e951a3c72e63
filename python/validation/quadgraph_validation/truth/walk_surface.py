"""What random walks need of a triangle mesh, whatever is in it and shines on it: made once for each surface."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from quadgraph.mesh.surface import Surface
from quadgraph_validation.truth import triangle_tree, walk_kernel

_CELLS = 64  # of the clearance, along the longest side


class WalkSurface(NamedTuple):
    """tree: of the triangles; near: how far they are from places around."""

    tree: triangle_tree.TriangleTree
    near: walk_kernel.Clearance


@lru_cache(maxsize=4)
def walk_surface(surface: Surface) -> WalkSurface:
    """Make them, or return those of the same surface."""
    tree = triangle_tree.build(surface.vertices, surface.triangles)
    low, high = surface.vertices.min(axis=0), surface.vertices.max(axis=0)
    cell = float((high - low).max() / _CELLS)
    counts = np.ceil((high - low) / cell).astype(int)
    return WalkSurface(tree, walk_kernel.Clearance(walk_kernel.clearance(tree, low, cell, *counts), low, cell))
