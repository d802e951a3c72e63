"""The level-of-detail chain: each surface a quarter of the one above, with the same topology and no thin triangles."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from quadgraph.base.errors import InputError, ToolError
from quadgraph.base.progress import ProgressCallback
from quadgraph.mesh import meshlab
from quadgraph.mesh.intersections import intersecting_triangles
from quadgraph.mesh.slivers import raise_angles
from quadgraph.mesh.surface import Surface

DEFAULT_MIN_ANGLE_DEGREES = 12.0
MAX_LEVELS = 16  # of the .qgraph format
_RATIO = 4  # vertices of a level over those of the next
_SMALLEST = 200  # vertices: with no number of levels asked for, no level below this is begun
_QUALITY = (0.3, 1.0, 0.6)  # pymeshlab's penalty on thin triangles, tried in this order
_GUARD_RINGS = (1.0, 2.0, 4.0)  # radius kept at full resolution around crossings, in coarse edge lengths


class SurfaceChain(list[Surface]):
    """Surfaces, finest first; `ended` says why there are no more."""

    def __init__(self, finest: Surface) -> None:
        super().__init__([finest])
        self.ended = ""


def build_chain(
    surface: Surface,
    *,
    levels: int | None = None,
    min_angle_degrees: float = DEFAULT_MIN_ANGLE_DEGREES,
    progress: ProgressCallback | None = None,
) -> SurfaceChain:
    """Simplify a closed 2-manifold (mm) level by level; element 0 is the surface itself, unchanged.

    Every further level has about a quarter of the vertices of the one before, the same genus and components, no
    crossing triangles, coordinates that float32 holds, and angles of at least `min_angle_degrees` wherever local
    changes reach that (the few that stay thinner are told to `progress`). `levels` counts all levels, the input
    included; without it the chain ends near 300 vertices. It ends earlier where no valid level is found; `ended` says
    why. Raises InputError for a bad option, ToolError if TetGen is missing.
    """
    if levels is not None and not 1 <= levels <= MAX_LEVELS:
        raise InputError(f"levels: {levels} found, allowed are 1 to {MAX_LEVELS}")
    if not 0 <= min_angle_degrees <= 30:
        raise InputError(f"minimum angle: {min_angle_degrees:g} degrees found, allowed are 0 to 30")
    chain = SurfaceChain(surface)
    while len(chain) < (levels or MAX_LEVELS):
        target = round(len(chain[-1].vertices) / _RATIO)
        if levels is None and target < _SMALLEST:
            chain.ended = f"the next level would have only {target} vertices"
            return chain
        coarse, trouble = _next_level(chain[-1], target, min_angle_degrees)
        if coarse is None:
            chain.ended = f"no valid level of {target} vertices: {trouble}"
            return chain
        chain.append(coarse)
        if progress:
            progress(_summary(len(chain) - 1, coarse, min_angle_degrees))
    chain.ended = f"{len(chain)} levels asked for" if levels else f"{MAX_LEVELS} levels are the most"
    return chain


def simplify(surface: Surface, vertices: int, *, min_angle_degrees: float = DEFAULT_MIN_ANGLE_DEGREES) -> Surface:
    """Simplify a closed 2-manifold (mm) to about `vertices` vertices, with the promises of a level of `build_chain`.

    Raises InputError where no valid surface of that size is found or `vertices` is not below the surface's own.
    """
    if not 4 <= vertices < len(surface.vertices):
        raise InputError(
            f"surface_vertices: {vertices} found, allowed are 4 to {len(surface.vertices) - 1}; for more, --refine"
        )
    coarse, trouble = _next_level(surface, vertices, min_angle_degrees)
    if coarse is None:
        raise InputError(f"surface_vertices: no valid surface of {vertices} vertices: {trouble}")
    return coarse


def _summary(level: int, surface: Surface, bound: float) -> str:
    thin = int((surface.angles.min(axis=1) < bound).sum())
    left = f", {thin} triangles below {bound:g}" if thin else ""
    return f"level {level}: {len(surface.vertices)} vertices, smallest angle {surface.min_angle:.1f} degrees{left}"


def _next_level(fine: Surface, target: int, min_angle: float) -> tuple[Surface | None, str]:
    """A valid coarser surface, or None and what was wrong with the last attempt."""
    trouble = ""
    for quality in _QUALITY:
        guarded = np.zeros(len(fine.triangles), bool)
        for rings in (*_GUARD_RINGS, None):
            coarse = raise_angles(_decimate(fine, target, quality, guarded), min_angle).rounded()
            trouble, crossing = _trouble(fine, coarse, target)
            if not trouble:
                return coarse, ""
            if not len(crossing) or rings is None:
                break
            guarded |= _near(fine, coarse, crossing, rings)
    return None, trouble


def _decimate(fine: Surface, target: int, quality: float, guarded: np.ndarray) -> Surface:
    """Quadric edge collapse to `target` vertices that keeps the topology; `guarded` triangles stay as they are.

    pymeshlab rather than fast-simplification: the latter is ten times faster, but breaks the manifold of detailed
    surfaces and leaves more and thinner slivers at the same deviation.
    """
    pymeshlab = meshlab.load()
    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(
        pymeshlab.Mesh(fine.vertices, fine.triangles.astype(np.int32), f_scalar_array=guarded.astype(np.float64))
    )
    if guarded.any():
        meshes.compute_selection_by_condition_per_face(condselect="fq < 0.5")
    meshes.meshing_decimation_quadric_edge_collapse(
        targetfacenum=max(2 * (target - fine.euler), 4),
        qualitythr=quality,
        preservenormal=True,
        preservetopology=True,
        optimalplacement=True,
        planarquadric=True,
        planarweight=1e-3,
        autoclean=False,
        selected=bool(guarded.any()),
    )
    mesh = meshes.current_mesh()
    return Surface(mesh.vertex_matrix(), mesh.face_matrix().astype(np.int64)).compacted()


def _trouble(fine: Surface, coarse: Surface, target: int) -> tuple[str, np.ndarray]:
    """What makes `coarse` no valid level below `fine` (empty if nothing), and its crossing triangles."""
    nowhere = np.empty(0, np.int64)
    if not coarse.is_closed_manifold or (coarse.doubled_normals == 0).all(axis=1).any():
        return "not a closed 2-manifold", nowhere
    if (coarse.genus, coarse.components) != (fine.genus, fine.components):
        return f"genus {coarse.genus} and {coarse.components} pieces", nowhere
    if len(coarse.vertices) > 2 * target:
        return f"{len(coarse.vertices)} vertices are left when the topology is kept", nowhere
    if coarse.volume <= 0:
        return "no volume is left", nowhere
    try:
        crossing = intersecting_triangles(coarse)
    except ToolError as error:
        return str(error), nowhere
    return (f"{len(crossing)} triangles cross each other" if len(crossing) else ""), crossing


def _near(fine: Surface, coarse: Surface, crossing: np.ndarray, rings: float) -> np.ndarray:
    """(m,) which triangles of `fine` lie within `rings` mean edge lengths of a crossing of `coarse`."""
    places = coarse.corners[crossing].reshape(-1, 3)
    edges = coarse.vertices[coarse.topology.edges]
    radius = rings * np.linalg.norm(edges[:, 0] - edges[:, 1], axis=1).mean()
    distance, _ = cKDTree(places).query(fine.corners.mean(axis=1), distance_upper_bound=radius)
    return np.isfinite(distance)
