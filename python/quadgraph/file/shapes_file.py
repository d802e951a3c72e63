"""Vertex animations: what the frames of a mesh make of a body's display mesh and of all its tets.

A frame gives the displacement of the surface. The vertices of the display mesh and the surface vertices of every level
get it at the nearest point of the rest frame; inside it is harmonic (linear elements, as smooth as can be between
given ends), so that an affine motion of the surface is the same motion of the whole.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from quadgraph.base.errors import FormatError, InputError
from quadgraph.base.units import UPS
from quadgraph.file import qgraph_file
from quadgraph.mesh.display_map import nearest_faces
from quadgraph.mesh.gltf_file import GltfFile, read
from quadgraph.mesh.gltf_morph import read_targets
from quadgraph.mesh.gltf_skin import has_skin, read_frames
from quadgraph.mesh.mesh_io import read_surface, stood_up
from quadgraph.mesh.surface import Surface

_SUFFIXES = (".obj", ".off", ".ply")  # those whose vertices keep their order
_FAR = 0.01  # of the diagonal: a display vertex farther than that from the rest frame belongs to something else


@dataclass(frozen=True)
class StoredShapes:
    """Displacements in mm, float32: `display` (shapes, n_d, 3), `levels` (shapes, n_v, 3) each, finest first."""

    display: np.ndarray
    levels: list[np.ndarray]

    def in_memory(self):
        """What the engine takes as "shapes" of a `displaced` deformer."""
        from quadgraph.core import load_core

        return load_core().Shapes(self.display, self.levels)

    def write(self, path: Path) -> int:
        """Write a .qshapes file (docs/deformation.md) atomically; its size. Raises InputError."""
        sections = {"shapes": np.array([len(self.display)], np.uint32), "display": _rows(self.display)}
        sections |= {f"level{number}": _rows(level) for number, level in enumerate(self.levels)}
        return qgraph_file.write_sections(path, {"kind": "shapes"}, sections)


def from_gltf(body: Path, path: Path, rate: float = 24, animation: str | None = None) -> StoredShapes:
    """Shapes of a .glb or .gltf whose mesh, unposed, lies where that of the baked `body` does, in its unit.

    Of skinned meshes the frames of the animation of that name, or the only one, `rate` a second; without a skin a shape
    for each morph target. Raises InputError, FormatError.
    """
    file = qgraph_file.read(body)
    unit_mm = file.metadata["unit_mm"]
    vertices, triangles, moves = read(path, lambda gltf: _moves_of(gltf, rate, animation))
    up = up_of(file, body)
    return of_moves(file, Surface(stood_up(vertices, up) * unit_mm, triangles), stood_up(moves, up) * unit_mm)


def up_of(file: qgraph_file.QGraphFile, body: Path) -> str:
    """The axis that points up in the mesh of a body; files from before it was kept have y."""
    options = file.metadata.get("options")
    up = options.get("up", "y") if isinstance(options, dict) else "y"
    if up not in UPS:
        raise FormatError(f"{body}: metadata: options/up: {str(up)[:40]!r} found, allowed are {' and '.join(UPS)}")
    return up


def _moves_of(file: GltfFile, rate: float, animation: str | None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Vertices (n, 3), triangles (m, 3), displacements (shapes, n, 3)."""
    if has_skin(file):
        skinned = read_frames(file, rate, animation)
        return skinned.vertices, skinned.triangles, skinned.frames - skinned.vertices
    morph = read_targets(file)
    return morph.vertices, morph.triangles, morph.targets


def from_frames(body: Path, rest: Path, frames: Sequence[Path]) -> StoredShapes:
    """Read frames of the mesh `rest`, which lies where that of the baked `body` does, in its unit.

    .obj, .ply or .off, all with the vertices and triangles of `rest` in its order. Raises InputError, FormatError.
    """
    file = qgraph_file.read(body)
    way = file.metadata["unit_mm"], up_of(file, body)
    start = _read(rest, *way)
    moves = [_moved(start, frame, *way) for frame in frames]
    return of_moves(file, start, np.array(moves))


def of_moves(file: qgraph_file.QGraphFile, start: Surface, moves: np.ndarray) -> StoredShapes:
    """Displacements (shapes, n, 3), mm, of the vertices of `start`, a surface where that of the body is, in mm.

    Raises InputError where it is not.
    """
    display = file.sections["display/vertices"].astype(np.float64)
    face, weight = nearest_faces(display, start)
    reached = np.einsum("ij,ijk->ik", weight, start.corners[face])
    far = np.linalg.norm(display - reached, axis=1).max()
    if far > _FAR * start.diagonal:
        raise InputError(f"rest frame: {far:.3g} mm from the body found, allowed are {_FAR * start.diagonal:.3g}")
    return StoredShapes(
        _at(start, moves, face, weight).astype(np.float32),
        [_inside(file, number, start, moves) for number in range(file.level_count)],
    )


def _rows(shapes: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(shapes.reshape(-1, 3), np.float32)


def _read(path: Path, unit_mm: float, up: str) -> Surface:
    if path.suffix.lower() not in _SUFFIXES:
        raise InputError(f"{path}: extension '{path.suffix}' found, of frames allowed are {', '.join(_SUFFIXES)}")
    surface = read_surface(path, unit="mm", up=up).surface
    return Surface(surface.vertices * unit_mm, surface.triangles)


def _moved(start: Surface, path: Path, unit_mm: float, up: str) -> np.ndarray:
    frame = _read(path, unit_mm, up)
    if frame.vertices.shape != start.vertices.shape or not np.array_equal(frame.triangles, start.triangles):
        raise InputError(
            f"{path}: {len(frame.vertices)} vertices and {len(frame.triangles)} triangles found, wanted are the "
            f"{len(start.vertices)} and {len(start.triangles)} of the rest frame in its order"
        )
    return frame.vertices - start.vertices


def _at(start: Surface, moves: np.ndarray, face: np.ndarray, weight: np.ndarray) -> np.ndarray:
    return np.einsum("ij,sijk->sik", weight, moves[:, start.triangles[face]])


def _inside(file: qgraph_file.QGraphFile, number: int, start: Surface, moves: np.ndarray) -> np.ndarray:
    """(shapes, n_v, 3) float32 of a level: given on its surface, harmonic inside."""
    vertices = file.sections[f"level{number}/vertices"].astype(np.float64)
    count = int(file.sections[f"level{number}/faces"].max()) + 1
    displaced = np.zeros((len(moves), len(vertices), 3))
    displaced[:, :count] = _at(start, moves, *nearest_faces(vertices[:count], start))
    if count < len(vertices):
        stiffness = _stiffness(vertices, file.sections[f"level{number}/tets"].astype(np.int64))
        load = -stiffness[count:, :count] @ displaced[:, :count].transpose(1, 0, 2).reshape(count, -1)
        inner = splu(stiffness[count:, count:].tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
        displaced[:, count:] = inner.solve(load).reshape(-1, len(moves), 3).transpose(1, 0, 2)
    return displaced.astype(np.float32)


def _stiffness(vertices: np.ndarray, tets: np.ndarray) -> sparse.csr_array:
    """Linear elements: sum of grad l_i . grad l_j over the tets' volumes, mm."""
    corners = vertices[tets]
    edges = corners[:, 1:] - corners[:, :1]
    normals = np.stack([np.cross(edges[:, (k + 1) % 3], edges[:, (k + 2) % 3]) for k in range(3)], axis=1)
    normals = np.concatenate([-normals.sum(axis=1, keepdims=True), normals], axis=1)
    six_volume = np.einsum("ij,ij->i", edges[:, 0], normals[:, 1])
    local = np.einsum("tik,tjk->tij", normals, normals) / (6 * six_volume)[:, None, None]
    rows, columns = np.repeat(tets, 4, axis=1).ravel(), np.tile(tets, (1, 4)).ravel()
    return sparse.csr_array((local.ravel(), (rows, columns)), shape=(len(vertices),) * 2)
