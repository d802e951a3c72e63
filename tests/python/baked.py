"""Small .qgraph files made from generated surfaces, without repair or decimation."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from quadgraph import graph, qgraph_file, sections
from quadgraph.surface import Surface, TetMesh
from quadgraph.tetrahedralise import tetrahedralise


def write_levels(path: Path, surfaces: list[Surface]) -> Path:
    """Tetrahedralise each surface (finest first) and write them as the levels of one file."""
    return write_graphs(path, [graph.build(tetrahedralise(surface, mesher="tetgen")) for surface in surfaces])


def write_graphs(path: Path, graphs: list[graph.Graph]) -> Path:
    """Write levels, finest first, with the finest boundary as the display mesh."""
    boundary = graphs[0].boundary
    used = int(boundary.triangles.max()) + 1
    display = Surface(boundary.vertices[:used], boundary.triangles)
    metadata = {
        "generator": "tests",
        "source": {"name": "generated", "sha256": "", "vertices": 0, "triangles": 0},
        "unit_mm": 1.0,
        "mesher": {"name": "tetgen", "version": "", "options": "", "grading": None},
        "repairs": [],
        "levels": [sections.level_metadata(g) for g in graphs],
        "tools": {},
    }
    qgraph_file.write(path, metadata, sections.whole_file(graphs, display))
    return path


def refined_sphere(mesh: graph.Graph, radius: float) -> graph.Graph:
    """Cut every tet into eight and put new surface vertices on the sphere: the edge length halves everywhere."""
    vertices, tets = mesh.vertices, mesh.tets
    pairs = np.array([(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)])
    edges = np.sort(tets[:, pairs].reshape(-1, 2), axis=1)
    unique, inverse = np.unique(edges, axis=0, return_inverse=True)
    middles = vertices[unique].mean(axis=1)
    outside = np.sort(mesh.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    on_surface = np.isin(unique @ [len(vertices), 1], outside @ [len(vertices), 1])
    middles[on_surface] *= radius / np.linalg.norm(middles[on_surface], axis=1)[:, None]
    middle = len(vertices) + inverse.reshape(-1, 6)
    points = np.concatenate([vertices, middles]).astype(np.float32).astype(np.float64)
    corners = [np.column_stack([tets[:, k], middle[:, (pairs == k).any(axis=1)]]) for k in range(4)]
    children = np.concatenate([*corners, *_octahedron(points, middle)])
    p = points[children]
    flipped = np.einsum("ij,ij->i", p[:, 1] - p[:, 0], np.cross(p[:, 2] - p[:, 0], p[:, 3] - p[:, 0])) < 0
    children[flipped] = children[flipped][:, [0, 1, 3, 2]]
    return graph.build(TetMesh(points, children, mesher=None))


def _octahedron(points: np.ndarray, middle: np.ndarray) -> list[np.ndarray]:
    """Four tets around the shortest diagonal of the octahedron between the edge middles; others would degenerate."""
    rings = np.array([[0, 5, 1, 2, 4, 3], [1, 4, 0, 2, 5, 3], [2, 3, 0, 1, 5, 4]])  # diagonal, then the ring around it
    ends = points[middle[:, rings[:, :2]]]
    choice = rings[np.linalg.norm(ends[:, :, 0] - ends[:, :, 1], axis=2).argmin(axis=1)]
    ordered = np.take_along_axis(middle, choice, axis=1)
    return [ordered[:, [0, 1, 2 + k, 2 + (k + 1) % 4]] for k in range(4)]


def face_frames(level) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Centroid (n, 3) mm, outward unit normal (n, 3) and area (n,) mm^2 of a level's outside faces."""
    corners = np.asarray(level.vertices, np.float64)[level.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1)
    return corners.mean(axis=1), normal / length[:, None], length / 2
