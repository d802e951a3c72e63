"""What random walks need of a triangle mesh, whatever is in it and shines on it: made once for each surface."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from hashlib import sha256
from typing import NamedTuple

import numpy as np

from quadgraph.mesh.surface import Surface
from quadgraph_validation.truth import triangle_tree, walk_kernel

_CELLS = 64  # of the clearance, along the longest side


class WalkSurface(NamedTuple):
    """tree: of the triangles; near: how far they are from places around."""

    tree: triangle_tree.TriangleTree
    near: walk_kernel.Clearance


@dataclass(frozen=True)
class _Shape:
    """A surface that is the same as another of equal vertices and triangles."""

    digest: bytes
    surface: Surface = field(compare=False)


def walk_surface(surface: Surface) -> WalkSurface:
    """Make them, or return those of an equal surface."""
    digest = sha256()
    for each in (surface.vertices, surface.triangles):
        digest.update(f"{each.dtype} {each.shape}".encode())
        digest.update(each.tobytes())
    return _made(_Shape(digest.digest(), surface))


@lru_cache(maxsize=4)
def _made(shape: _Shape) -> WalkSurface:
    vertices, triangles = shape.surface.vertices, shape.surface.triangles
    tree = triangle_tree.build(vertices, triangles)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    cell = float((high - low).max() / _CELLS)
    counts = np.ceil((high - low) / cell).astype(int)
    return WalkSurface(tree, walk_kernel.Clearance(walk_kernel.clearance(tree, low, cell, *counts), low, cell))
