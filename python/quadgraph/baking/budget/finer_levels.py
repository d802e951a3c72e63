"""Levels finer than a file has, and values at the corners of triangles from means over them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import lsqr

from quadgraph.file import graph_file, qgraph_file
from quadgraph.mesh.surface import TetMesh
from quadgraph.tets import graph, ordering, refine

_ACCURACY = 1e-8  # of the least squares; fields are in single precision


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


def at_corners(faces: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Values (n, 3) at the surface's vertices whose means over the corners of faces (n_f, 3) are `values` (n_f, 3).

    M of linear elements is such a mean. A closed surface has twice as many faces as vertices, so it says what was
    averaged: by least squares, from the mean over the faces around a vertex, whose share it keeps where an even pattern
    of triangles leaves one undetermined.
    """
    rows = np.repeat(np.arange(len(faces)), 3)
    mean = csr_matrix((np.full(faces.size, 1 / 3), (rows, faces.ravel())))
    start = (mean.T @ values) / np.asarray(mean.sum(axis=0)).T
    rest = values - mean @ start
    steps = [lsqr(mean, rest[:, c], atol=_ACCURACY, btol=_ACCURACY, iter_lim=2000)[0] for c in range(values.shape[1])]
    return start + np.column_stack(steps)
