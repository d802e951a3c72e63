"""The scene that a page shows: what the page may change of it, and how."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from quadgraph import core
from quadgraph.api.lights import default_lights
from quadgraph.api.materials import Material
from quadgraph.api.scene import Scene, SceneFile
from quadgraph.api.stage import Stage
from quadgraph.base.array_types import Doubles
from quadgraph.base.errors import InputError

# What of a scene a page may set, and all below.
ALLOWED = (
    "/camera",
    "/material",
    "/lights",
    "/edits",
    "/deformation",
    "/solver/method",
    "/solver/model",
    "/solver/correction",
    "/picture/width",
    "/picture/height",
    "/picture/exposure",
    "/picture/tone",
    "/picture/white_balance",
    "/picture/roughness",
    "/picture/background",
    "/picture/ground",
    "/picture/surroundings",
)
LEAST_SIDE, MOST_SIDE = 64, 2048  # pixels
MOST_MEMBERS = 256  # lights, edits, steps of a deformation
MOST_UNDONE = 100
GESTURES = {"orbit": "camera", "pan": "camera", "zoom": "camera", "turn": "lights"}
_NAMES_FILE = frozenset({"file", "image", "mask", "shapes", "volume", "from"})
_SIDES = ("/picture/width", "/picture/height")


class ShownScene:
    """A scene with all members filled in, and the steps back from it."""

    def __init__(self, scene: Scene) -> None:
        """Hold a scene. Raises InputError for shapes in memory."""
        self._start = scene.to_dict()
        self._files = {*_files(self._start), *_material_files(self._start.get("material"))}
        self._file = SceneFile(scene)
        self._undone: list[dict[str, Any]] = []
        self._last = ""  # place that was set last
        self._scene: Scene | None = None

    @property
    def scene(self) -> Scene:
        """What is shown now."""
        if self._scene is None:
            self._scene = self._file.at(0)
        return self._scene

    @property
    def document(self) -> dict[str, Any]:
        """The content of a scene file that shows it."""
        return self.scene.to_dict()

    @property
    def roughness(self) -> float | None:
        """That of the picture, or the one that the material states; None where neither does."""
        stated = self.scene.picture.get("roughness")
        named = self.document.get("material")
        if stated is not None or not isinstance(named, str) or core.volume_name(named):
            return stated
        return Material.parse(named).roughness

    @property
    def can_undo(self) -> bool:
        """Whether there is a step back."""
        return bool(self._undone)

    def set(self, pointer: Any, value: Any) -> None:
        """Put a value at a JSON pointer. Raises InputError, and changes nothing, for what a page may not set."""
        if not isinstance(pointer, str) or not any(pointer == top or pointer.startswith(f"{top}/") for top in ALLOWED):
            raise InputError(f"set: found {_shown(pointer)}, a page may set {', '.join(ALLOWED)} and what is below")
        self._check(pointer, value)
        before = self.document
        self._file.set(pointer, value)
        if pointer.split("/")[1] == "material" and "materials" in before:
            self._file.set("/materials", {})  # the page's is that of all bodies
        self._scene = None
        if pointer.startswith(("/camera", *_SIDES)):
            return
        # A slider that is drawn sets the same place again and again: one step back undoes all of it.
        if not (self._undone and self._last == pointer):
            self._undone = [*self._undone, before][-MOST_UNDONE:]
        self._last = pointer

    def move(self, stage: Stage, gesture: Any, right: Any, up: Any, light: Any) -> None:
        """Do what a hand did to the camera or a light, of the scene that the stage shows. Raises InputError."""
        if gesture not in list(GESTURES):  # which asks for no hash
            raise InputError(f"gesture: found {_shown(gesture)}, allowed are {', '.join(GESTURES)}")
        for name, number in (("right", right), ("up", up)):
            if isinstance(number, bool) or not isinstance(number, (int, float)) or not abs(number) <= 1e4:
                raise InputError(f"{name}: found {_shown(number)}, allowed are numbers up to 10000 either way")
        if isinstance(light, bool) or not isinstance(light, int) or light < 0:
            raise InputError(f"light: found {_shown(light)}, allowed is the number of one, from 0")
        member = GESTURES[gesture]
        self.set(f"/{member}", stage.moved(gesture, right, up, light).to_dict()[member])

    def add_light(self, stage: Stage, kind: Any) -> None:
        """Add a light of a kind, about as strong as the first of a scene by itself. Raises InputError."""
        camera, lights = self.scene.camera, self.document["lights"]
        seen = [camera[name] for name in ("azimuth", "elevation")] if "azimuth" in camera else [0.0, 0.0]
        key, _, even = default_lights(",".join(map(str, seen)), camera.get("up", "y"))
        low, high = (corner.astype(float) for corner in stage.engine.box)
        made = {
            "directional": key.to_dict(),
            "point": _point_like(key.to_dict(), (low + high) / 2, float(np.linalg.norm(high - low))),
            "ambient": even.to_dict(),
        }
        if kind not in list(made):
            raise InputError(f"add: found {_shown(kind)}, allowed are {', '.join(made)}")
        self.end_step()
        self.set("/lights", [*lights, made[kind]])
        self.end_step()

    def end_step(self) -> None:
        """Let the next change be a step of its own, whatever place it sets."""
        self._last = ""

    def undo(self) -> None:
        """Go a step back, camera and size of the picture apart. Raises InputError where there is none."""
        if not self._undone:
            raise InputError("undo: there is nothing to undo")
        self._put(self._undone[-1])
        self._undone.pop()
        self.end_step()

    def restore(self) -> None:
        """Go back to the scene as it was opened, the size of the picture apart; a step that can be undone."""
        self._undone = [*self._undone, self.document][-MOST_UNDONE:]
        self._put(self._start, camera=True)
        self.end_step()

    def _put(self, document: Mapping[str, Any], camera: bool = False) -> None:
        picture = {**document["picture"], **{side: self.document["picture"][side] for side in ("width", "height")}}
        wanted = {**document, "picture": picture}
        for member in ("material", "lights", "edits", "deformation", "solver", *(("camera",) if camera else ())):
            self._file.set(f"/{member}", wanted[member])
        self._file.set("/materials", wanted.get("materials", {}))
        self._file.set("/picture", picture)
        self._scene = None

    def _check(self, pointer: str, value: Any) -> None:
        named = set(_files(value))
        last = pointer.rsplit("/", 1)[-1]
        if last in _NAMES_FILE and isinstance(value, str):
            named.add(value)
        if pointer == "/material":
            named |= set(_material_files(value))
        if not named <= self._files:
            raise InputError(f"{pointer}: found the file {_shown(min(named - self._files))}, a page names no new files")
        if isinstance(value, (list, dict)) and len(value) > MOST_MEMBERS:
            raise InputError(f"{pointer}: found {len(value)} members, allowed are {MOST_MEMBERS}")
        if pointer.startswith("/picture/") and pointer in _SIDES:
            whole = isinstance(value, int) and not isinstance(value, bool)
            if not whole or not LEAST_SIDE <= value <= MOST_SIDE:
                raise InputError(f"{pointer}: found {_shown(value)}, allowed are {LEAST_SIDE} to {MOST_SIDE} pixels")


def _point_like(key: Mapping[str, Any], centre: Doubles, far: float) -> dict[str, Any]:
    """A point light that lights the middle of the body as a directional one does, so many mm from it."""
    power = [4 * np.pi * far**2 * each for each in key["irradiance"]]
    return {"type": "point", "position": list(centre - far * np.asarray(key["direction"])), "power": power}


def _files(value: Any) -> Iterable[str]:
    """Names of files in the members of a JSON value, however deep."""
    if isinstance(value, list):
        for each in value:
            yield from _files(each)
    elif isinstance(value, Mapping):
        for name, each in value.items():
            if name in _NAMES_FILE and isinstance(each, str):
                yield each
            else:
                yield from _files(each)


def _material_files(material: Any) -> Iterable[str]:
    """The file that a material's text names, if it does."""
    named = core.volume_name(material) if isinstance(material, str) else None
    return [named[0]] if named else []


def _shown(value: Any) -> str:
    """A JSON value in an error, at most 40 letters of it."""
    text = json.dumps(value)
    return text if len(text) <= 40 else f"{text[:37]}..."
