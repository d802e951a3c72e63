"""Parts of mesh files by the names that their programs gave them: objects or groups of OBJ, nodes of glTF."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from quadgraph.base.errors import InputError
from quadgraph.mesh.mesh_text import numbered_lines

_MOST_TOLD = 20  # names that an error lists


def names(path: Path) -> np.ndarray:
    """(m,) the name of the part that each triangle of a readable file is of, in the order of `mesh_io.read_surface`.

    Raises InputError for a format without names.
    """
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError(f"{path}: part: a '{path.suffix}' file names no parts, allowed are {', '.join(_READERS)}")
    return reader(path)


def triangles_of(path: Path, part: str) -> np.ndarray:
    """(m,) whether each triangle is of a part. Raises InputError that lists the names where there is none of it."""
    found = names(path)
    mine = found == part
    if not mine.any():
        known = list(dict.fromkeys(found.tolist()))
        told = ", ".join(repr(name) for name in known[:_MOST_TOLD]) + (", ..." if len(known) > _MOST_TOLD else "")
        raise InputError(f"{path}: part: {part!r} found, the file has {told}")
    return mine


def _of_obj(path: Path) -> np.ndarray:
    """By objects where the file has some, else by groups; what comes before the first is called as the file."""
    lines = numbered_lines(path)
    key = "o" if any(words[0] == "o" for _, words in lines) else "g"
    present, found, counts = path.stem, [], []
    for _, words in lines:
        if words[0] == key:
            present = " ".join(words[1:]) or path.stem
        elif words[0] == "f":
            found.append(present)
            counts.append(len(words) - 3)  # a polygon is a fan of triangles
    return np.repeat(np.array(found, object), np.maximum(counts, 0))


def gltf_parts(path: Path) -> list[trimesh.Trimesh]:
    """The triangle meshes of a glTF scene under their nodes' transforms, in its order."""
    scene: Any = trimesh.load_scene(path, process=False, skip_materials=True)  # images would be decoded
    return [part for part in scene.dump() if isinstance(part, trimesh.Trimesh)]


def _of_gltf(path: Path) -> np.ndarray:
    parts = gltf_parts(path)
    called = [str(part.metadata.get("node", path.stem)) for part in parts]
    return np.repeat(np.array(called, object), [len(part.faces) for part in parts])


_READERS: dict[str, Callable[[Path], np.ndarray]] = {".obj": _of_obj, ".gltf": _of_gltf, ".glb": _of_gltf}
