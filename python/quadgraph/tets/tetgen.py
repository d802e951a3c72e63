"""Debian's TetGen as a child program: tetrahedra inside a surface.

TetGen is under the AGPL and stays a separate program. Version 1.5.0 aborts on much bad input and exits 0 with no tets
on an open surface; both become a ToolError here.
"""

from __future__ import annotations

import re

import numpy as np

from quadgraph.base.child_process import run, workspace
from quadgraph.base.errors import ToolError
from quadgraph.mesh.intersections import TETGEN
from quadgraph.mesh.surface import MesherInfo, Surface
from quadgraph.mesh.tet_files import read_tets, write_smesh

OPTIONS = "-pYq1.4/0"  # piecewise linear complex, surface kept, radius-edge ratio 1.4, no dihedral bound


def fill(surface: Surface, time_limit_s: float, memory_limit_bytes: int) -> tuple[np.ndarray, np.ndarray, MesherInfo]:
    """Fill a closed surface with tetrahedra; its vertices come first and its triangles are the boundary.

    Returns (n, 3) float64 vertices, mm, and (m, 4) int64 tets of either orientation. Raises ToolError.
    """
    with workspace() as directory:
        write_smesh(surface, directory / "surface.smesh")
        done = run(TETGEN, [OPTIONS + "F", "surface.smesh"], directory=directory, time_limit_s=time_limit_s,
                   memory_limit_bytes=memory_limit_bytes)  # fmt: skip
        if not (directory / "surface.1.ele").exists():
            raise ToolError(f"tetgen: wrote no tetrahedra: {done.output[-300:].strip()}")
        vertices, tets = read_tets(directory / "surface.1")
    if not len(tets):
        raise ToolError("tetgen: made no tetrahedra; the surface is not closed")
    n = len(surface.vertices)
    if len(vertices) < n or not np.array_equal(vertices[:n], surface.vertices):
        raise ToolError("tetgen: the surface's vertices are not the first of its output, as option -Y promises")
    return vertices, tets, MesherInfo("tetgen", _version(), OPTIONS)


def _version() -> str:
    """TetGen's own version as its help tells it."""
    with workspace() as directory:
        # `tetgen -h` ends by throwing its exit status: SIGABRT is its normal end.
        done = run(TETGEN, ["-h"], directory=directory, time_limit_s=10, memory_limit_bytes=None, accept=(0, 1, -6))
    found = re.search(r"Version\s+([0-9.]+)", done.output)
    return found.group(1) if found else "unknown"
