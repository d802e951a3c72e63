"""A closed triangle mesh under local change: flip an edge, collapse an edge, move a vertex, never breaking it.

Plain Python numbers: the stars that change hold a handful of triangles, too few for NumPy to pay.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from quadgraph.mesh.surface import Surface

Point = tuple[float, float, float]
Face = tuple[int, int, int]


def subtract(p: Point, q: Point) -> Point:
    """p - q."""
    return (p[0] - q[0], p[1] - q[1], p[2] - q[2])


def dot(p: Point, q: Point) -> float:
    """p . q."""
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]


def cross(p: Point, q: Point) -> Point:
    """p x q."""
    return (p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0])


def along(p: Point, q: Point, share: float) -> Point:
    """The point `share` of the way from p to q."""
    return (p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1]), p[2] + share * (q[2] - p[2]))


def unit(p: Point) -> Point:
    """p at length 1, or zero."""
    length = math.sqrt(dot(p, p))
    return (p[0] / length, p[1] / length, p[2] / length) if length > 0 else (0.0, 0.0, 0.0)


def mean_direction(ways: Sequence[Point]) -> Point:
    """Their sum at length 1, or zero."""
    x, y, z = map(sum, zip(*ways, strict=True))
    return unit((x, y, z))


def replaced(face: Face, old: int, new: int) -> Face:
    """The face with one vertex in place of another."""
    a, b, c = (new if k == old else k for k in face)
    return a, b, c


def normal_and_angle(p: Point, q: Point, r: Point) -> tuple[Point, float]:
    """Twice the area of the triangle, along its normal, and its smallest angle, degrees."""
    a, b, c = subtract(q, p), subtract(r, q), subtract(p, r)
    n = cross(a, (-c[0], -c[1], -c[2]))
    doubled = math.sqrt(dot(n, n))
    # The smallest angle lies opposite to the shortest edge, between the other two.
    return n, math.degrees(math.atan2(doubled, max(-dot(a, b), -dot(b, c), -dot(c, a))))


@dataclass
class MeshChange:
    """A possible change: faces to drop, faces to add, vertices at new places, and the smallest angle after it."""

    dropped: list[int]
    added: list[Face]
    places: dict[int, Point] = field(default_factory=dict)
    after: float = 0.0


class LocalMesh:
    """Faces by number, the faces around each vertex, and the changes that keep the surface a closed 2-manifold."""

    def __init__(self, surface: Surface) -> None:
        self.points: list[Point] = [tuple(p) for p in surface.vertices.tolist()]
        self.faces: dict[int, Face] = {i: tuple(t) for i, t in enumerate(surface.triangles.tolist())}
        self.star: list[set[int]] = [set() for _ in self.points]
        for i, face in self.faces.items():
            for vertex in face:
                self.star[vertex].add(i)
        self._next = len(self.faces)
        # A face keeps its places as long as it has its number.
        self._own_shapes: dict[int, tuple[Point, float]] = {}

    def surface(self) -> Surface:
        """The mesh as it is now, without unreferenced vertices."""
        return Surface(np.array(self.points), np.array(list(self.faces.values()), np.int64)).compacted()

    def made_since(self, number: int) -> range:
        """Numbers of faces from `number` on: those made by changes are the highest."""
        return range(number, self._next)

    def _shape_of(self, face: int) -> tuple[Point, float]:
        found = self._own_shapes.get(face)
        if found is None:
            a, b, c = self.faces[face]
            found = self._own_shapes[face] = normal_and_angle(self.points[a], self.points[b], self.points[c])
        return found

    def angle(self, face: int) -> float:
        """Smallest angle of a face, degrees."""
        return self._shape_of(face)[1]

    def neighbours(self, vertex: int) -> set[int]:
        """Vertices joined to `vertex` by an edge."""
        return {v for f in self.star[vertex] for v in self.faces[f]} - {vertex}

    def vertex_normal(self, vertex: int) -> Point:
        """Area-weighted unit normal."""
        return mean_direction([self._shape_of(f)[0] for f in self.star[vertex]])

    def flip(self, face: int, corner: int) -> MeshChange | None:
        """Swap the diagonal of the two faces at the edge from `corner` on; None if the new edge exists already."""
        u, v, w = (self.faces[face][(corner + k) % 3] for k in range(3))
        other = next(f for f in self.star[u] & self.star[v] if f != face)
        x = next(k for k in self.faces[other] if k not in (u, v))
        if self.star[w] & self.star[x] or min(len(self.star[u]), len(self.star[v])) < 4:
            return None
        return MeshChange([face, other], [(u, x, w), (x, v, w)])

    def collapse(self, face: int, corner: int, share: float) -> MeshChange | None:
        """Merge the ends of the edge from `corner` on, at `share` of its length; None if that breaks the manifold."""
        u, v = self.faces[face][corner], self.faces[face][(corner + 1) % 3]
        both = self.star[u] & self.star[v]
        opposite = {k for f in both for k in self.faces[f]} - {u, v}
        # The link condition: the only common neighbours are the two vertices opposite to the edge.
        if self.neighbours(u) & self.neighbours(v) != opposite or min(len(self.star[k]) for k in opposite) < 4:
            return None
        moving = (self.star[u] | self.star[v]) - both
        added = [replaced(self.faces[f], v, u) for f in sorted(moving)]
        return MeshChange(sorted(moving) + sorted(both), added, {u: along(self.points[u], self.points[v], share)})

    def relocate(self, vertex: int, place: Point) -> MeshChange:
        """Move one vertex."""
        around = sorted(self.star[vertex])
        return MeshChange(around, [self.faces[f] for f in around], {vertex: place})

    def angles_before(self, change: MeshChange) -> float:
        """Smallest angle of the faces that the change drops, degrees."""
        return min(self.angle(f) for f in change.dropped)

    def assess(self, change: MeshChange, max_turn_cosine: float, bound: float) -> bool:
        """Fill in `change.after`; False if it is not above `bound` or a new face leans too far from the old surface.

        The surface replaced is the area-weighted normal of all dropped faces for a flip and a collapse, so that a
        sliver's own meaningless normal does not count.
        """
        mean = mean_direction([self._shape_of(f)[0] for f in change.dropped])
        change.after = 180.0
        for face in change.added:
            p, q, r = (change.places.get(v, self.points[v]) for v in face)
            up, angle = normal_and_angle(p, q, r)
            change.after = min(change.after, angle)
            if not change.after > bound or dot(unit(up), mean) < max_turn_cosine:
                return False
        return True

    def apply(self, change: MeshChange) -> None:
        """Carry the change out."""
        for f in change.dropped:
            self._own_shapes.pop(f, None)
            for vertex in self.faces.pop(f):
                self.star[vertex].discard(f)
        for face in change.added:
            self.faces[self._next] = face
            for vertex in face:
                self.star[vertex].add(self._next)
            self._next += 1
        for vertex, place in change.places.items():
            self.points[vertex] = place
