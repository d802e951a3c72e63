"""A closed surface around a mesh of any kind, by CGAL's alpha wrap in a child program [Portaneri 2022]."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from quadgraph.base.child_process import Program, run, workspace
from quadgraph.base.errors import InputError
from quadgraph.base.progress import ProgressCallback
from quadgraph.mesh import mesh_text, meshlab, weld
from quadgraph.mesh.surface import Surface
from quadgraph.mesh.tet_files import write_off

CGAL_MESH = Program(
    "quadgraph-cgal-mesh",
    "build it with CMake option QUADGRAPH_CGAL (Debian's package libcgal-dev)",
    environment="QUADGRAPH_CGAL_MESH",
)
AUTO = "auto"
_OFFSET_SHARE = 1 / 30  # of the size: how far the wrap lies from the mesh
_AUTO_SHARES = (1 / 14, 1 / 28, 1 / 56)  # of the diagonal, sizes that are tried for AUTO
_HOLLOW = 0.6  # of the volume of the size before: with less, the wrap has gone in through a hole
_FINEST, _COARSEST = 1 / 1000, 1.0  # of the diagonal
_SAMPLES = 50_000  # of the wrap's surface, whose distance is measured


def check(size: float | str | None) -> None:
    """Raise InputError for a text other than AUTO."""
    if isinstance(size, str) and size != AUTO:
        raise InputError(f"wrap: {size!r} found, allowed are a size in mm and {AUTO}")


@dataclass(frozen=True)
class Wrap:
    """A wrap and how far it is from the mesh: all lengths in mm.

    size: holes narrower than it are covered; mean, most: distances of points of the wrap from the mesh.
    """

    surface: Surface
    size: float
    mean: float
    most: float

    @property
    def triangles(self) -> int:
        """How many it has."""
        return len(self.surface.triangles)

    def sentence(self) -> str:
        """What to tell of it."""
        return (
            f"wrapped at {self.size:.3g} mm: {self.triangles:,} triangles, {self.mean:.2g} mm from the mesh "
            f"on average and at most {self.most:.2g} mm; --wrap SIZE takes another size"
        )


def wrap(
    surface: Surface,
    size: float | str,
    name: str,
    time_limit_s: float,
    memory_limit_bytes: int,
    tell: ProgressCallback = lambda text: None,
) -> Wrap:
    """Wrap a surface (mm) that may be open, torn, crossing or in pieces; the wrap is closed and free of crossings.

    size: mm, or AUTO: the finest of a few at which the wrap does not go in through a hole. Its offset from the mesh is
    a thirtieth of that. Raises InputError naming `name` for a size out of range, ToolError if the program fails.
    """
    found, _ = weld.drop_degenerate(surface)
    if not len(found.triangles):
        raise InputError(f"{name}: no triangle with an area is left")
    diagonal = surface.diagonal
    if size != AUTO and not _FINEST * diagonal <= float(size) <= _COARSEST * diagonal:
        raise InputError(
            f"wrap: {float(size):.3g} mm found, allowed are {_FINEST * diagonal:.3g} to {_COARSEST * diagonal:.3g} mm "
            f"for {name}, or auto"
        )
    sizes = [share * diagonal for share in _AUTO_SHARES] if size == AUTO else [float(size)]
    with workspace() as directory:
        write_off(found, directory / "mesh.off")

        def wrapped(alpha: float) -> Surface:
            tell(f"wrapping at {alpha:.3g} mm")
            arguments = ["mesh.off", "wrap", "--alpha", repr(alpha), "--offset", repr(_OFFSET_SHARE * alpha)]
            run(CGAL_MESH, arguments, directory=directory, time_limit_s=time_limit_s,
                memory_limit_bytes=memory_limit_bytes)  # fmt: skip
            return Surface(*mesh_text.read_off(directory / "wrap.off"))

        chosen, best = sizes[0], wrapped(sizes[0])
        for finer in sizes[1:]:
            tried = wrapped(finer)
            if _inside(tried, finer) < _HOLLOW * _inside(best, chosen):
                break
            chosen, best = finer, tried
    return Wrap(best, chosen, *_distances(best, found))


def _inside(wrapped: Surface, size: float) -> float:
    """Volume of a wrap without what its offset adds, mm³."""
    return wrapped.volume - _OFFSET_SHARE * size * wrapped.area


def _distances(wrapped: Surface, mesh: Surface) -> tuple[float, float]:
    """Mean and largest distance of points spread evenly over the wrap's triangles from the mesh.

    Not of its vertices: all of them lie at the offset.
    """
    pymeshlab = meshlab.load()
    meshes = pymeshlab.MeshSet()
    for each in (wrapped, mesh):
        meshes.add_mesh(pymeshlab.Mesh(each.vertices, each.triangles.astype(np.int32)))
    measured = meshes.get_hausdorff_distance(
        sampledmesh=0,
        targetmesh=1,
        samplevert=False,
        sampleedge=False,
        sampleface=True,
        samplenum=_SAMPLES,
        maxdist=pymeshlab.PercentageValue(100),
    )
    return float(measured["mean"]), float(measured["max"])
