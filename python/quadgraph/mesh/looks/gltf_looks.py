"""Colours of a glTF 2.0 file: base colours, their textures, COLOR_0, and what extensions say of the inside."""

from __future__ import annotations

import base64
import math
from pathlib import Path
from typing import Any, cast
from urllib.parse import unquote

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph.mesh.gltf_file import GltfFile, read
from quadgraph.mesh.looks.gltf_media import coat_note, eta_of, medium_of, number_of, numbers_of
from quadgraph.mesh.looks.parts import ColouredMesh, Look, Part
from quadgraph.mesh.looks.texture import Pictures, Texture, Wrap

_WRAPS: dict[int, Wrap] = {33071: "clamp", 33648: "mirror", 10497: "repeat"}
_TRIANGLES = 4
_NO_SURFACES = (0, 1, 2, 3)  # points and lines
_SOURCES = ("EXT_texture_webp",)  # extensions whose picture we decode
_IGNORED = {
    "multiscatterColorTexture": "its factor alone is taken",
    "scatterStrengthTexture": "its factor alone is taken",
    "thicknessTexture": "the body has its own thickness",
}


def read_gltf_looks(path: Path) -> ColouredMesh:
    """All triangles of the scene under their nodes' transforms. Raises InputError naming file and field."""
    return read(path, _coloured)


def _coloured(file: GltfFile) -> ColouredMesh:
    looks = Looks(file)
    mesh = ColouredMesh([], looks.notes, looks.pictures.files)
    for number, transform in sorted(file.transforms().items()):
        for primitive in file.mesh(file.document["nodes"][number]).get("primitives", []):
            if primitive.get("mode", _TRIANGLES) not in _NO_SURFACES:
                mesh.parts.append(_part(file, primitive, transform, looks))
    return mesh


def _part(file: GltfFile, primitive: dict, transform: np.ndarray, looks: Looks) -> Part:
    vertices, triangles = file.positions([primitive])
    look, (placed, texcoord) = looks.of(primitive.get("material"))
    attributes = primitive["attributes"]
    colours = file.accessor(attributes["COLOR_0"])[:, :3] if "COLOR_0" in attributes else None
    uv = None
    if look.texture is not None:
        name = f"TEXCOORD_{texcoord}"
        if name not in attributes:
            raise InputError(
                f"{file.path}, material {look.name!r}: a texture by {name} found, which a primitive of it lacks; "
                "unwrap the mesh, or take the texture away"
            )
        with np.errstate(invalid="ignore", over="ignore"):  # what is no number is found below
            uv = _accessor(file, attributes[name], name) @ placed[:, :2].T + placed[:, 2]
    for name, rows in (("COLOR_0", colours), ("TEXCOORD", uv)):
        if rows is not None and len(rows) != len(vertices):
            raise InputError(f"{file.path}, {name}: {len(rows)} values found for {len(vertices)} vertices")
    placed_vertices = vertices @ transform[:3, :3].T + transform[:3, 3]
    if np.linalg.det(transform[:3, :3]) < 0:
        triangles = triangles[:, ::-1]
    return Part(placed_vertices, triangles, look, colours, uv).check(f"{file.path}, material {look.name!r}")


def _accessor(file: GltfFile, number: int, name: str) -> np.ndarray:
    values = file.accessor(number)
    if values.shape[1] != 2:
        raise InputError(f"{file.path}, {name}: {values.shape[1]} numbers a vertex found, allowed are 2")
    return values


class Looks:
    """Materials of a file by their numbers, each read once; notes: what of them was left out."""

    def __init__(self, file: GltfFile) -> None:
        self.file = file
        self.notes: list[str] = []
        self._known: dict[int | None, tuple[Look, tuple[np.ndarray, int]]] = {None: (Look(), (np.eye(3)[:2], 0))}
        self.pictures = Pictures(file.path)

    def of(self, number: int | None) -> tuple[Look, tuple[np.ndarray, int]]:
        """A material, the transform (2, 3) of its texture's coordinates, and which set of them it goes by."""
        if number not in self._known:
            material = _item(self.file, "materials", number)
            self._known[number] = self._read(material, material.get("name") or f"material {number}")
        return self._known[number]

    def _read(self, material: dict[str, Any], name: str) -> tuple[Look, tuple[np.ndarray, int]]:
        where = f"{self.file.path}, material {name!r}"
        extensions = material.get("extensions", {})
        plain = material.get("pbrMetallicRoughness") or _older(extensions)
        medium, note = medium_of(where, extensions)
        self.notes += [note] if note else []
        self.notes += coat_note(where, extensions)
        for extension, said in extensions.items():
            self.notes += [f"{where}, {extension}, {key}: {why}" for key, why in _IGNORED.items() if key in said]
        red, green, blue, _ = numbers_of(where, plain, "baseColorFactor", (1.0, 1.0, 1.0, 1.0), 0, 1)
        if number_of(where, plain, "metallicFactor", 1.0, 0, 1) == 1 and "metallicFactor" in plain:
            self.notes.append(f"{where}: a metal, of which the colour alone is taken")
        roughness = number_of(where, plain, "roughnessFactor", 1.0, 0, 1) ** 2  # alpha, as in glTF's appendix B
        info = plain.get("baseColorTexture")
        found = None if info is None else self.texture(where, info, "baseColorTexture")
        placed = (np.eye(3)[:2], 0) if info is None else place_of(where, info)
        stated = roughness if "roughnessFactor" in plain else None
        return Look(name, (red, green, blue), found, medium, eta_of(where, extensions), stated), placed

    def texture(self, where: str, info: dict, field: str) -> Texture:
        """The picture that a field of a material names, and how it goes on. Raises InputError."""
        document = _item(self.file, "textures", info["index"])
        others = document.get("extensions", {})
        source = next((others[name]["source"] for name in _SOURCES if name in others), document.get("source"))
        if source is None:
            found = ", ".join(others) or "nothing"
            raise InputError(f"{where}, {field}: no picture but {found} found; write it as PNG or JPEG")
        sampler = _item(self.file, "samplers", document["sampler"]) if "sampler" in document else {}
        wraps = []
        for name in ("wrapS", "wrapT"):
            if sampler.get(name, 10497) not in _WRAPS:
                allowed = ", ".join(map(str, _WRAPS))
                raise InputError(f"{where}, sampler, {name}: {sampler[name]} found, allowed are {allowed}")
            wraps.append(_WRAPS[sampler.get(name, 10497)])
        return Texture(self._picture(source), cast(tuple[Wrap, Wrap], tuple(wraps)))

    def _picture(self, number: int) -> np.ndarray:
        image, where = _item(self.file, "images", number), f"{self.file.path}, image {number}"
        if "bufferView" in image:
            return self.pictures.inside(number, lambda: self.file.view_bytes(image["bufferView"]), where)
        uri = image["uri"]
        if uri.startswith("data:"):
            return self.pictures.inside(number, lambda: base64.b64decode(uri.split(",", 1)[1]), where)
        return self.pictures.beside(unquote(uri), where)


def _older(extensions: dict[str, Any]) -> dict[str, Any]:
    """What KHR_materials_pbrSpecularGlossiness, which is out of use, says of diffuse colour, in the words of today."""
    said = extensions.get("KHR_materials_pbrSpecularGlossiness", {})
    names = {"diffuseFactor": "baseColorFactor", "diffuseTexture": "baseColorTexture"}
    return {today: said[name] for name, today in names.items() if name in said}


def _item(file: GltfFile, kind: str, number: object) -> dict[str, Any]:
    items = file.document.get(kind, [])
    if not isinstance(number, int) or not 0 <= number < len(items):
        raise InputError(f"{file.path}, {kind}: index {number} found, there are {len(items)}")
    return items[number]


def place_of(where: str, info: dict) -> tuple[np.ndarray, int]:
    """KHR_texture_transform as (2, 3), and the set of coordinates."""
    said = info.get("extensions", {}).get("KHR_texture_transform", {})
    here = f"{where}, KHR_texture_transform"
    scale = numbers_of(here, said, "scale", (1.0, 1.0), -1e6, 1e6)
    offset = numbers_of(here, said, "offset", (0.0, 0.0), -1e6, 1e6)
    turn = number_of(here, said, "rotation", 0.0, -1e6, 1e6)
    cos, sin = math.cos(turn), math.sin(turn)
    rotation = np.array([[cos, -sin], [sin, cos]])
    return np.column_stack([rotation * scale, offset]), int(said.get("texCoord", info.get("texCoord", 0)))
