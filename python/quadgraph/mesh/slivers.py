"""Removal of thin triangles: slivers of a fraction of a degree make multigrid cycles diverge."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from quadgraph.mesh.local_mesh import LocalMesh, MeshChange, Point, along, dot
from quadgraph.mesh.surface import Surface

_PASSES = 12
_STEPS = (1.0, 0.5, 0.2)  # shares of the way to the middle of the neighbours
_ANGLE_ROUNDING = 1e-6  # degrees, more than angles by NumPy and by Python's numbers differ by
_TURN_COSINES = (0.9, 0.7, 0.4)  # how far new faces may lean from the old surface; stricter first


def raise_angles(surface: Surface, min_angle_degrees: float) -> Surface:
    """Flip, collapse and smooth tangentially until no angle is below the bound, or nothing helps any more.

    surface: a closed 2-manifold, which it stays, with the same genus and components; a few vertices may go. Only
    triangles below the bound and their neighbours change.
    """
    mesh = LocalMesh(surface)
    watched = set(np.flatnonzero(~(surface.angles.min(axis=1) >= min_angle_degrees + _ANGLE_ROUNDING)).tolist())
    made = len(surface.triangles)
    for cosine in _TURN_COSINES:
        for _ in range(_PASSES):
            new = mesh.made_since(made)
            watched.update(new)
            made = new.stop
            watched = {f for f in watched if f in mesh.faces and mesh.angle(f) < min_angle_degrees}
            bad = sorted((mesh.angle(f), f) for f in watched)
            if not bad:
                return mesh.surface()
            if not sum(_improve(mesh, f, min_angle_degrees, cosine) for _, f in bad if f in mesh.faces):
                break
    return mesh.surface()


def _improve(mesh: LocalMesh, face: int, bound: float, cosine: float) -> bool:
    """Make the change at a thin face that leaves the largest smallest angle; False if none raises it."""
    best = None
    for change in _candidates(mesh, face):
        to_beat = mesh.angles_before(change) + 1e-6
        if mesh.assess(change, cosine, to_beat if best is None else max(to_beat, best.after)):
            best = change
            if best.after >= bound:
                break
    if best is not None:
        mesh.apply(best)
    return best is not None


def _candidates(mesh: LocalMesh, face: int) -> Iterator[MeshChange]:
    """Flips first, since they keep every vertex, then tangential moves, then collapses."""
    corners = range(3)
    yield from filter(None, (mesh.flip(face, corner) for corner in corners))
    for vertex in mesh.faces[face]:
        middle = _tangential_middle(mesh, vertex)
        for step in _STEPS:
            yield mesh.relocate(vertex, along(mesh.points[vertex], middle, step))
    yield from filter(None, (mesh.collapse(face, corner, share) for corner in corners for share in (0.5, 0.0, 1.0)))


def _tangential_middle(mesh: LocalMesh, vertex: int) -> Point:
    """The middle of a vertex's neighbours, brought into its tangent plane."""
    here = mesh.points[vertex]
    around = [mesh.points[v] for v in mesh.neighbours(vertex)]
    x, y, z = (sum(p[k] for p in around) / len(around) for k in range(3))
    middle = (x, y, z)
    up = mesh.vertex_normal(vertex)
    height = dot(up, middle) - dot(up, here)
    x, y, z = (middle[k] - height * up[k] for k in range(3))
    return x, y, z
