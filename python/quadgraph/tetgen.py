"""Debian's TetGen as a child program: tetrahedra inside a surface, and the exact test for self-intersection.

TetGen is under the AGPL and stays a separate program. Version 1.5.0 aborts on much bad input and exits 0 with no tets
on an open surface; both become a ToolError here.
"""

from __future__ import annotations

import re

import numpy as np

from quadgraph.child_process import Program, run, workspace
from quadgraph.errors import ToolError
from quadgraph.surface import MesherInfo, Surface
from quadgraph.tet_files import read_faces, read_tets, write_smesh

TETGEN = Program("tetgen", "install Debian's package tetgen: apt install tetgen")
OPTIONS = "-pYq1.4/0"  # piecewise linear complex, surface kept, radius-edge ratio 1.4, no dihedral bound
# Of the test for self-intersection, which takes about 0.1 ms a vertex on an idle core: room for a busy or slow one.
_TEST_TIME_LIMIT_S, _TEST_TIME_PER_VERTEX_S = 120.0, 2e-3


def _time_limit_s(vertices: int) -> float:
    """How long the test for self-intersection of a surface of so many vertices may take, s."""
    return _TEST_TIME_LIMIT_S + _TEST_TIME_PER_VERTEX_S * vertices


def intersecting_triangles(surface: Surface) -> np.ndarray:
    """Indices of triangles that cross another, by TetGen's exact predicates; (0,) if there are none.

    Unlike pymeshlab's count this includes crossings between triangles that share a vertex. Coincident vertices must
    have been merged. Raises ToolError if TetGen fails without an answer.
    """
    with workspace() as directory:
        write_smesh(surface, directory / "surface.smesh")
        done = run(TETGEN, ["-d", "surface.smesh"], directory=directory,
                   time_limit_s=_time_limit_s(len(surface.vertices)), memory_limit_bytes=None)  # fmt: skip
        crossing = read_faces(directory / "surface.1.face")
    if not len(crossing) and "No faces are intersecting" not in done.output:
        raise ToolError(f"tetgen -d: no verdict on self-intersection: {done.output[-300:].strip()}")
    n = len(surface.vertices)
    return np.flatnonzero(np.isin(_keys(surface.triangles, n), _keys(crossing, n)))


def _keys(triangles: np.ndarray, vertices: int) -> np.ndarray:
    """One number per triangle, the same for every order of its corners."""
    a, b, c = np.sort(triangles, axis=1).T
    # Wraps around beyond 2**21 vertices, harmlessly: both sides wrap alike.
    return (a * vertices + b) * vertices + c


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
