"""Options of a command line beside a scene file: what was typed takes the place of what the file says.

A track of the scene that changes such a value is left out.
"""

from __future__ import annotations

import argparse
import copy
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from quadgraph.base.errors import InputError
from quadgraph.commands import own_mesh, scene_options
from quadgraph.core import load_core

_ANGLES = ("azimuth", "elevation", "distance")
_PLACES = ("eye", "look_at")
_MAP = "/map"


def apply(file: Any, document: Any, args: argparse.Namespace) -> None:
    """Change a core.SceneFile of a JSON document as the options say that were typed (`args.given`).

    Raises InputError.
    """
    for name in own_mesh.NAMES:
        if name in args.given:
            raise InputError(f"--{name}: not beside a scene file, whose /body is a baked .qgraph that knows its size")
    put(file, document, args)


def put(file: Any, document: Any, args: argparse.Namespace) -> None:
    """Change a core.SceneFile of a JSON document as the options say that were typed. Raises InputError."""
    wanted = changes(args)
    if _MAP in wanted:
        wanted |= _mapped(wanted.get("/material", document.get("material")), wanted.pop(_MAP))
    kept = [track for track in document.get("tracks", []) if not _replaced(track["path"], wanted)]
    if len(kept) < len(document.get("tracks", [])):
        file.set("/tracks", json.dumps(kept))
    for member in dict.fromkeys(pointer.split("/")[1] for pointer in wanted):
        value = copy.deepcopy(document.get(member, {}))
        for pointer, change in wanted.items():
            if pointer.split("/")[1] == member:
                value = _put(value, pointer.split("/")[2:], change)
        file.set(f"/{member}", json.dumps(value))


def changes(args: argparse.Namespace) -> dict[str, Any]:
    """JSON values that options say by their pointers into a scene; None takes a member away. Raises InputError.

    A map stands at a pointer of its own: what it comes to depends on the material.
    """
    found: dict[str, Any] = {}
    for option in scene_options.options(scene_options.RENDER_GROUPS):
        name = scene_options.destination(option)
        if name not in args.given:
            continue
        value = getattr(args, name)
        if option.name == "light":
            value = load_core().picture_light(value, **scene_options.seen_from(args))[0]
        found |= OWN_FORMS[option.name](value) if option.own_form else {option.member: value}
    return found


def _material(text: str) -> dict[str, Any]:
    """A file of a volume is looked for in the working directory, not beside the scene."""
    named = load_core().volume_name(text)
    if named is None:
        return {"/material": text}
    file, how = str(Path(named[0]).absolute()), named[1]
    return {"/material": load_core().with_map(file, _from_here(how)) if how else file}


def _materials(texts: list[str]) -> dict[str, Any]:
    named = scene_options.by_body(texts)
    return {f"/materials/{body}": _material(text)["/material"] for body, text in named.items()}


def _map(text: str) -> dict[str, Any]:
    return {_MAP: text}


def _mapped(material: Any, how: str) -> dict[str, Any]:
    """The material of a scene, or the one that was typed, carried into the body in another way."""
    if isinstance(material, dict) and "volume" in material:
        material = material["volume"]
    if not isinstance(material, str):
        raise InputError("--map: found with a material that is no volume, allowed is one of a file .npz; leave it out")
    return {"/material": load_core().with_map(material, _from_here(how))}


def _from_here(how: str) -> str:
    """A map whose `from`, if there is one, is looked for in the working directory."""
    parts = how.split(",")
    return ",".join(f"from={Path(p[5:]).absolute()}" if p.startswith("from=") else p for p in parts)


def _lights(texts: list[str]) -> dict[str, Any]:
    lights = [json.loads(load_core().light_json(text)) for text in texts]
    return {
        "/lights": [
            light | {"file": str(Path(light["file"]).absolute())} if "file" in light else light for light in lights
        ]
    }


def _view(text: str) -> dict[str, Any]:
    angles = scene_options.numbers_of("view", text, (2, 3))
    return {f"/camera/{name}": None for name in (*_ANGLES, *_PLACES)} | {
        f"/camera/{name}": angle for name, angle in zip(_ANGLES, angles, strict=False)
    }


def _place(name: str) -> Callable[[str], dict[str, Any]]:
    def place(text: str) -> dict[str, Any]:
        away = {f"/camera/{other}": None for other in (*_ANGLES, "target")}
        return away | {f"/camera/{name}": scene_options.numbers_of(name.replace("_", "-"), text, (3,))}

    return place


def _size(text: str) -> dict[str, Any]:
    width, height = scene_options.size_of(argparse.Namespace(size=text))
    return {"/picture/width": width, "/picture/height": height}


def _background(text: str) -> dict[str, Any]:
    return {"/picture/background": text}


def _normal_map(text: str) -> dict[str, Any]:
    """Over all of the body, whatever the scene placed there."""
    return {"/picture/normal_map": {"image": str(Path(text).absolute())}}


# Options that a scene file says in another form: from what was typed to JSON values by their pointers.
OWN_FORMS: dict[str, Callable[[Any], dict[str, Any]]] = {
    "material": _material,
    "material-of": _materials,
    "map": _map,
    "light": _lights,
    "view": _view,
    "eye": _place("eye"),
    "look-at": _place("look_at"),
    "size": _size,
    "background": _background,
    "normal-map": _normal_map,
}


def _replaced(track: str, wanted: dict[str, Any]) -> bool:
    """Whether a track changes nothing but what is replaced. Raises InputError where it changes more than that."""
    for pointer in wanted:
        if track == pointer or track.startswith(f"{pointer}/"):
            return True
        if pointer.startswith(f"{track}/"):
            raise InputError(f"a track of the scene changes all of {track}: change it there")
    return False


def _put(value: Any, keys: list[str], change: Any) -> Any:
    """A JSON value with another one put in the place of keys, or taken away."""
    if not keys:
        return change
    inner = value.get(keys[0], {}) if isinstance(value, dict) else {}
    rest = {name: kept for name, kept in value.items() if name != keys[0]} if isinstance(value, dict) else {}
    return rest if len(keys) == 1 and change is None else rest | {keys[0]: _put(inner, keys[1:], change)}
