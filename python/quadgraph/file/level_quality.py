"""How good a baked level is: angles of its tets, lengths of its links, locality of its order."""

from __future__ import annotations

from typing import Any

import numpy as np

from quadgraph.file.qgraph_file import QGraphFile
from quadgraph.mesh.surface import Surface
from quadgraph.tets.ordering import locality

_EDGES = np.array([[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]])
_OPPOSITE = np.array([[2, 3], [1, 3], [1, 2], [0, 3], [0, 2], [0, 1]])


def dihedral_angles(vertices: np.ndarray, tets: np.ndarray) -> np.ndarray:
    """(n_t, 6) angles between the faces that meet at each edge, degrees; vertices (n_v, 3) in any unit."""
    corners = np.asarray(vertices, np.float64)[tets]
    angles = []
    for (a, b), (c, d) in zip(_EDGES, _OPPOSITE, strict=True):
        edge = corners[:, b] - corners[:, a]
        one, other = np.cross(edge, corners[:, c] - corners[:, a]), np.cross(edge, corners[:, d] - corners[:, a])
        sine = np.linalg.norm(np.cross(one, other), axis=1)
        angles.append(np.degrees(np.arctan2(sine, np.einsum("ij,ij->i", one, other))))
    return np.stack(angles, axis=1)


def boundary(file: QGraphFile, number: int) -> Surface:
    """The outside faces of one level, mm."""
    return Surface(file.sections[f"level{number}/vertices"].astype(np.float64), file.sections[f"level{number}/faces"])


def of_level(file: QGraphFile, number: int) -> dict[str, Any]:
    """Node count, dihedral angles (degrees), mean link length (mm) and locality of one level, as plain values."""
    tets, links, nodes = (file.sections[f"level{number}/{name}"] for name in ("tets", "links", "nodes"))
    angles = dihedral_angles(file.sections[f"level{number}/vertices"], tets)
    length = np.linalg.norm(nodes[: len(tets), None].astype(np.float64) - nodes[links], axis=2)
    inside = np.where(links < len(tets), links.astype(np.int64), np.arange(len(tets))[:, None])
    return {
        "nodes": len(nodes),
        "dihedral_degrees": {
            "min": float(angles.min()),
            "percentile_1": float(np.percentile(angles, 1)),
            "max": float(angles.max()),
        },
        "mean_link_mm": float(length.mean()),
        "locality": locality(inside),
    }
