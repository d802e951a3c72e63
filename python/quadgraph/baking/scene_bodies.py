"""The `bodies` of a scene file, which are meshes: read, and what the scene is once they are baked (docs/bodies.md)."""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

from quadgraph.baking.bodies import MOST_NAME_BYTES, BodyMesh, check
from quadgraph.baking.pipeline import BakeOptions
from quadgraph.baking.placing import BodyPlacement, Triple
from quadgraph.base.arguments import length_mm
from quadgraph.base.errors import InputError
from quadgraph.base.units import UNITS_MM, UPS
from quadgraph.mesh.looks.file_normals import RULES
from quadgraph.mesh.mesh_names import SUFFIXES, is_mesh

_LIES = ("position", "rotation", "scale")
_MEMBERS = (
    "name",
    "mesh",
    "part",
    "unit",
    "height",
    "longest",
    "up",
    "wrap",
    "surface_vertices",
    "normals",
    *_LIES,
    "material",
)
_SIZES = {"unit": "unit", "height": "height_mm", "longest": "longest_mm"}  # as BodyMesh has them


@dataclass(frozen=True)
class SceneBodies:
    """meshes: what is to be baked; document: the rest of the scene, but for its `body`; said: where the scene says what
    the document has elsewhere, by that place.
    """

    meshes: list[BodyMesh]
    document: dict[str, Any]
    said: dict[str, str]

    def with_body(self, body: Path) -> dict[str, Any]:
        """The scene of the baked file."""
        return {"body": str(body.absolute()), **self.document}

    def as_said(self, error: str) -> str:
        """What is wrong with the document, by the places of the scene."""
        for place, said in self.said.items():
            error = error.replace(f"{place}:", f"{said}:").replace(f"{place}/", f"{said}/")
        return error


def has_bodies(document: Any) -> bool:
    """Whether a scene is one of meshes."""
    return isinstance(document, Mapping) and "bodies" in document


def read(document: Mapping[str, Any], folder: Path) -> SceneBodies:
    """Read the bodies of a scene's JSON value whose meshes lie in `folder`, or where their names lead from there.

    Raises InputError that begins with the path into the document.
    """
    if "body" in document:
        _refuse("/body", document["body"], 'either "body", one baked file, or "bodies", meshes')
    entries = document["bodies"]
    if not isinstance(entries, list) or not entries:
        _refuse("/bodies", entries, "a list of bodies, each an object")
    _check_tracks(document)
    meshes = [_body(entry, f"/bodies/{number}", folder) for number, entry in enumerate(entries)]
    try:
        check(meshes, BakeOptions())
    except InputError as error:
        raise InputError(f"/{error}") from None
    rest = {name: value for name, value in document.items() if name != "bodies"}
    materials = rest.get("materials", {})
    said = {}
    for number, (entry, mesh) in enumerate(zip(entries, meshes, strict=True)):
        if "material" in entry:
            if isinstance(materials, Mapping) and mesh.name in materials:
                _refuse(f"/materials/{mesh.name}", materials[mesh.name], f"none, as /bodies/{number}/material says it")
            said[f"/materials/{mesh.name}"] = f"/bodies/{number}/material"
            materials = {**materials, mesh.name: entry["material"]} if isinstance(materials, Mapping) else materials
    return SceneBodies(meshes, rest | ({"materials": materials} if materials != {} else {}), said)


def _body(entry: Any, where: str, folder: Path) -> BodyMesh:
    if not isinstance(entry, dict):
        _refuse(where, entry, f"an object with {', '.join(_MEMBERS)}")
    for name in entry:
        if name not in _MEMBERS:
            raise InputError(f"{where}/{name}: unknown, allowed are {', '.join(_MEMBERS)}")
    mesh = _mesh(entry, where, folder)
    part = _text(entry, where, "part", "", "the name of a part of the mesh file") if "part" in entry else None
    name = _text(entry, where, "name", mesh.stem if part is None else part, f"a text of 1 to {MOST_NAME_BYTES} bytes")
    sizes = [size for size in _SIZES if size in entry]
    if len(sizes) > 1:
        _refuse(f"{where}/{sizes[1]}", entry[sizes[1]], f"one of {', '.join(_SIZES)}, and {sizes[0]} is there")
    given: dict[str, Any] = {_SIZES[size]: _size(entry[size], f"{where}/{size}", size) for size in sizes}
    placement = BodyPlacement(
        _triple(entry, where, "position"), _triple(entry, where, "rotation"), _number(entry, where, "scale", 1.0)
    )
    vertices = entry.get("surface_vertices")
    if vertices is not None and (isinstance(vertices, bool) or not isinstance(vertices, int)):
        _refuse(f"{where}/surface_vertices", vertices, "a whole number")
    up = _one_of(entry.get("up", "y"), f"{where}/up", UPS)
    normals = _one_of(entry.get("normals", "file"), f"{where}/normals", RULES)
    given |= {"up": up, "wrap": _wrap(entry, where), "part": part, "normals": normals}
    return BodyMesh(name, mesh, placement, **given, surface_vertices=vertices)


def _mesh(entry: dict[str, Any], where: str, folder: Path) -> Path:
    allowed = f"the name of a mesh file, {', '.join(SUFFIXES)}"
    if "mesh" not in entry:
        raise InputError(f"{where}: mesh is missing, {allowed}")
    mesh = folder / _text(entry, where, "mesh", "", allowed)
    if not is_mesh(mesh):
        _refuse(f"{where}/mesh", entry["mesh"], allowed)
    return mesh


def _text(entry: dict[str, Any], where: str, name: str, usual: str, allowed: str) -> str:
    value = entry.get(name, usual)
    if not isinstance(value, str) or not value or "\0" in value or not _is_text(value):
        _refuse(f"{where}/{name}", value, allowed)
    return value


def _is_text(value: str) -> bool:
    """Whether it can be written: JSON may hold halves of characters."""
    return value == value.encode(errors="ignore").decode()


def _one_of(value: Any, where: str, allowed: tuple[str, ...]) -> str:
    if value not in allowed:
        _refuse(where, value, ", ".join(allowed))
    return value


def _size(value: Any, where: str, name: str) -> str | float:
    return _one_of(value, where, tuple(UNITS_MM)) if name == "unit" else _length(value, where)


def _wrap(entry: dict[str, Any], where: str) -> str | float | None:
    value = entry.get("wrap")
    return value if value is None or value == "auto" else _length(value, f"{where}/wrap")


def _length(value: Any, where: str) -> float:
    allowed = 'a text of a length with its unit, such as "80mm"'
    if not isinstance(value, str):
        _refuse(where, value, allowed)
    try:
        return length_mm(value)
    except (argparse.ArgumentTypeError, ValueError):
        _refuse(where, value, allowed)


def _number(entry: dict[str, Any], where: str, name: str, usual: float) -> float:
    value = entry.get(name, usual)
    if isinstance(value, bool) or not isinstance(value, int | float):
        _refuse(f"{where}/{name}", value, "a number")
    return _real(value)


def _real(value: int | float) -> float:
    """As a float; of a whole number that is too large for one, infinity, which no place has."""
    try:
        return float(value)
    except OverflowError:
        return math.inf


def _triple(entry: dict[str, Any], where: str, name: str) -> Triple:
    value = entry.get(name, [0.0, 0.0, 0.0])
    numbers = isinstance(value, list) and all(isinstance(x, int | float) and not isinstance(x, bool) for x in value)
    if not numbers or len(value) != 3:
        _refuse(f"{where}/{name}", value, "a list of three numbers")
    x, y, z = map(_real, value)
    return x, y, z


def _check_tracks(document: Mapping[str, Any]) -> None:
    """Bodies do not move, and a track of their material goes by its name."""
    tracks = document.get("tracks", [])
    for number, track in enumerate(tracks if isinstance(tracks, list) else []):
        path = track.get("path") if isinstance(track, dict) else None
        if isinstance(path, str) and (path == "/bodies" or path.startswith("/bodies/")):
            _refuse(f"/tracks/{number}/path", path, "/materials/NAME for a body's material; bodies do not move")


def _refuse(where: str, value: Any, allowed: str) -> NoReturn:
    found = str(value)[:80].encode(errors="backslashreplace").decode()
    raise InputError(f"{where}: found {found!r}, allowed is {allowed}")
