"""Where a body lies in a scene: scaled, turned and moved, and whether bodies keep apart."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.spatial.transform import Rotation

from quadgraph.base.errors import InputError
from quadgraph.mesh.intersections import intersecting_triangles
from quadgraph.mesh.surface import Surface
from quadgraph.mesh.winding import winding_number

Triple = tuple[float, float, float]
_MOST = 1e7  # of a coordinate, mm, and of a scale
_APART = "move one of them by its position, or make it smaller by its scale, so that there is a gap between them"


@dataclass(frozen=True)
class BodyPlacement:
    """position: mm; rotation: degrees about the axes x, y, z through the mesh's 0, in this order; scale: a factor.

    The mesh is scaled first, then turned, then moved.
    """

    position: Triple = (0.0, 0.0, 0.0)
    rotation: Triple = (0.0, 0.0, 0.0)
    scale: float = 1.0

    def check(self, name: str) -> None:
        """Raise InputError that begins with `name` unless all numbers are finite and of a use."""
        for field, values in (("position", self.position), ("rotation", self.rotation)):
            if len(values) != 3 or not all(math.isfinite(value) and abs(value) <= _MOST for value in values):
                raise InputError(f"{name}{field}: {list(values)} found, three numbers of at most {_MOST:g} are wanted")
        if not (math.isfinite(self.scale) and 1 / _MOST <= self.scale <= _MOST):
            raise InputError(f"{name}scale: {self.scale} found, allowed are {1 / _MOST:g} to {_MOST:g}")

    def of(self, surface: Surface) -> Surface:
        """The surface, mm, where it is to lie."""
        if self == BodyPlacement():
            return surface
        turned = self.turned(surface.vertices)
        return Surface(self.scale * turned + np.array(self.position), surface.triangles)

    def turned(self, vectors: np.ndarray) -> np.ndarray:
        """Directions (..., 3) of the mesh where it is to lie."""
        turn = Rotation.from_euler("xyz", self.rotation, degrees=True)
        return turn.apply(vectors.reshape(-1, 3)).reshape(vectors.shape)


def joined(surfaces: Sequence[Surface]) -> Surface:
    """Several surfaces as one, their vertices and triangles one after the other."""
    offsets = np.cumsum([0] + [len(surface.vertices) for surface in surfaces])
    triangles = [surface.triangles + offset for surface, offset in zip(surfaces, offsets, strict=False)]
    return Surface(np.concatenate([surface.vertices for surface in surfaces]), np.concatenate(triangles))


def check_apart(surfaces: Sequence[Surface], names: Sequence[str]) -> None:
    """Raise InputError that names two bodies of closed surfaces, mm, that cut, touch or lie within each other.

    A body may lie in a cavity of another, whose surface then has one around it.
    """
    boxes = [(surface.vertices.min(axis=0), surface.vertices.max(axis=0)) for surface in surfaces]
    near = [
        (a, b)
        for a, b in combinations(range(len(surfaces)), 2)
        if (boxes[a][0] <= boxes[b][1]).all() and (boxes[b][0] <= boxes[a][1]).all()
    ]
    for a, b in near:
        _check_crossings(surfaces[a], surfaces[b], f"{names[a]} and {names[b]}")
        for inner, outer in ((a, b), (b, a)):
            if _contains(surfaces[outer], surfaces[inner]):
                raise InputError(
                    f"bodies: {names[inner]} lies within {names[outer]}, whose surface has no cavity there; cut one "
                    f"that is larger than {names[inner]} into the mesh of {names[outer]} (a gap of 0.1 mm is enough), "
                    f"or move {names[inner]} by its position"
                )


def _check_crossings(first: Surface, second: Surface, names: str) -> None:
    shared = set(map(tuple, first.vertices.tolist())) & set(map(tuple, second.vertices.tolist()))
    crossing = () if shared else intersecting_triangles(joined([first, second]))
    if not shared and not len(crossing):
        return
    places = np.array(sorted(shared)) if shared else joined([first, second]).corners[crossing].reshape(-1, 3)
    low, high = (", ".join(f"{x:.4g}" for x in corner) for corner in (places.min(axis=0), places.max(axis=0)))
    raise InputError(f"bodies: {names} cut or touch each other between ({low}) and ({high}) mm; {_APART}")


def _contains(outer: Surface, inner: Surface) -> bool:
    """Whether a piece of `inner` begins inside the solid of `outer`, of which it crosses no face."""
    count, label = inner.vertex_components
    first = [int(np.argmax(label == piece)) for piece in range(count)]
    return any(round(winding_number(outer, inner.vertices[vertex])) > 0 for vertex in first)
