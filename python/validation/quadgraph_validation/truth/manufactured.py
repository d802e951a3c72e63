"""A manufactured solution with smooth coefficients, for the linear elements of either model.

Fields u(x), sigma_s'(x) and sigma_a(x) are chosen; the volume source S = -div(kappa G grad u) + C u and the surface
source g = kappa G du/dn + K u follow. G and C are those of moments.py, K that of boundary.py.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import cg

from quadgraph.base.errors import SolverError
from quadgraph.core import load_core
from quadgraph.file import graph_file
from quadgraph.tets.graph import Graph
from quadgraph.tets.tet_geometry import determinants
from quadgraph_validation.bodies import meshes
from quadgraph_validation.truth import boundary
from quadgraph_validation.truth.moments import ABSORPTION, EXTINCTION, STIFFNESS

# Barycentric points that integrate quadratics exactly over a tet and a triangle, with equal weights.
_TET_POINTS = np.full((4, 4), (5 - np.sqrt(5)) / 20) + np.eye(4) * np.sqrt(5) / 5
_FACE_POINTS = np.full((3, 3), 1 / 6) + np.eye(3) / 2

# Wave vectors, 1/mm, of the moments: u_i = 2 - i + sin(wave_i . x) / (1 + i).
_WAVES = np.array([[1.3, -0.8, 0.9], [-0.7, 1.1, 1.6]])
_SIGMA_T = (6.0, np.array([1.5, 0.8, -0.6]))  # at the origin and its gradient, 1/mm and 1/mm^2
_SIGMA_A = (1.0, np.array([0.3, -0.4, 0.2]))


def fields(points: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """u (n, m), gradient (n, m, 3) and Laplacian (n, m) at (n, 3) mm."""
    phase = points @ _WAVES[:count].T
    size = 1 / np.arange(1, count + 1)
    value = 2 - np.arange(count) + size * np.sin(phase)
    gradient = (size * np.cos(phase))[:, :, None] * _WAVES[:count]
    return value, gradient, -size * np.sin(phase) * (_WAVES[:count] ** 2).sum(axis=1)


def coefficients(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """sigma_t' and sigma_a, (n,) in 1/mm, at (n, 3) mm within a unit ball."""
    return _SIGMA_T[0] + points @ _SIGMA_T[1], _SIGMA_A[0] + points @ _SIGMA_A[1]


def volume_source(points: np.ndarray, count: int) -> np.ndarray:
    """S (n, m) at (n, 3) mm."""
    value, gradient, laplacian = fields(points, count)
    sigma_t, sigma_a = coefficients(points)
    kappa = 1 / (3 * sigma_t)
    kappa_gradient = -kappa[:, None] / sigma_t[:, None] * _SIGMA_T[1]
    divergence = kappa[:, None] * laplacian + np.einsum("nij,nj->ni", gradient, kappa_gradient)
    mass = sigma_a[:, None, None] * ABSORPTION[count] + sigma_t[:, None, None] * EXTINCTION[count]
    return np.einsum("nij,nj->ni", mass, value) - divergence @ STIFFNESS[count]


def surface_source(points: np.ndarray, normals: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    """g (n, m) at (n, 3) mm with outward unit normals (n, 3) under boundary matrix (m, m)."""
    count = len(matrix)
    value, gradient, _ = fields(points, count)
    kappa = 1 / (3 * coefficients(points)[0])
    return kappa[:, None] * np.einsum("nij,nj->ni", gradient, normals) @ STIFFNESS[count] + value @ matrix


def volume_error(mesh: Graph, model: str, eta: float) -> float:
    """Relative L2 error, over a mesh of the unit ball, of the linear elements' moments; the engine assembles them."""
    matrix = getattr(boundary, model)(eta).matrix
    count = len(matrix)
    rows = _assembled(mesh, model, eta)
    solution, failed = cg(rows, _load(mesh, matrix).ravel(), rtol=1e-9, M=sparse.diags(1 / rows.diagonal()))
    if failed:
        raise SolverError(f"manufactured solution: conjugate gradients stopped after {failed} iterations")
    solution = solution.reshape(-1, count)
    corners = mesh.vertices[mesh.tets]
    volume = determinants(mesh.vertices, mesh.tets) / 6
    error = size = 0.0
    for weights in _TET_POINTS:
        exact = fields(weights @ corners, count)[0]
        found = np.einsum("k,nki->ni", weights, solution[mesh.tets])
        error += volume @ ((found - exact) ** 2).sum(axis=1)
        size += volume @ (exact**2).sum(axis=1)
    return float(np.sqrt(error / size))


def _load(mesh: Graph, matrix: np.ndarray) -> np.ndarray:
    """(vertices, m) integrals of both sources against the basis functions."""
    count = len(matrix)
    load = np.zeros((len(mesh.vertices), count))
    volume = determinants(mesh.vertices, mesh.tets) / 6
    for weights in _TET_POINTS:
        density = volume_source(weights @ mesh.vertices[mesh.tets], count) * volume[:, None] / 4
        np.add.at(load, mesh.tets, weights[None, :, None] * density[:, None, :])
    _, normals, area = meshes.face_frames(mesh)
    for weights in _FACE_POINTS:
        density = surface_source(weights @ mesh.vertices[mesh.faces], normals, matrix) * area[:, None] / 3
        np.add.at(load, mesh.faces, weights[None, :, None] * density[:, None, :])
    return load


def _assembled(mesh: Graph, model: str, eta: float) -> sparse.csr_matrix:
    """The engine's rows for fem as a matrix of (vertices x moments) unknowns, moments side by side."""
    core = load_core()
    sigma_t, sigma_a = (np.repeat(values[:, None], 3, axis=1) for values in coefficients(mesh.nodes))
    with tempfile.TemporaryDirectory(prefix="quadgraph-study-") as folder:
        graph = core.load(graph_file.write(Path(folder) / "study.qgraph", [mesh]))
    rows = core.assemble(graph, 0, "fem", sigma_t - sigma_a, sigma_a, eta, source="buried", model=model)
    offset, column = rows["offset"], rows["column"]
    row = np.repeat(np.arange(len(offset) - 1), np.diff(offset))
    size = len(offset) - 1
    i = np.concatenate([row, np.arange(size)])
    j = np.concatenate([column, np.arange(size)])
    entries = np.concatenate([rows["weight"], rows["diagonal"]])[..., 0].reshape(len(i), -1)
    if entries.shape[1] == 1:
        return sparse.csr_matrix((entries[:, 0], (i, j)), shape=(size, size))
    parts = [(0, 0, 0), (0, 1, 1), (1, 0, 1), (1, 1, 2)]
    return sparse.csr_matrix(
        (
            np.concatenate([entries[:, k] for _, _, k in parts]),
            (np.concatenate([2 * i + a for a, _, _ in parts]), np.concatenate([2 * j + b for _, b, _ in parts])),
        ),
        shape=(2 * size, 2 * size),
    )
