"""Files exchanged with the meshers: TetGen's .smesh in, its .node and .ele out (the CGAL mesher writes the same)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from quadgraph.base.errors import ToolError
from quadgraph.mesh.surface import Surface

_HOLE_STEP = 1e-3  # of a triangle's size: how far before it a cavity is marked


def _hole_points(surface: Surface) -> np.ndarray:
    """(h, 3) a point in each cavity, mm: just before the largest triangle of each piece that encloses negative volume.

    TetGen would fill a cavity that no point marks.
    """
    points = []
    count, labels = surface.vertex_components
    if count > 1:
        piece_of = labels[surface.triangles[:, 0]]
        for piece in np.unique(piece_of):
            part = Surface(surface.vertices, surface.triangles[piece_of == piece])
            if part.volume < 0:
                size = np.linalg.norm(part.doubled_normals, axis=1)
                largest = size.argmax()
                step = _HOLE_STEP * part.doubled_normals[largest] / np.sqrt(size[largest])
                points.append(part.corners[largest].mean(axis=0) + step)
    return np.array(points).reshape(-1, 3)


def write_smesh(surface: Surface, path: Path, outer: Surface | None = None) -> None:
    """Write closed surfaces as TetGen's .smesh with 17 digits, so that the program reads the very same doubles.

    outer: of them the one whose cavities stay empty, None for all.
    """
    n, m = len(surface.vertices), len(surface.triangles)
    found = _hole_points(outer or surface)
    points, holes = (
        "".join(f"{i} {x!r} {y!r} {z!r}\n" for i, (x, y, z) in enumerate(rows.tolist()))
        for rows in (surface.vertices, found)
    )
    facets = "".join(f"3 {a} {b} {c}\n" for a, b, c in surface.triangles.tolist())
    path.write_text(f"{n} 3 0 0\n{points}{m} 0\n{facets}{len(found)}\n{holes}0\n")


def write_volumes(volumes: np.ndarray, path: Path) -> None:
    """Write the largest volume that each tet may have, mm^3, as TetGen's .vol."""
    rows = "".join(f"{i} {volume!r}\n" for i, volume in enumerate(volumes.tolist()))
    path.write_text(f"{len(volumes)}\n{rows}")


def write_off(surface: Surface, path: Path) -> None:
    """Write a surface as OFF with 17 digits."""
    points = "".join(f"{x!r} {y!r} {z!r}\n" for x, y, z in surface.vertices.tolist())
    facets = "".join(f"3 {a} {b} {c}\n" for a, b, c in surface.triangles.tolist())
    path.write_text(f"OFF\n{len(surface.vertices)} {len(surface.triangles)} 0\n{points}{facets}")


def _read_table(path: Path, columns: int, dtype: type) -> np.ndarray:
    """Rows of a TetGen file without its index column; raises ToolError if its header and content disagree."""
    with path.open() as lines:
        count = int(lines.readline().split()[0])
        wanted = range(1, columns + 1)
        table = (
            np.loadtxt(lines, dtype=dtype, comments="#", usecols=wanted, ndmin=2) if count else np.empty((0, columns))
        )
    if len(table) != count:
        raise ToolError(f"{path.name}: header announces {count} rows, found {len(table)}")
    return np.asarray(table, dtype).reshape(-1, columns)


def read_tets(stem: Path) -> tuple[np.ndarray, np.ndarray]:
    """Read `stem`.node and `stem`.ele: (n, 3) float64 and (m, 4) int64, indices from 0.

    Raises ToolError if a file is missing, incomplete, or names a vertex that is not there.
    """
    try:
        vertices = _read_table(stem.with_name(stem.name + ".node"), 3, np.float64)
        tets = _read_table(stem.with_name(stem.name + ".ele"), 4, np.int64)
    except (OSError, ValueError, IndexError) as error:
        raise ToolError(f"mesher output {stem.name}: {error}") from error
    if len(tets) and (tets.min() < 0 or tets.max() >= len(vertices)):
        raise ToolError(f"{stem.name}.ele: vertex index {tets.max()} found, allowed are 0 to {len(vertices) - 1}")
    return vertices, tets


def read_faces(path: Path) -> np.ndarray:
    """Read a TetGen .face file: (m, 3) int64 vertex indices; none if the file is not there."""
    return _read_table(path, 3, np.int64) if path.exists() else np.empty((0, 3), np.int64)
