"""From a surface as found to a closed, outward-facing 2-manifold without crossings, or a refusal that says where."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from quadgraph.base.errors import InputError
from quadgraph.mesh import meshlab, weld
from quadgraph.mesh.intersections import intersecting_triangles
from quadgraph.mesh.surface import MILLIMETRES, FileFrame, Repair, Surface

_NEAR_SHARE = 1e-6  # of the diagonal: vertices nearer than this are one
_TINY_SHARE = 1e-3  # of the area: loose pieces below it are dropped
_HOLE_EDGES = 150  # a small hole has at most so many edges
_HOLE_SHARE = 0.02  # and at most this share of the surface's area
_CUT_SHARE = 0.02  # of the triangles: more than this is not cut away
_CUT_ROUNDS = 6
_FLAT_SHARE = 1e-6  # volume over area times diagonal: below it there is no interior


class _Work:
    """The surface under repair, with the report as it grows."""

    def __init__(self, surface: Surface, name: str, frame: FileFrame, next_step: str) -> None:
        self.surface = surface
        self.name = name
        self.frame = frame
        self.next_step = next_step
        self.counts: dict[str, int] = {}

    def done(self, result: tuple[Surface, int], what: str) -> None:
        self.surface, count = result
        if count:
            self.counts[what] = self.counts.get(what, 0) + count

    def refuse(self, what: str, places: np.ndarray) -> InputError:
        """An InputError about the box around `places` (k, 3), mm."""
        return InputError(f"{self.name}: {what}, {self.frame.box(places)}{self.next_step}")


def repair(
    surface: Surface, name: str, frame: FileFrame = MILLIMETRES, next_step: str = ""
) -> tuple[Surface, list[Repair]]:
    """Make a surface (mm) fit for the mesher, by safe steps only, each reported; coordinates as float32 holds them.

    Merges duplicate vertices (equal, then within 1e-6 of the diagonal), drops unreferenced vertices, degenerate and
    duplicate triangles and loose pieces below 0.1% of the area, removes triangles around non-manifold edges, splits
    non-manifold vertices, closes holes of at most 150 edges and 2% of the area, turns triangles outward, and cuts away
    crossing triangles when they are at most 2% of all. A surface without defects comes back as it is with no repairs.

    Raises InputError naming `name`, what is wrong, counts and the place: open shell, non-manifold, one-sided, no
    volume, or crossings that cannot be cut away. frame: in whose coordinates the place is told; next_step: what such a
    message ends with.
    """
    work = _Work(surface.rounded(), name, frame, next_step)
    _clean(work)
    _close(work)
    _check_volume(work)
    _cut_crossings(work)
    _check_volume(work)
    return work.surface, [Repair(what, count) for what, count in work.counts.items()]


def _clean(work: _Work) -> None:
    """Repairs that need no new triangles."""
    work.done(weld.merge_vertices(work.surface, 0.0), "duplicate vertices merged")
    work.done(weld.merge_vertices(work.surface, _NEAR_SHARE * work.surface.diagonal), "near vertices merged")
    work.done(weld.drop_degenerate(work.surface), "degenerate triangles dropped")
    work.done(weld.drop_duplicates(work.surface), "duplicate triangles dropped")
    if not len(work.surface.triangles):
        raise InputError(f"{work.name}: no triangle with an area is left")
    compact = work.surface.compacted()
    unused = len(work.surface.vertices) - len(compact.vertices)
    work.done((compact, unused), "unreferenced vertices dropped")
    _drop_tiny(work)


def _drop_tiny(work: _Work) -> None:
    kept, pieces = weld.drop_tiny_pieces(work.surface, _TINY_SHARE)
    if not len(kept.triangles):
        raise work.refuse(
            f"torn: {pieces} loose pieces, each of less than {100 * _TINY_SHARE:g}% of the area", work.surface.vertices
        )
    if pieces:
        work.done((kept.compacted(), pieces), "tiny loose pieces dropped")


def _close(work: _Work) -> None:
    """Make the surface a closed, outward-facing 2-manifold, or refuse."""
    _resolve_non_manifold(work)
    _fill_holes(work)
    if len(work.surface.non_manifold_vertices) or len(work.surface.topology.non_manifold):
        _resolve_non_manifold(work)
        _fill_holes(work)
    turned = weld.orient(work.surface)
    if turned is None:
        raise work.refuse("one-sided surface (no orientation is consistent)", work.surface.vertices)
    work.done(turned, "triangles turned")
    if not work.surface.is_closed_manifold:
        edges = work.surface.topology
        odd = edges.edges[edges.uses != 2].ravel()
        where = odd if len(odd) else work.surface.non_manifold_vertices
        raise work.refuse(f"not a 2-manifold after repair ({len(where)} places)", work.surface.vertices[where])


def _resolve_non_manifold(work: _Work) -> None:
    edges = work.surface.topology.non_manifold
    corners = work.surface.non_manifold_vertices
    if not len(edges) and not len(corners):
        return
    before = len(work.surface.triangles)
    if len(edges) > _CUT_SHARE * before:
        places = work.surface.vertices[edges.ravel()]
        raise work.refuse(f"{len(edges)} edges shared by more than two triangles, of {before} triangles", places)
    meshes = _meshlab(work.surface)
    meshes.meshing_repair_non_manifold_edges(method="Remove Faces")
    meshes.meshing_repair_non_manifold_vertices(vertdispratio=0)
    work.done((_back(meshes), len(edges)), "non-manifold edges removed")
    if len(corners):
        work.done((work.surface, len(corners)), "non-manifold vertices split")
    _drop_tiny(work)


def boundary_loops(surface: Surface) -> list[np.ndarray]:
    """Vertex indices of each connected piece of the boundary; their order along it is not told."""
    edges = surface.topology.boundary
    if not len(edges):
        return []
    n = len(surface.vertices)
    graph = sparse.coo_matrix((np.ones(len(edges), bool), (edges[:, 0], edges[:, 1])), shape=(n, n))
    _, label = connected_components(graph, directed=False)
    used = np.unique(edges)
    return [used[label[used] == k] for k in np.unique(label[used])]


def _hole_area(surface: Surface, loop: np.ndarray) -> float:
    """Area of the fan between a hole's boundary edges and their middle, mm²."""
    edges = surface.topology.boundary
    p = surface.vertices[edges[np.isin(edges[:, 0], loop)]]
    middle = surface.vertices[loop].mean(axis=0)
    return float(0.5 * np.linalg.norm(np.cross(p[:, 0] - middle, p[:, 1] - middle), axis=1).sum())


def _fill_holes(work: _Work) -> None:
    loops = boundary_loops(work.surface)
    if not loops:
        return
    area = work.surface.area
    for loop in loops:
        share = _hole_area(work.surface, loop) / area
        if len(loop) > _HOLE_EDGES or share > _HOLE_SHARE:
            raise work.refuse(
                f"open shell: {len(loops)} holes, one of {len(loop)} edges and {100 * share:.2g}% of the area "
                f"(closed are at most {_HOLE_EDGES} edges and {100 * _HOLE_SHARE:g}%)",
                work.surface.vertices[loop],
            )
    meshes = _meshlab(work.surface)
    meshes.meshing_re_orient_faces_coherently()
    meshes.meshing_close_holes(maxholesize=_HOLE_EDGES + 1, selfintersection=False)
    work.done((_back(meshes).rounded(), len(loops)), "small holes closed")
    left = boundary_loops(work.surface)
    if left:
        raise work.refuse(f"{len(left)} holes could not be closed", work.surface.vertices[np.concatenate(left)])


def _cut_crossings(work: _Work) -> None:
    """Cut crossing triangles out and close the wounds, a ring wider each time, until none are left."""
    allowed = _CUT_SHARE * len(work.surface.triangles)
    for rings in range(_CUT_ROUNDS):
        crossing = intersecting_triangles(work.surface)
        if not len(crossing):
            return
        places = work.surface.corners[crossing].reshape(-1, 3)
        trouble = work.refuse(f"{len(crossing)} triangles cross each other and cannot be cut away", places)
        if len(crossing) > allowed:
            raise trouble
        cut = np.zeros(len(work.surface.triangles), bool)
        cut[crossing] = True
        for _ in range(rings):
            cut = np.logical_or.reduce(np.isin(work.surface.triangles, work.surface.triangles[cut]), axis=1)
        kept = Surface(work.surface.vertices, work.surface.triangles[~cut]).compacted()
        work.done((kept, len(crossing)), "crossing triangles cut away")
        try:
            _drop_tiny(work)
            _close(work)
        except InputError:
            raise trouble from None
    raise trouble


def _check_volume(work: _Work) -> None:
    surface = work.surface
    if surface.volume <= _FLAT_SHARE * surface.area * surface.diagonal:
        raise work.refuse(
            f"no interior: volume {surface.volume:.3g} mm³, area {surface.area:.3g} mm²", surface.vertices
        )


def _meshlab(surface: Surface) -> Any:
    pymeshlab = meshlab.load()
    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(surface.vertices, surface.triangles.astype(np.int32)))
    return meshes


def _back(meshes: Any) -> Surface:
    mesh = meshes.current_mesh()
    return Surface(mesh.vertex_matrix(), mesh.face_matrix().astype(np.int64)).compacted()
