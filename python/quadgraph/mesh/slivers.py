"""Removal of thin triangles: slivers of a fraction of a degree make multigrid cycles diverge."""

from __future__ import annotations

from quadgraph.mesh.local_mesh import LocalMesh, MeshChange, along, dot
from quadgraph.mesh.surface import Surface

_PASSES = 12
_STEPS = (1.0, 0.5, 0.2)  # shares of the way to the middle of the neighbours
_TURN_COSINES = (0.9, 0.7, 0.4)  # how far new faces may lean from the old surface; stricter first


def raise_angles(surface: Surface, min_angle_degrees: float) -> Surface:
    """Flip, collapse and smooth tangentially until no angle is below the bound, or nothing helps any more.

    surface: a closed 2-manifold, which it stays, with the same genus and components; a few vertices may go. Only
    triangles below the bound and their neighbours change.
    """
    mesh = LocalMesh(surface)
    for cosine in _TURN_COSINES:
        for _ in range(_PASSES):
            bad = sorted((angle, f) for f in mesh.faces if (angle := mesh.angle(f)) < min_angle_degrees)
            if not bad:
                return mesh.surface()
            if not sum(_improve(mesh, f, min_angle_degrees, cosine) for _, f in bad if f in mesh.faces):
                break
    return mesh.surface()


def _improve(mesh: LocalMesh, face: int, bound: float, cosine: float) -> bool:
    """Make the change at a thin face that leaves the largest smallest angle; False if none raises it."""
    best = None
    for change in _candidates(mesh, face):
        usable = mesh.assess(change, cosine) and change.after > mesh.angles_before(change) + 1e-6
        if usable and (best is None or change.after > best.after):
            best = change
            if best.after >= bound:
                break
    if best is not None:
        mesh.apply(best)
    return best is not None


def _candidates(mesh: LocalMesh, face: int) -> list[MeshChange]:
    """Flips first, since they keep every vertex, then tangential moves, then collapses."""
    flips = [mesh.flip(face, corner) for corner in range(3)]
    moves = [_smoothed(mesh, vertex, step) for vertex in mesh.faces[face] for step in _STEPS]
    collapses = [mesh.collapse(face, corner, share) for corner in range(3) for share in (0.5, 0.0, 1.0)]
    return [change for change in flips + moves + collapses if change is not None]


def _smoothed(mesh: LocalMesh, vertex: int, step: float) -> MeshChange:
    """Move a vertex towards the middle of its neighbours, within its tangent plane."""
    here = mesh.points[vertex]
    around = [mesh.points[v] for v in mesh.neighbours(vertex)]
    x, y, z = (sum(p[k] for p in around) / len(around) for k in range(3))
    middle = (x, y, z)
    up = mesh.vertex_normal(vertex)
    height = dot(up, middle) - dot(up, here)
    x, y, z = (middle[k] - height * up[k] for k in range(3))
    return mesh.relocate(vertex, along(here, (x, y, z), step))
