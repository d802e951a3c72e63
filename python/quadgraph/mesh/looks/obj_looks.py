"""Colours of an OBJ file: materials of its .mtl, and colours behind the positions of its vertices."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph.mesh.looks.mtl import ObjLook, read_mtl
from quadgraph.mesh.looks.parts import ColouredMesh, Look, Part
from quadgraph.mesh.looks.texture import Pictures, linear
from quadgraph.mesh.mesh_text import numbered_lines

_Corners = list[list[tuple[int, int]]]  # polygons; position and coordinate of each corner, from 0, -1 for none


class _File:
    """What the lines of a file say, one after the other."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.pictures = Pictures(path)
        self.vertices: list[list[float]] = []
        self.colours: list[list[float]] = []
        self.uv: list[list[float]] = []
        self.looks: dict[str, ObjLook] = {}
        self.polygons: dict[str, _Corners] = {}
        self._present: _Corners = self.polygons.setdefault("", [])

    def take(self, words: list[str]) -> None:
        """One line. Raises ValueError, IndexError for what cannot be read, InputError for a wrong material."""
        kind, rest = words[0], words[1:]
        if kind == "v":
            numbers = [float(word) for word in rest]
            self.vertices.append([numbers[0], numbers[1], numbers[2]])
            if len(numbers) >= 6:
                self.colours.append(numbers[3:6])
        elif kind == "vt":
            self.uv.append([float(rest[0]), float(rest[1]) if len(rest) > 1 else 0.0])
        elif kind == "f":
            self._present.append([self._corner(word) for word in rest])
            if len(rest) < 3:
                raise ValueError
        elif kind == "mtllib":
            self.looks.update(read_mtl(self.pictures, " ".join(rest)))
        elif kind == "usemtl":
            name = " ".join(rest)
            if name not in self.looks:
                known = ", ".join(self.looks)[:200] or "none"
                raise InputError(f"usemtl {name[:80]!r} found, the libraries before it have {known}")
            self._present = self.polygons.setdefault(name, [])

    def _corner(self, word: str) -> tuple[int, int]:
        fields = word.split("/")
        at = _index(fields[0], len(self.vertices))
        return at, _index(fields[1], len(self.uv)) if len(fields) > 1 and fields[1] else -1


def _index(word: str, count: int) -> int:
    number = int(word)
    index = number - 1 if number > 0 else count + number
    if number == 0 or not index >= 0:
        raise ValueError
    return index


def read_obj_looks(path: Path) -> ColouredMesh:
    """All polygons as triangles, by material. Raises InputError naming the line, or the index that is out of range."""
    file = _File(path)
    for number, words in numbered_lines(path):
        try:
            file.take(words)
        except InputError as error:
            raise InputError(f"{path}, line {number}: {error}") from error
        except (ValueError, IndexError):
            raise InputError(f"{path}, line {number}: cannot read '{' '.join(words)[:80]}'") from None
    if file.colours and len(file.colours) != len(file.vertices):
        counts = f"{len(file.colours)} of {len(file.vertices)}"
        raise InputError(f"{path}: {counts} vertices have colours, all or none are allowed")
    parts = [_part(file, name, polygons) for name, polygons in file.polygons.items() if polygons]
    return ColouredMesh(parts, files=file.pictures.files)


def _part(file: _File, name: str, polygons: _Corners) -> Part:
    """One material's triangles; each corner has its own vertex, as its coordinates may be its own."""
    fans = [(p[0], p[k], p[k + 1]) for p in polygons for k in range(1, len(p) - 1)]
    corners = np.array(fans, np.int64).reshape(-1, 2)
    where = f"{file.path}, material {name!r}"
    look, wrapped = (file.looks[name].look, file.looks[name]) if name else (Look(), None)
    _check_index(f"{file.path}, a face's vertex", corners[:, 0], len(file.vertices))
    colours = linear(np.array(file.colours))[corners[:, 0]] if file.colours else None
    uv = None
    if wrapped is not None and look.texture is not None:
        if (corners[:, 1] < 0).any():
            raise InputError(f"{where}: a texture found, and faces without coordinates (vt); unwrap the mesh again")
        _check_index(f"{file.path}, a face's vt", corners[:, 1], len(file.uv))
        uv = np.array(file.uv)[corners[:, 1]] * wrapped.scale + wrapped.offset
        uv[:, 1] = 1 - uv[:, 1]  # v goes upwards in OBJ
    vertices = np.array(file.vertices).reshape(-1, 3)[corners[:, 0]]
    return Part(vertices, np.arange(len(vertices)).reshape(-1, 3), look, colours, uv).check(where)


def _check_index(where: str, index: np.ndarray, count: int) -> None:
    if len(index) and index.max() >= count:
        raise InputError(f"{where}: {index.max() + 1} found, there are {count}")
