"""Tetrahedra inside a closed surface, by TetGen or by our CGAL mesher, both separate programs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from quadgraph.base.errors import InputError, ToolError
from quadgraph.mesh.surface import Surface, TetMesh
from quadgraph.tets import cgal_mesh, regions, tetgen
from quadgraph.tets.interior import Limits
from quadgraph.tets.tet_rounding import orient, round_to_float32

DEFAULT_GRADING = 1.0  # K of the QuadGraph paper's sizing field
DEFAULT_TIME_LIMIT_S = 300.0
DEFAULT_MEMORY_LIMIT_BYTES = 4 << 30


def tetrahedralise(
    surface: Surface,
    *,
    mesher: str = "tetgen",
    inner: Sequence[Surface] = (),
    grading: float | None = None,
    limits: Limits | None = None,
    time_limit_s: float = DEFAULT_TIME_LIMIT_S,
    memory_limit_bytes: int = DEFAULT_MEMORY_LIMIT_BYTES,
) -> TetMesh:
    """Fill a closed, 2-manifold, outward-facing surface (mm) with positive tetrahedra.

    mesher "tetgen" keeps the surface as it is: its vertices are the first of the result and its triangles the
    boundary; inner: closed surfaces (mm) within it, apart from each other, which tets meet with their faces and which
    tell the regions of the result; with "tetgen" alone. "cgal" makes its own surface near it, sized as in the QuadGraph
    paper by `grading` = K > 0 (larger K: larger tetrahedra inside), and no edge above the smallest of `limits`. limits:
    how large tets may be inside, None for what the surface makes. All determinants are positive in double precision
    with float32 vertices.

    Raises InputError for a bad option or surface, ToolError if the program is missing, fails or passes a limit.
    """
    if mesher not in ("tetgen", "cgal"):
        raise InputError(f'mesher: "{mesher}" found, allowed are "tetgen" and "cgal"')
    if not surface.is_closed_manifold or surface.volume <= 0:
        raise InputError("tetrahedralise: the surface is not a closed, outward-facing 2-manifold; repair it first")
    if mesher == "tetgen":
        return _with_tetgen(surface, inner, grading, limits, time_limit_s, memory_limit_bytes)
    if len(inner):
        raise InputError('mesher: "cgal" found with a body within another, allowed is "tetgen", which keeps surfaces')
    largest = None if limits is None else limits.interior.edge
    usual = DEFAULT_GRADING if grading is None else grading
    return _with_cgal(surface, usual, largest, time_limit_s, memory_limit_bytes)


def _with_tetgen(
    surface: Surface,
    inner: Sequence[Surface],
    grading: float | None,
    limits: Limits | None,
    time_limit_s: float,
    memory_limit_bytes: int,
) -> TetMesh:
    if grading is not None:
        raise InputError('grading: an option of mesher "cgal"; "tetgen" has interior')
    surface, inner = surface.rounded(), [each.rounded() for each in inner]
    vertices, tets, info = tetgen.fill(surface, time_limit_s, memory_limit_bytes, limits, inner)
    mesh = _positive(vertices, tets, sum(len(each.vertices) for each in (surface, *inner)), info)
    if not np.array_equal(_canonical(mesh.boundary().triangles), _canonical(surface.triangles)):
        raise ToolError("tetgen: the boundary of the tetrahedra is not the given surface")
    return replace(mesh, regions=regions.of(mesh, len(surface.vertices), inner)) if inner else mesh


def _with_cgal(
    surface: Surface, grading: float, largest: float | None, time_limit_s: float, memory_limit_bytes: int
) -> TetMesh:
    if not (np.isfinite(grading) and grading > 0):
        raise InputError(f"grading: {grading!r} found, allowed is a finite number above 0")
    vertices, tets, info = cgal_mesh.fill(surface, grading, largest, time_limit_s, memory_limit_bytes)
    mesh = _positive(vertices, tets, 0, info)
    boundary = mesh.boundary().compacted()
    if not boundary.is_closed_manifold:
        raise ToolError("cgal: the boundary of the tetrahedra is not a closed 2-manifold; use a smaller grading")
    return mesh


def _positive(vertices: np.ndarray, tets: np.ndarray, fixed: int, info) -> TetMesh:
    tets = orient(vertices, tets)
    return TetMesh(round_to_float32(vertices, tets, fixed), tets, info)


def _canonical(triangles: np.ndarray) -> np.ndarray:
    """Oriented triangles, each starting at its smallest index, in order."""
    start = triangles.argmin(axis=1)[:, None]
    turned = np.take_along_axis(triangles, (start + np.arange(3)) % 3, axis=1)
    return turned[np.lexsort(turned.T)]
