"""Our CGAL mesher (tools/cgal_mesh) as a child program: tetrahedra graded by the QuadGraph paper's K.

It links CGAL's Mesh_3 under the GPL and stays a separate program.
"""

from __future__ import annotations

import numpy as np

from quadgraph.base.child_process import run, workspace
from quadgraph.base.errors import ToolError
from quadgraph.mesh.surface import MesherInfo, Surface
from quadgraph.mesh.tet_files import read_tets, write_off
from quadgraph.mesh.wrap import CGAL_MESH

_RESERVE = 0.8  # share of the time limit that the program may plan with; the rest is for reading and writing


def fill(
    surface: Surface, grading: float, largest: float | None, time_limit_s: float, memory_limit_bytes: int
) -> tuple[np.ndarray, np.ndarray, MesherInfo]:
    """Mesh the inside of a closed surface with size(x) = min over the surface of grading * distance + local size.

    largest: mm, no size is above it but where the surface's own is; None for any.
    Returns (n, 3) float64 vertices, mm, and (m, 4) int64 tets. Raises ToolError.
    """
    with workspace() as directory:
        write_off(surface, directory / "surface.off")
        arguments = ["surface.off", "mesh", "--grading", repr(float(grading))]
        arguments += ["--time-limit", f"{_RESERVE * time_limit_s:g}"]
        arguments += [] if largest is None else ["--largest", repr(float(largest))]
        run(CGAL_MESH, arguments, directory=directory, time_limit_s=time_limit_s,
            memory_limit_bytes=memory_limit_bytes)  # fmt: skip
        vertices, tets = read_tets(directory / "mesh")
    if not len(tets):
        raise ToolError("quadgraph-cgal-mesh: made no tetrahedra")
    options = f"--grading {grading:g}" + ("" if largest is None else f" --largest {largest:g}")
    return vertices, tets, MesherInfo("cgal", _version(), options)


def _version() -> str:
    with workspace() as directory:
        done = run(CGAL_MESH, ["--version"], directory=directory, time_limit_s=10, memory_limit_bytes=None)
    return done.output.strip()
