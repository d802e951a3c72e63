"""Debian's TetGen as a child program: tetrahedra inside a surface.

TetGen is under the AGPL and stays a separate program. Version 1.5.0 aborts on much bad input and exits 0 with no tets
on an open surface; both become a ToolError here.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Sequence
from functools import cache, partial
from pathlib import Path

import numpy as np

from quadgraph.base.child_process import run, workspace
from quadgraph.base.errors import ToolError
from quadgraph.mesh.intersections import TETGEN
from quadgraph.mesh.surface import MesherInfo, Surface, joined_surface
from quadgraph.mesh.tet_files import read_tets, write_smesh, write_volumes
from quadgraph.tets.interior import expected_tets
from quadgraph.tets.tet_geometry import determinants

OPTIONS = "-pYq1.4/0"  # piecewise linear complex, surface kept, radius-edge ratio 1.4, no dihedral bound
REFINE = "-rYq1.4/0a"  # the same on tets that are there, with the volumes of a .vol file
REFINE_LOOSELY = "-rYq2/0a"  # where that has no end, as between flat parts of a surface that stays
# Refining takes about half of what filling took for as many tets: where it goes on for much longer it has no end.
_LEAST_REFINING_S, _MOST_REFINING = 10, 6
_PASSES = 3  # a limit holds for what becomes of a tet, so that large ones are asked for again


def fill(
    surface: Surface,
    time_limit_s: float,
    memory_limit_bytes: int,
    limits: Callable[[np.ndarray, np.ndarray], np.ndarray | None] | None = None,
    inner: Sequence[Surface] = (),
) -> tuple[np.ndarray, np.ndarray, MesherInfo]:
    """Fill a closed surface with tetrahedra; its vertices come first and its triangles are the boundary.

    inner: closed surfaces within it, whose vertices come next and whose triangles are faces of tets on both sides;
    limits: from vertices and tets to the volumes (m,), mm^3, that those may have, None where they stay as they are.
    Returns (n, 3) float64 vertices, mm, and (m, 4) int64 tets of either orientation. Raises ToolError.
    """
    options, whole = OPTIONS, joined_surface([surface, *inner])

    def made(directory: Path, arguments: list[str], stem: str, seconds: float) -> tuple[np.ndarray, np.ndarray]:
        done = run(TETGEN, arguments, directory=directory, time_limit_s=seconds, memory_limit_bytes=memory_limit_bytes)
        if not (directory / f"{stem}.ele").exists():
            raise ToolError(f"tetgen: wrote no tetrahedra: {done.output[-300:].strip()}")
        return read_tets(directory / stem)

    with workspace() as directory:
        write_smesh(whole, directory / "surface.smesh", surface)
        start = time.perf_counter()
        vertices, tets = made(
            directory, [OPTIONS + ("" if limits else "F"), "surface.smesh"], "surface.1", time_limit_s
        )
        filling, filled = time.perf_counter() - start, max(len(tets), 1)
        switches = REFINE
        for number in range(1, 1 + _PASSES):
            volumes = limits(vertices, tets) if limits and len(tets) else None
            if volumes is None:
                break
            write_volumes(volumes, directory / f"surface.{number}.vol")
            expected = expected_tets(np.abs(determinants(vertices, tets)) / 6, volumes)
            seconds = min(time_limit_s, refining_s(filling, filled, expected))
            refine = partial(made, directory, stem=f"surface.{number + 1}", seconds=seconds)
            try:
                vertices, tets = refine([switches, f"surface.{number}"])
            except ToolError:
                if switches == REFINE_LOOSELY:
                    raise
                switches = REFINE_LOOSELY
                vertices, tets = refine([switches, f"surface.{number}"])
            options = f"{OPTIONS}, {switches}"
    if not len(tets):
        raise ToolError("tetgen: made no tetrahedra; the surface is not closed")
    n = len(whole.vertices)
    if len(vertices) < n or not np.array_equal(vertices[:n], whole.vertices):
        raise ToolError(
            "tetgen: vertices of the surface were left out or moved, as where two nearly meet; merge or move such "
            "ones, or try --mesher cgal"
        )
    return vertices, tets, MesherInfo("tetgen", _version(TETGEN.path()), options)


def refining_s(filling_s: float, filled: int, expected: float) -> float:
    """Seconds after which refining to so many tets as are expected has no end, where filling made `filled`."""
    return max(_LEAST_REFINING_S, _MOST_REFINING * filling_s * expected / filled)


@cache
def _version(program: Path) -> str:
    """TetGen's own version as its help tells it."""
    with workspace() as directory:
        # `tetgen -h` ends by throwing its exit status: SIGABRT is its normal end.
        done = run(TETGEN, ["-h"], directory=directory, time_limit_s=10, memory_limit_bytes=None, accept=(0, 1, -6))
    found = re.search(r"Version\s+([0-9.]+)", done.output)
    return found.group(1) if found else "unknown"
