"""Mesh files into surfaces in millimetres: formats, unit, and everything that makes a file unusable."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from quadgraph.base import regular_file
from quadgraph.base.errors import InputError
from quadgraph.base.units import UPS
from quadgraph.mesh import gltf_file, mesh_size, named_parts
from quadgraph.mesh.mesh_text import read_obj, read_off
from quadgraph.mesh.ply import read_ply
from quadgraph.mesh.surface import FileFrame, SourceMesh, Surface

Arrays = tuple[np.ndarray, np.ndarray]


def _weld(vertices: np.ndarray, triangles: np.ndarray) -> Arrays:
    """Join vertices at the same position: these formats cannot share, or split at seams of normals and texture."""
    # Adding zero makes -0 and +0 one position.
    unique, inverse = np.unique(vertices + 0.0, axis=0, return_inverse=True)
    return unique, inverse.reshape(-1)[triangles]


def _check_stl(path: Path) -> None:
    """Raise InputError for a binary file of another size than its count of triangles gives."""
    data = path.read_bytes()
    stated = int.from_bytes(data[80:84], "little")
    if not data.lstrip().startswith(b"solid") and len(data) != 84 + 50 * stated:
        raise InputError(
            f"{path}: {len(data)} bytes found, {stated} triangles are stated, which take {84 + 50 * stated}"
        )


def _read_stl(path: Path) -> Arrays:
    _check_stl(path)
    mesh: Any = trimesh.load(path, process=False, force="mesh")
    return _weld(np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces, np.int64))


def _read_gltf(path: Path) -> Arrays:
    """All triangle meshes of the scene under their nodes' transforms, as one."""
    gltf_file.check_plain(gltf_file.GltfFile(path))
    parts = named_parts.gltf_parts(path)
    if not parts:
        return np.empty((0, 3)), np.empty((0, 3), np.int64)
    offsets = np.cumsum([0] + [len(part.vertices) for part in parts])
    vertices = np.concatenate([np.asarray(part.vertices, np.float64) for part in parts])
    triangles = [np.asarray(part.faces, np.int64) + offset for part, offset in zip(parts, offsets, strict=False)]
    return _weld(vertices, np.concatenate(triangles))


_READERS: dict[str, Callable[[Path], Arrays]] = {
    ".obj": read_obj,
    ".off": read_off,
    ".ply": read_ply,
    ".stl": _read_stl,
    ".gltf": _read_gltf,
    ".glb": _read_gltf,
}


def read_surface(
    path: str | Path,
    *,
    unit: str | None = None,
    height_mm: float | None = None,
    longest_mm: float | None = None,
    up: str = "y",
    part: str | None = None,
) -> SourceMesh:
    """Read a mesh, scale it to millimetres and stand it up along y.

    unit "mm", "cm" or "m" of the file's coordinates, the object's height_mm (its extent upwards) or longest_mm (the
    longest side of its bounding box): at most one. Without one the size is as usual, which `SourceMesh.size_note`
    says: that of glTF in metres where that is plausible, else 100 mm along the longest side. up: the axis that
    points up in the file, "y" or "z"; part: the one of that name alone (`named_parts`), at the size of the whole.
    Polygons are cut into triangles; STL and glTF vertices at one position are joined. Nothing is repaired. Raises
    InputError for a file or option that cannot be used, naming file and field.
    """
    path = Path(path)
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError(f"{path}: extension '{path.suffix}' found, allowed are {', '.join(_READERS)}")
    try:
        content = regular_file.read_bytes(path)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error
    vertices, triangles = _guarded(reader, path)
    _check(path, vertices, triangles)
    vertices = stood_up(vertices, up)
    unit_mm, note = mesh_size.scale_of(path, vertices[np.unique(triangles)], unit, height_mm, longest_mm)
    surface = Surface(vertices * unit_mm, triangles)
    if part is not None:
        surface = Surface(surface.vertices, triangles[named_parts.triangles_of(path, part)]).compacted()
    digest = hashlib.sha256(content).hexdigest()
    return SourceMesh(surface, path.name, digest, FileFrame(unit_mm, up), len(vertices), len(triangles), note)


def stood_up(vectors: np.ndarray, up: str) -> np.ndarray:
    """Vectors (..., 3) of a file whose axis `up` points up, with y up; right-handed as before. Raises InputError."""
    if up not in UPS:
        raise InputError(f"up: {up!r} found, allowed are {' and '.join(UPS)}")
    return FileFrame(up=up).placed(vectors)


def _guarded(reader: Callable[[Path], Arrays], path: Path) -> Arrays:
    try:
        return reader(path)
    except InputError:
        raise
    except Exception as error:  # the libraries raise whatever their parsers meet
        words = " ".join(str(error).split()) or type(error).__name__
        raise InputError(f"{path}: cannot be read as {path.suffix[1:].upper()}: {words[:300]}") from error


def _check(path: Path, vertices: np.ndarray, triangles: np.ndarray) -> None:
    if not len(vertices) or not len(triangles):
        raise InputError(f"{path}: {len(vertices)} vertices and {len(triangles)} triangles found, a mesh needs both")
    bad = np.flatnonzero(~np.isfinite(vertices).all(axis=1))
    if len(bad):
        raise InputError(f"{path}, vertex {bad[0]}: position {vertices[bad[0]].tolist()} found, must be finite")
    wrong = np.flatnonzero(((triangles < 0) | (triangles >= len(vertices))).any(axis=1))
    if len(wrong):
        found, last = triangles[wrong[0]].tolist(), len(vertices) - 1
        raise InputError(f"{path}, triangle {wrong[0]}: vertex indices {found} found, allowed are 0 to {last}")
