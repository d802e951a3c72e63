"""Levels finer than a file has, and values at the corners of triangles from means over them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.sparse import csr_matrix, identity
from scipy.sparse.linalg import splu

from quadgraph.file import graph_file, qgraph_file
from quadgraph.mesh.surface import TetMesh
from quadgraph.tets import graph, ordering, refine

_SHIFT = 1e-10  # of the least squares, so that there is one answer; fields are in single precision


def refined(path: Path, count: int, output: Path, rays: int = 0) -> Path:
    """Write the levels of a .qgraph below `count` levels more, each the finest so far with every tet cut in eight.

    The body's shape stays as it is. Nodes are where a mesh has them that has not been relaxed. rays: per face, that
    find what faces see of each other, 0 for none.
    """
    sections = qgraph_file.read(path).sections
    graphs, level = [], 0
    while f"level{level}/tets" in sections:
        vertices, tets = (sections[f"level{level}/{field}"] for field in ("vertices", "tets"))
        graphs.append(graph.build(TetMesh(vertices.astype(np.float64), tets.astype(np.int64))))
        level += 1
    for _ in range(count):
        graphs.insert(0, ordering.in_blocks(refine.refined(graphs[0])))
    return graph_file.write(output, graphs, rays)


class CornerValues:
    """Values at the vertices of a closed surface from means over its triangles, again and again."""

    def __init__(self, faces: np.ndarray) -> None:
        """faces: (n_f, 3), in which every vertex is."""
        rows = np.repeat(np.arange(len(faces)), 3)
        self._mean = csr_matrix((np.full(faces.size, 1 / 3), (rows, faces.ravel())))
        self._around = np.asarray(self._mean.sum(axis=0)).T
        normal = self._mean.T @ self._mean + _SHIFT * identity(self._mean.shape[1])
        self._inverse = splu(normal.tocsc(), "MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})

    def of(self, values: np.ndarray) -> np.ndarray:
        """Values (n, 3) at the vertices whose means over the corners of the faces are `values` (n_f, 3).

        M of linear elements is such a mean. A closed surface has twice as many faces as vertices, so it says what was
        averaged: by least squares, from the mean over the faces around a vertex, whose share it keeps where an even
        pattern of triangles leaves one undetermined.
        """
        start = (self._mean.T @ values) / self._around
        return start + self._inverse.solve(self._mean.T @ (values - self._mean @ start))


def at_corners(faces: np.ndarray, values: np.ndarray) -> np.ndarray:
    """CornerValues of one field."""
    return CornerValues(faces).of(values)
