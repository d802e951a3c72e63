"""Mesh files with their colours, by the kind of file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from quadgraph.base.errors import InputError
from quadgraph.mesh.looks.gltf_looks import read_gltf_looks
from quadgraph.mesh.looks.obj_looks import read_obj_looks
from quadgraph.mesh.looks.parts import ColouredMesh, Look, Part
from quadgraph.mesh.looks.texture import linear
from quadgraph.mesh.ply import read_coloured_ply


def _read_ply(path: Path) -> ColouredMesh:
    """Colours at vertices, as sRGB: so scanners, MeshLab and Blender write them."""
    vertices, triangles, colours = read_coloured_ply(path)
    part = Part(vertices, triangles, Look(), None if colours is None else linear(colours))
    return ColouredMesh([part.check(str(path))])


_READERS: dict[str, Callable[[Path], ColouredMesh]] = {
    ".glb": read_gltf_looks,
    ".gltf": read_gltf_looks,
    ".obj": read_obj_looks,
    ".ply": _read_ply,
}


def read_looks(path: Path) -> ColouredMesh:
    """A mesh's triangles with all that the file says of their colour, in its coordinates.

    Raises InputError naming file, field, what was found and what is allowed.
    """
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError(
            f"{path}: extension '{path.suffix}' found, of colours {', '.join(_READERS)} are read; write the mesh as "
            "one of them"
        )
    try:
        return reader(path).check(path)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error
