"""Normals that mesh files give at the corners of triangles: read, and carried to the surface that is made of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph.mesh import gltf_file
from quadgraph.mesh.bisection import Cut
from quadgraph.mesh.creases import corner_normals, creases, unit
from quadgraph.mesh.looks import normal_texture
from quadgraph.mesh.looks.carried import carried
from quadgraph.mesh.looks.normal_texture import NormalTexture
from quadgraph.mesh.mesh_text import read_obj_normals
from quadgraph.mesh.ply import read_ply_normals
from quadgraph.mesh.surface import Surface

RULES = ("file", "angle")
_LEAST_COSINE = 0.1  # of a plausible normal with its triangle's: on the right side, if by little
_TRIANGLES = 4  # mode of a primitive of glTF
_NEXT_STEP = "; write the mesh again, or bake it with --normals angle"

Soup = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True, eq=False)
class FoundNormals:
    """Unit normals (m, 3, 3) at the corners of a surface's triangles, 0 where the file gives none that can be true.

    rule: "file", or "angle" where none is used; note: a sentence for the user on what was not taken, or ""; texture:
    what makes them lean further.
    """

    rule: str
    at_corners: np.ndarray | None = None
    note: str = ""
    texture: NormalTexture | None = None

    @property
    def parting(self) -> np.ndarray | None:
        """What parts vertices besides normals, as creases.parted takes it."""
        return None if self.texture is None else self.texture.places

    @property
    def share(self) -> float:
        """Of the corners, those that have the file's normal."""
        return 0.0 if self.at_corners is None else float(self.at_corners.any(axis=2).mean())

    def turned(self, turn: Callable[[np.ndarray], np.ndarray]) -> FoundNormals:
        """These, by a rotation of vectors (..., 3)."""
        return self if self.at_corners is None else replace(self, at_corners=turn(self.at_corners))

    def cut(self, surface: Surface, cuts: Sequence[Cut]) -> FoundNormals:
        """At the corners of triangles that `surface` was cut into, straight: these, or the computed ones of before.

        Those that would be computed of what it was cut into are its triangles' own.
        """
        at_corners, texture = corner_normals(surface, creases(surface)), self.texture
        if self.at_corners is not None:
            at_corners = np.where(self.at_corners.any(axis=2, keepdims=True), self.at_corners, at_corners)
        for each in cuts:
            at_corners = unit(each.carried(at_corners))
            if texture is not None:
                places = each.carried(texture.places)
                texture = replace(texture, places=np.where(places[:, :, 2:] == 1, places, 0))
        return replace(self, at_corners=at_corners, texture=texture)

    def metadata(self) -> dict[str, Any]:
        """What a .qgraph keeps of it as `normals`."""
        found: dict[str, Any] = {"rule": self.rule, "share": round(self.share, 4)}
        return found if self.texture is None else found | {"texture": list(self.texture.pixels.shape[1::-1])}


COMPUTED = FoundNormals("angle")


def sentence(said: dict) -> str:
    """What to tell of a file's metadata `normals`."""
    text = "normals: computed, smooth up to edges of 40 degrees"
    if said["rule"] == "file":
        text = f"normals: the mesh file's at {100 * said['share']:.4g}% of the corners, else by edges of 40 degrees"
    return text + (f"; its normal texture of {said['texture'][0]} x {said['texture'][1]}" if "texture" in said else "")


def check(rule: str) -> None:
    """Raise InputError for a rule that is not allowed."""
    if rule not in RULES:
        raise InputError(f"normals: {rule!r} found, allowed are {' and '.join(RULES)}")


def read(path: Path) -> Soup | None:
    """Corners (k, 3, 3) of triangles in the coordinates of a mesh file, and the normals there; None if it has none.

    Normals are as they stand, of any length, 0 where a corner has none. Raises InputError naming what is wrong.
    """
    reader = _READERS.get(path.suffix.lower())
    return None if reader is None else reader(path)


def find(path: Path, surface: Surface, placed: Callable[[np.ndarray], np.ndarray]) -> FoundNormals:
    """Normals that a file gives at the corners of `surface`, made of it with its corners moved by 1e-6 at most.

    With its normal texture, where it has one. placed: from vectors (..., 3) of the file to mm, y up. Raises InputError
    for normals that cannot be read.
    """
    normals = _find(path, surface, placed)
    texture, note = normal_texture.find(path, surface, placed)
    return replace(normals, texture=texture, note="; ".join(filter(None, (normals.note, note))))


def _find(path: Path, surface: Surface, placed: Callable[[np.ndarray], np.ndarray]) -> FoundNormals:
    soup = read(path)
    if soup is None:
        return FoundNormals("angle")
    found = carried(placed(soup[0]), _unit(placed(soup[1])), surface)
    given = found.any(axis=2)
    if not given.any():
        return FoundNormals("angle", note=f"{path.name}: its normals are of no length, or at no corner that is left")
    right = given & (np.einsum("ijk,ik->ij", found, unit(surface.doubled_normals)) > _LEAST_COSINE)
    if 2 * right.sum() < given.sum():
        wrong = 100 * (1 - right.sum() / given.sum())
        return FoundNormals(
            "angle", note=f"{path.name}: {wrong:.3g}% of its normals point into their triangles, none is taken"
        )
    found[~right] = 0
    missing = int((~right).sum())
    note = f"{path.name}: {missing:,} of {right.size:,} corners have no normal on the right side; theirs are computed"
    return FoundNormals("file", found, note if missing else "")


def _unit(normals: np.ndarray) -> np.ndarray:
    """At unit length; 0 for what has none that can be told."""
    with np.errstate(invalid="ignore", over="ignore"):
        found = unit(normals)
        found[~(np.abs(np.linalg.norm(found, axis=-1) - 1) < 1e-6)] = 0
    return found


def _by_vertex(vertices: np.ndarray, triangles: np.ndarray, normals: np.ndarray | None) -> Soup | None:
    return None if normals is None else (vertices[triangles], normals[triangles])


def _gltf(path: Path) -> Soup | None:
    return gltf_file.read(path, _gltf_soup)


def _gltf_soup(file: gltf_file.GltfFile) -> Soup | None:
    """Of all primitives of triangles that have normals, under their nodes' transforms."""
    corners, normals = [np.empty((0, 3, 3))], [np.empty((0, 3, 3))]
    for number, transform in sorted(file.transforms().items()):
        for part in file.mesh(file.document["nodes"][number]).get("primitives", []):
            if part.get("mode", _TRIANGLES) != _TRIANGLES or "NORMAL" not in part["attributes"]:
                continue
            vertices, triangles = file.positions([part])
            given = file.accessor(part["attributes"]["NORMAL"]).astype(np.float64)
            if given.shape != vertices.shape:
                raise InputError(
                    f"{file.path}, node {number}, NORMAL: {len(given)} x {given.shape[1]} numbers found, "
                    f"{len(vertices)} x 3 are wanted, as of POSITION{_NEXT_STEP}"
                )
            linear = transform[:3, :3]
            if np.linalg.det(linear) != 0:
                corners.append((vertices @ linear.T + transform[:3, 3])[triangles])
                normals.append((given @ np.linalg.inv(linear))[triangles])
    return (np.concatenate(corners), np.concatenate(normals)) if len(corners) > 1 else None


_READERS: dict[str, Callable[[Path], Soup | None]] = {
    ".obj": lambda path: read_obj_normals(path, _NEXT_STEP),
    ".ply": lambda path: _by_vertex(*read_ply_normals(path)),
    ".gltf": _gltf,
    ".glb": _gltf,
}
