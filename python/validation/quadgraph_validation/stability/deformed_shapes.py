"""Bodies that are hard to mesh, generated: needles, slivers, lattices and squeezed cubes; levels, finest first."""

from __future__ import annotations

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph.tets.graph import Graph
from quadgraph.tets.tet_geometry import determinants
from quadgraph_validation.bodies import meshes
from quadgraph_validation.stability.scaled_chains import Shape, graph_of

_EDGE = 6.0  # mm, of the cube
_CUBE_CELLS = (6, 3, 2)  # each layer of a level is made of whole ones of the finest
_STRUT, _PERIOD = 1.0, 2.0  # mm
# Genus to the cells of struts along x, y and z.
_LATTICES = {0: (0, 0, 0), 1: (1, 1, 0), 5: (1, 1, 1), 28: (2, 2, 2)}


def rod(aspect: float) -> list[Graph]:
    """4 mm thick, of elements 1 mm wide on the finest level and `aspect` times as long."""
    levels = []
    for across, along in ((4, 16), (2, 8), (1, 4)):
        side, length = np.linspace(0, 4.0, across + 1), np.linspace(0, 16.0 * aspect, along + 1)
        levels.append(meshes.box(length, side, side, meshes.no_wall))
    return levels


def block() -> list[Graph]:
    """A cube of 6 mm about the origin."""
    sides = [np.linspace(-_EDGE / 2, _EDGE / 2, cells + 1) for cells in _CUBE_CELLS]
    return [meshes.box(side, side, side, meshes.no_wall) for side in sides]


def squeezed(volume: float) -> Shape:
    """Along z, so that the two middle layers of the finest keep `volume` of their share; below 0 they fold over."""
    rest = np.linspace(-_EDGE / 2, _EDGE / 2, _CUBE_CELLS[0] + 1)
    layers = np.where(np.abs(rest[:-1] + rest[1:]) < 1.5 * (rest[1] - rest[0]), volume, 1.0)
    moved = np.concatenate([[0.0], np.cumsum(layers)]) / np.abs(layers.sum()) * _EDGE - _EDGE / 2

    def shape(points: np.ndarray) -> np.ndarray:
        return np.column_stack([points[:, :2], np.interp(points[:, 2], rest, moved)])

    return shape


def lattice(genus: int) -> list[Graph]:
    """Struts of 1 mm at distances of 1 mm around cubic cells: elements of half a strut, and of a whole one."""
    counts = _LATTICES[genus]
    return [_struts(counts, cells) for cells in (2, 1)]


def _struts(counts: tuple[int, int, int], cells: int) -> Graph:
    """With `cells` elements across a strut."""
    x, y, z = (np.arange(cells * (2 * count + 1) + 1) * _STRUT / cells for count in counts)
    body = meshes.box(x, y, z, meshes.no_wall)
    corners = body.vertices[body.tets]
    in_strut = (np.floor(corners.mean(axis=1) / _STRUT).astype(int) % 2 == 0).sum(axis=1)
    kept = body.tets[in_strut >= (2 if max(counts) else 3)]
    used, tets = np.unique(kept, return_inverse=True)
    return graph_of(body.vertices[used], tets.reshape(kept.shape))


def with_slivers(levels: list[Graph], angle: float) -> list[Graph]:
    """Inner vertices, no two of one tet, moved towards a face until the smallest dihedral angle is `angle` deg."""
    return [_spoilt(level, angle) for level in levels]


def _spoilt(mesh: Graph, angle: float) -> Graph:
    vertices, goals = _goals(mesh)
    if len(vertices) == 0 or smallest_dihedral(mesh.vertices, mesh.tets) <= angle:
        return mesh
    rest, low, high = mesh.vertices[vertices], 0.0, 1.0
    points = mesh.vertices.copy()
    for _ in range(40):
        middle = (low + high) / 2
        points[vertices] = (rest + middle * (goals - rest)).astype(np.float32)
        flat = determinants(points, mesh.tets).min() <= 0 or smallest_dihedral(points, mesh.tets) < angle
        low, high = (low, middle) if flat else (middle, high)
    points[vertices] = (rest + low * (goals - rest)).astype(np.float32)
    if determinants(points, mesh.tets).min() <= 0:
        raise InputError(f"slivers of {angle:g} degrees: single precision does not hold them")
    return graph_of(points, mesh.tets)


def _goals(mesh: Graph) -> tuple[np.ndarray, np.ndarray]:
    """Inner vertices of which no two share a tet, and for each the middle of a face opposite to it."""
    taken = np.zeros(len(mesh.vertices), bool)
    taken[: mesh.surface_vertex_count] = True
    vertices, goals = [], []
    for tet in mesh.tets:
        for corner in range(4):
            if taken[tet[corner]]:
                continue
            vertices.append(tet[corner])
            goals.append(mesh.vertices[np.delete(tet, corner)].mean(axis=0))
            taken[np.unique(mesh.tets[(mesh.tets == tet[corner]).any(axis=1)])] = True
    return np.array(vertices, np.int64), np.array(goals)


def smallest_dihedral(vertices: np.ndarray, tets: np.ndarray) -> float:
    """Smallest angle between two faces of a tet, degrees."""
    corners = np.asarray(vertices, np.float64)[tets]
    faces = [np.delete(np.arange(4), k) for k in range(4)]
    normals = []
    for k, face in enumerate(faces):
        a, b, c = (corners[:, i] for i in face)
        normal = np.cross(b - a, c - a)
        outward = normal * -np.sign(np.einsum("ij,ij->i", normal, corners[:, k] - a))[:, None]
        normals.append(outward / np.linalg.norm(outward, axis=1)[:, None])
    cosines = [np.einsum("ij,ij->i", normals[i], normals[j]) for i in range(4) for j in range(i)]
    return float(np.degrees(np.arccos(np.clip(-np.array(cosines), -1, 1)).min()))
