"""Triangles of a surface that cross one another, by Debian's TetGen as a child program, whose test is exact."""

from __future__ import annotations

import numpy as np

from quadgraph.base.child_process import Program, run, workspace
from quadgraph.base.errors import ToolError
from quadgraph.mesh.surface import Surface
from quadgraph.mesh.tet_files import read_faces, write_smesh

TETGEN = Program("tetgen", "install Debian's package tetgen: apt install tetgen")
# Time limits of the test for self-intersection, which takes about 0.1 ms a vertex on an idle core: room for a busy one.
_TEST_TIME_LIMIT_S, _TEST_TIME_PER_VERTEX_S = 120.0, 2e-3
_TEST_MEMORY_BYTES, _TEST_MEMORY_PER_VERTEX = 2_000_000_000, 20_000  # it takes 2,600 a vertex


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
        done = run(
            TETGEN,
            ["-d", "surface.smesh"],
            directory=directory,
            time_limit_s=_time_limit_s(len(surface.vertices)),
            memory_limit_bytes=_TEST_MEMORY_BYTES + _TEST_MEMORY_PER_VERTEX * len(surface.vertices),
        )
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
