"""Edges of a body, which stay sharp, and the normals of the smooth surface between them."""

from __future__ import annotations

import numpy as np

from quadgraph.mesh.surface import Surface

CREASE_DEGREES = 40.0  # between the normals of two triangles
_SAME_NORMAL = 1e-3  # normals of a file that are nearer than this, in each coordinate, are one
_SAME_PLACE = 1e-6  # places in a texture, the same


def creases(surface: Surface) -> np.ndarray:
    """(e,) whether each edge of the topology of a closed surface is one of the body, by the angle of its triangles."""
    edges = surface.topology
    normal = unit(surface.doubled_normals)
    order = np.argsort(edges.face_edges.ravel(), kind="stable")
    pairs = (order // 3).reshape(-1, 2)
    cosine = np.einsum("ij,ij->i", normal[pairs[:, 0]], normal[pairs[:, 1]])
    return cosine < np.cos(np.radians(CREASE_DEGREES))


def corner_normals(surface: Surface, sharp: np.ndarray) -> np.ndarray:
    """(m, 3, 3) normals at the corners of triangles, from the triangles up to the next crease.

    Weighted so that they are those of the ball where all vertices are on one (Max 1999).
    """
    fan = surface.fans(sharp)
    squared = (np.roll(surface.corners, -1, axis=1) - surface.corners) ** 2
    squared = np.maximum(squared.sum(axis=2), np.finfo(np.float32).tiny)  # of edge k, from corner k on
    weighted = surface.doubled_normals[:, None] / (squared * np.roll(squared, 1, axis=1))[:, :, None]
    sums = np.stack([np.bincount(fan.ravel(), weighted[:, :, axis].ravel()) for axis in range(3)], axis=1)
    return unit(sums)[fan]


def parted(
    surface: Surface, given: np.ndarray | None = None, more: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A closed surface with a vertex for each side of its edges: the old vertex of each, triangles, unit normals.

    given: (m, 3, 3) unit normals at corners, which win, 0 where there is none: a vertex is parted by them alone; more:
    (m, 3, c) what else parts it. The old vertices come first, in their order. (n,), (m, 3) and (n, 3).
    """
    sharp = creases(surface)
    return parted_by(surface, surface.fans(sharp), corner_normals(surface, sharp), given, more)


def parted_by(
    surface: Surface,
    sides: np.ndarray,
    normals: np.ndarray,
    given: np.ndarray | None = None,
    more: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """As `parted`, of any surface whose corners are of the sides (m, 3), with normals (m, 3, 3) that are of them."""
    if given is not None:
        known = np.any(given, axis=2)
        rows = np.column_stack([surface.triangles[known], np.round(given[known] / _SAME_NORMAL)])
        sides, normals = sides.copy(), np.where(known[:, :, None], given, normals)
        sides[known] = sides.max() + 1 + np.unique(rows, axis=0, return_inverse=True)[1].reshape(-1)
    if more is not None:
        rows = np.concatenate([sides[:, :, None], np.round(more / _SAME_PLACE)], axis=2)
        sides = np.unique(rows.reshape(-1, rows.shape[2]), axis=0, return_inverse=True)[1].reshape(sides.shape)
    _, first, side = np.unique(sides.ravel(), return_index=True, return_inverse=True)
    vertex = surface.triangles.ravel()[first]
    further = np.ones(len(first), bool)
    further[np.unique(vertex, return_index=True)[1]] = False
    place = np.where(further, len(surface.vertices) + np.cumsum(further) - 1, vertex)
    old = np.concatenate([np.arange(len(surface.vertices)), vertex[further]])
    placed = np.tile([0.0, 0.0, 1.0], (len(old), 1))
    found = normals.reshape(-1, 3)[first]
    some = np.any(found, axis=1)
    placed[place[some]] = found[some]
    return old, place[side].reshape(-1, 3), placed


def unit(vectors: np.ndarray) -> np.ndarray:
    """Vectors along the last axis at unit length; zero stays zero."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.maximum(length, np.finfo(float).tiny)
