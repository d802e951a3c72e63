"""Where a body lies in a scene: scaled, turned and moved, beside others or within one of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.spatial.transform import Rotation

from quadgraph.base.errors import InputError
from quadgraph.mesh.intersections import intersecting_triangles
from quadgraph.mesh.surface import Surface, joined_surface
from quadgraph.mesh.winding import winding_number

Triple = tuple[float, float, float]
_MOST = 1e7  # of a coordinate, mm, and of a scale
_APART = (
    "move one of them by its position, or make it smaller by its scale, so that it lies beside the other, with a gap "
    "between them, or wholly within it"
)


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


def hosts_of(surfaces: Sequence[Surface], names: Sequence[str]) -> list[int | None]:
    """Of closed surfaces, mm, the innermost that each lies within, by its number; None of those that lie apart.

    A body in a cavity of another lies apart from it. Raises InputError that names two bodies that cut or touch each
    other, or of which one lies within the other in part.
    """
    boxes = [(surface.vertices.min(axis=0), surface.vertices.max(axis=0)) for surface in surfaces]
    near = [
        (a, b)
        for a, b in combinations(range(len(surfaces)), 2)
        if (boxes[a][0] <= boxes[b][1]).all() and (boxes[b][0] <= boxes[a][1]).all()
    ]
    _check_crossings(surfaces, names, near)
    around: list[list[int]] = [[] for _ in surfaces]
    for a, b in near:
        for inner, outer in ((a, b), (b, a)):
            if _within(surfaces[inner], surfaces[outer], names[inner], names[outer]):
                around[inner].append(outer)
    # Each of those around a body lies within the ones further out.
    return [max(hosts, key=lambda host: len(around[host]), default=None) for hosts in around]


def _check_crossings(surfaces: Sequence[Surface], names: Sequence[str], near: Sequence[tuple[int, int]]) -> None:
    """All at once, as crossings are rare and a run of TetGen for each two takes long; then by name."""
    together = sorted({number for pair in near for number in pair})
    if not together:
        return
    own = np.concatenate([np.unique(surfaces[number].vertices, axis=0) for number in together])
    apart = len(np.unique(own, axis=0)) == len(own)
    if apart and not len(intersecting_triangles(joined_surface([surfaces[number] for number in together]))):
        return
    for a, b in near:
        _check_two(surfaces[a], surfaces[b], f"{names[a]} and {names[b]}")


def _check_two(first: Surface, second: Surface, names: str) -> None:
    shared = set(map(tuple, first.vertices.tolist())) & set(map(tuple, second.vertices.tolist()))
    crossing = () if shared else intersecting_triangles(joined_surface([first, second]))
    if not shared and not len(crossing):
        return
    places = np.array(sorted(shared)) if shared else joined_surface([first, second]).corners[crossing].reshape(-1, 3)
    low, high = (", ".join(f"{x:.4g}" for x in corner) for corner in (places.min(axis=0), places.max(axis=0)))
    raise InputError(f"bodies: {names} cut or touch each other between ({low}) and ({high}) mm; {_APART}")


def _within(inner: Surface, outer: Surface, name: str, around: str) -> bool:
    """Whether a body lies in the solid of another, whose surface it does not cross. Raises InputError if in part."""
    pieces, inside = _pieces_inside(inner, outer)
    if inside and _pieces_inside(outer, inner)[1]:
        raise InputError(
            f"bodies: {name} and {around} lie within each other in part, as where one is around a cavity of the other; "
            "cut the cavity into both meshes, or move one of them by its position"
        )
    if 0 < inside < pieces:
        raise InputError(
            f"bodies: {inside} of the {pieces} pieces of {name} lie within {around}, the others do not; make them "
            "bodies of their own"
        )
    return inside > 0


def _pieces_inside(surface: Surface, solid: Surface) -> tuple[int, int]:
    """How many pieces a surface has, and how many of them begin inside a solid, of which they cross no face."""
    count, label = surface.vertex_components
    first = [int(np.argmax(label == piece)) for piece in range(count)]
    inside = sum(round(winding_number(solid, surface.vertices[vertex])) > 0 for vertex in first)
    return count, inside
