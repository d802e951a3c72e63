"""Diffusion on a polygrid by SciPy, in double precision: an answer to hold the engine's against.

Rows (Wang et al. 2008, Eq. 9), w the weights of Appendix B, d the distance from a boundary node to its neighbour j:
    published:  sum_j w_j (kappa_i phi_i - kappa_j phi_j) + sigma_a phi_i = 0
    divergence: sum_j w_j kappa_ij (phi_i - phi_j)        + sigma_a phi_i = 0, kappa_ij the harmonic mean
    boundary:   kappa (phi_i - phi_j) / d + k phi_i = load, kappa = kappa_i if published, else kappa_ij
The published rows discretise the Laplacian of kappa phi, which is another equation wherever kappa varies.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import spsolve

from quadgraph.tets.graph import Graph
from quadgraph.tets.polygrid import weights
from quadgraph.tets.polygrid.grid_report import offsets


def neighbours(graph: Graph) -> np.ndarray:
    """(n_s,) the vertex below the surface that each surface vertex is linked to."""
    assert graph.grid_links is not None
    first = graph.surface_vertex_count
    row, slot = np.nonzero(graph.grid_links < first)
    inner = np.empty(first, np.int64)
    inner[graph.grid_links[row, slot]] = first + row
    return inner


def operator(
    graph: Graph, kappa: np.ndarray, sigma_a: np.ndarray, outflow: float, published: bool
) -> sparse.csr_matrix:
    """The rows above, from coefficients (n_v,) at the vertices, mm and 1/mm; outflow: k."""
    assert graph.grid_links is not None
    first, count = graph.surface_vertex_count, len(graph.vertices)
    weight, _ = weights.laplacian(offsets(graph))
    rows = np.arange(first, count)
    links = graph.grid_links
    here, there = kappa[rows][:, None], kappa[links]
    own, other = (here, there) if published else (2 * here * there / (here + there),) * 2
    inner = neighbours(graph)
    surface = np.arange(first)
    at_surface = kappa[:first]
    if not published:
        at_surface = 2 * at_surface * kappa[inner] / (at_surface + kappa[inner])
    per_distance = at_surface / np.linalg.norm(graph.vertices[surface] - graph.vertices[inner], axis=1)
    diagonal = np.concatenate([per_distance + outflow, (weight * own).sum(axis=1) + sigma_a[rows]])
    matrix = sparse.coo_matrix(
        (
            np.concatenate([diagonal, -per_distance, -(weight * other).ravel()]),
            (
                np.concatenate([np.arange(count), surface, np.repeat(rows, 6)]),
                np.concatenate([np.arange(count), inner, links.ravel()]),
            ),
        ),
        shape=(count, count),
    )
    return matrix.tocsr()


def solve(
    graph: Graph,
    kappa: np.ndarray,
    sigma_a: np.ndarray,
    outflow: float,
    load: np.ndarray,
    published: bool = False,
    source: np.ndarray | None = None,
) -> np.ndarray:
    """phi (n_v,) for (n_s,) `load` at the boundary nodes, W/mm^2, and (n_v,) `source` per volume, W/mm^3."""
    right = np.zeros(len(graph.vertices)) if source is None else source.astype(np.float64)
    right[: graph.surface_vertex_count] = load
    return spsolve(operator(graph, kappa, sigma_a, outflow, published).tocsc(), right)
