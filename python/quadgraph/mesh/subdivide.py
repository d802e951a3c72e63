"""A surface with every triangle cut into four, curved where the body is smooth and straight where it has corners.

The vertices stay where they are. The middle of an edge goes where the cubic with the edge's ends and the tangents there
has it (curved PN triangles, Vlachos et al. 2001), so that a ball becomes rounder by the fourth power of the edge.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph.mesh.creases import corner_normals, creases, unit
from quadgraph.mesh.intersections import intersecting_triangles
from quadgraph.mesh.surface import Surface

MOST_STEPS = 5
MOST_TRIANGLES = 20_000_000
_STRAIGHT_DEGREES = 60.0  # a crease that turns more at a vertex has a corner there
_LONGEST = 0.25  # of the edge, how far its middle may move
_NEARLY_NOTHING = 1e-200  # mm, by which an edge can be divided


def check(steps: int) -> None:
    """Raise InputError for a number of steps that is not allowed."""
    if not 0 <= steps <= MOST_STEPS:
        raise InputError(f"refine: {steps} found, allowed are 0 to {MOST_STEPS}")


def subdivide(surface: Surface, steps: int) -> Surface:
    """Cut every triangle of a closed 2-manifold (mm) into four, `steps` times; coordinates as float32 holds them.

    Its vertices come first. Where curved triangles would cross others they stay flat. Raises InputError for a bad
    number of steps, ToolError if TetGen is missing.
    """
    check(steps)
    if (count := len(surface.triangles) * 4**steps) > MOST_TRIANGLES:
        raise InputError(
            f"refine: {steps} steps would make {count:,} triangles, at most {MOST_TRIANGLES:,} allowed; fewer steps"
        )
    sharp = creases(surface)
    for _ in range(steps):
        surface, sharp = _step(surface, sharp)
    return surface


def _step(surface: Surface, sharp: np.ndarray) -> tuple[Surface, np.ndarray]:
    count = len(surface.triangles)
    triangles = _four(surface.triangles, len(surface.vertices) + surface.topology.face_edges)
    return curved(surface, sharp, np.ones(len(sharp), bool), triangles, np.tile(np.arange(count), 4))


def curved(
    surface: Surface,
    sharp: np.ndarray,
    marked: np.ndarray,
    triangles: np.ndarray,
    parent: np.ndarray,
    crossing_in: Callable[[Surface], np.ndarray] = intersecting_triangles,
) -> tuple[Surface, np.ndarray]:
    """A closed 2-manifold (mm) with the middles of `marked` edges (e,) as further vertices, curved, and sharp edges.

    sharp: (e,) of the surface; triangles (k, 3): with these vertices behind the old ones, in the order of their edges;
    parent: (k,) the triangle that each is of; crossing_in: finds triangles that cross, whose edges are left straight.
    Raises ToolError without TetGen.
    """
    edges, face_edges = surface.topology.edges, surface.topology.face_edges
    ends = surface.vertices[edges]
    offsets = np.where(sharp[:, None], _along_creases(surface, sharp), _over_smooth(surface, sharp))
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    far = np.linalg.norm(offsets, axis=1)
    offsets *= (marked * np.minimum(1, _LONGEST * length / np.maximum(far, _NEARLY_NOTHING)))[:, None]
    while True:
        middles = (ends.mean(axis=1) + offsets)[marked]
        finer = Surface(np.concatenate([surface.vertices, middles]), triangles).rounded()
        crossing = crossing_in(finer) if offsets.any() else np.empty(0, np.int64)
        around = np.unique(face_edges[parent[crossing]])
        if not len(around) or not offsets[around].any():
            return finer, _inherited(finer, edges, sharp, marked)
        offsets[around] = 0


def _four(triangles: np.ndarray, middles: np.ndarray) -> np.ndarray:
    """Triangles (4 m, 3) of (m, 3), whose edge k, from corner k on, has the middle k; child c of f at c m + f."""
    (a, b, c), (ab, bc, ca) = triangles.T, middles.T
    return np.concatenate([np.column_stack(t) for t in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))])


def _inherited(finer: Surface, edges: np.ndarray, sharp: np.ndarray, marked: np.ndarray) -> np.ndarray:
    """(e,) which edges of the finer surface are sharp ones, or halves of them."""
    count = len(finer.vertices)
    middle = count - marked.sum() + np.cumsum(marked) - 1
    both = sharp & marked
    halves = [np.column_stack([edges[both][:, k], middle[both]]) for k in (0, 1)]
    kept = np.concatenate([*halves, edges[sharp & ~marked]])
    return np.isin(finer.topology.edges @ [count, 1], kept @ [count, 1])


def _over_smooth(surface: Surface, sharp: np.ndarray) -> np.ndarray:
    """(e, 3) offsets of the middles of edges, mm, by the normals of the smooth surface at their ends."""
    edges, face_edges = surface.topology.edges, surface.topology.face_edges
    normals = corner_normals(surface, sharp)
    offsets, triangles = np.zeros((len(edges), 3)), surface.triangles
    for k in range(3):
        here, there = k, (k + 1) % 3
        along = surface.vertices[triangles[:, there]] - surface.vertices[triangles[:, here]]
        rise = [np.einsum("ij,ij->i", along, normals[:, end])[:, None] * normals[:, end] for end in (here, there)]
        # Of a smooth edge both triangles say nearly the same; each gives half.
        np.add.at(offsets, face_edges[:, k], (rise[1] - rise[0]) / 16)
    return offsets


def _along_creases(surface: Surface, sharp: np.ndarray) -> np.ndarray:
    """(e, 3) offsets of the middles of sharp edges, mm, along curves through them; straight to corners."""
    edges, places = surface.topology.edges, surface.vertices
    offsets, at = np.zeros((len(edges), 3)), np.flatnonzero(sharp)
    tangents = np.zeros((len(at), 2, 3))  # at the two ends, in the direction of the edge, unit; zero at corners
    used = np.bincount(edges[at].ravel(), minlength=len(places))
    order = np.argsort(edges[at].ravel(), kind="stable")
    passed = order[used[edges[at].ravel()[order]] == 2].reshape(-1, 2)  # the two crease ends at each vertex on a curve
    along = unit(places[edges[at][:, 1]] - places[edges[at][:, 0]])
    first, second = passed.T
    out = [along[ends // 2] * np.where(ends % 2, -1, 1)[:, None] for ends in (first, second)]  # away from the vertex
    turned = np.einsum("ij,ij->i", out[0], -out[1]) > np.cos(np.radians(_STRAIGHT_DEGREES))
    tangent = unit(out[1] - out[0]) * turned[:, None]
    for ends, sign in ((first, -1), (second, 1)):
        tangents[ends // 2, ends % 2] = sign * tangent * np.where(ends % 2, -1, 1)[:, None]
    straight = (tangents == 0).all(axis=2)
    tangents[straight] = np.repeat(along[:, None], 2, axis=1)[straight]
    length = np.linalg.norm(places[edges[at][:, 1]] - places[edges[at][:, 0]], axis=1)
    offsets[at] = (tangents[:, 0] - tangents[:, 1]) * length[:, None] / 8
    return offsets
