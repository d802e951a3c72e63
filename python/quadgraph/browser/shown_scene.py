"""The scene that a page shows: what the page may change of it, and how."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from quadgraph import core
from quadgraph.api.lights import default_lights
from quadgraph.api.materials import Material
from quadgraph.api.scene import Scene, SceneFile
from quadgraph.api.stage import Stage
from quadgraph.base.array_types import Doubles
from quadgraph.base.errors import InputError
from quadgraph.browser.page_values import NAMES_FILE, files, layers_of, material_files, points_in, shares, shown
from quadgraph.browser.stamps import Stamps, stamped

# What of a scene a page may set, and all below.
ALLOWED = (
    "/camera",
    "/material",
    "/materials",
    "/placements",
    "/lights",
    "/deformation",
    "/cuts",
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
MOST_MEMBERS = 256  # lights, steps of a deformation, cuts
MOST_STROKE_POINTS = 50_000  # of all strokes together
MOST_UNDONE = 100
MOST_STAMPED = 16  # images in strokes
STAMPS = frozenset({"mask", "pattern"})  # of a brush: names of images
_DIGITS = 5  # of shares of the picture: a fiftieth of a pixel
_CUTTING = "shortest-path"  # the method that alone shows cuts
GESTURES = {"orbit": "camera", "pan": "camera", "zoom": "camera", "turn": "lights"}
_SIDES = ("/picture/width", "/picture/height")


class ShownScene:
    """A scene with all members filled in, and the steps back from it."""

    def __init__(
        self,
        scene: Scene,
        bodies: Sequence[str] = (),
        hosts: Mapping[str, str] | None = None,
        stamps: Stamps | None = None,
    ) -> None:
        """Hold a scene; bodies, hosts: those that its file names (`Engine`); stamps: images that a brush may stamp.

        Raises InputError for shapes in memory.
        """
        self._bodies, self._hosts, self._stamps = tuple(bodies), hosts or {}, stamps
        self._start = scene.to_dict()
        materials = [self._start.get("material"), *self._start.get("materials", {}).values()]
        self._files = {*files(self._start), *(name for each in materials for name in material_files(each))}
        self._file = SceneFile(scene)
        self._undone: list[dict[str, Any]] = []
        self._redone: list[dict[str, Any]] = []
        self._uncut: str | None = None  # the method before there were cuts
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

    @property
    def can_redo(self) -> bool:
        """Whether a step was taken back, and nothing done since."""
        return bool(self._redone)

    @property
    def sent_stamps(self) -> list[str]:
        """Names of the images in the scene that pages have sent: a scene file needs them beside it."""
        return self._stamps.sent_in(self.document["edits"]) if self._stamps else []

    @property
    def layers(self) -> list[dict[str, Any]]:
        """What a page shows of the layers of strokes (`layers_of`)."""
        return layers_of(self.document["edits"])

    def set(self, pointer: Any, value: Any) -> None:
        """Put a value at a JSON pointer. Raises InputError, and changes nothing, for what a page may not set."""
        if not isinstance(pointer, str) or not any(pointer == top or pointer.startswith(f"{top}/") for top in ALLOWED):
            raise InputError(f"set: found {shown(pointer)}, a page may set {', '.join(ALLOWED)} and what is below")
        self._check(pointer, value)
        if pointer.startswith("/materials/"):  # a body may have the name of a number, which is no place in an array
            body = pointer.removeprefix("/materials/")
            self._check_bodies([body])
            self._change(pointer, {"/materials": {**self.document.get("materials", {}), body: value}})
        elif pointer.startswith("/placements/"):
            body, *member = pointer.removeprefix("/placements/").split("/")
            self._check_placed([body])
            poses = self.document.get("placements", {})
            pose = {**poses.get(body, {}), member[0]: value} if member else value
            self._change(pointer, {"/placements": {**poses, body: pose}})
        elif pointer in {"/materials", "/placements"}:
            names = value if isinstance(value, dict) else []
            (self._check_bodies if pointer == "/materials" else self._check_placed)(names)
            self._change(pointer, {pointer: value})
        elif pointer.split("/")[1] == "material":
            self._change(pointer, {pointer: value, "/materials": {}})  # that of all bodies
        else:
            self._change(pointer, {pointer: value})

    def _change(self, place: str, values: Mapping[str, Any]) -> None:
        """Put values at places, all or none, as a step of its own or with others at `place`. Raises InputError."""
        before = self.document
        try:
            for pointer, value in values.items():
                self._file.set(pointer, value)
            self._keep_method()
        except InputError:
            self._put(before, camera=True, size=True)
            raise
        self._scene = None
        if place.startswith(("/camera", *_SIDES)):
            return
        # A slider that is drawn sets the same place again and again: one step back undoes all of it.
        if not (self._undone and self._last == place):
            self._undone = [*self._undone, before][-MOST_UNDONE:]
        self._redone = []
        self._last = place

    def _keep_method(self) -> None:
        """Show cuts by the method that can, and what is whole again by the one before, as the window does."""
        scene = self._file.at(0)
        method = str(scene.solver["method"])
        if scene.cuts and method != _CUTTING:
            self._uncut = method
            self._file.set("/solver/method", _CUTTING)
        elif not scene.cuts and self._uncut is not None:
            self._file.set("/solver/method", self._uncut)
            self._uncut = None

    def paint(self, stage: Stage, brush: Any, places: Any, begins: Any) -> dict[str, Any]:
        """Lead a brush over places of the picture of the scene that the stage shows: shares of its width and height,
        right and down; `begins`: a stroke begins. Return what `Stage.painted` says of it, and the `layers`.

        Raises InputError.
        """
        if not isinstance(brush, dict) or not isinstance(begins, bool):
            raise InputError('paint: found no brush, or no truth in "begins"; docs/window.md, In a browser')
        width, height = (self.scene.picture[side] for side in ("width", "height"))
        pixels = [(x * width, y * height) for x, y in shares("at", places)]
        if begins:
            self.end_step()
        scene, state = stage.painted(self._with_stamps(brush), pixels, begins=begins)
        self._take_edits(scene, "/edits, a stroke")
        return state | {"layers": self.layers}

    def rings(self, stage: Stage, brush: Any, place: Any) -> list[list[list[float]]]:
        """Rings of a brush about a place [x, y] of the picture of the scene that the stage shows (`Stage.brush_rings`),
        all in shares of its size right and down. Raises InputError.
        """
        if not isinstance(brush, dict):
            raise InputError(f"ring: found {shown(brush)}, a brush is wanted; docs/window.md, In a browser")
        size = np.array([self.scene.picture[side] for side in ("width", "height")])
        ((x, y),) = shares("at", [place])
        bare = {name: value for name, value in brush.items() if name not in STAMPS | {"coefficients"}}
        found = stage.brush_rings(bare, (x * size[0], y * size[1]))
        return [np.round(ring / size, _DIGITS).tolist() for ring in found]

    def _with_stamps(self, brush: Mapping[str, Any]) -> dict[str, Any]:
        """The brush with the files of the images that it names. Raises InputError for names that are none of these."""
        made = dict(brush)
        for member in STAMPS & made.keys():
            if self._stamps is None:
                raise InputError(f"{member}: found {shown(made[member])}, there are no images")
            try:
                made[member] = self._stamps.path(made[member])
            except InputError as error:
                raise InputError(f"{member}: {error}") from None
        return made

    def relayer(self, stage: Stage, change: Any) -> dict[str, Any]:
        """Change the layers of the scene that the stage shows, as `Stage.relayered`. Raises InputError."""
        if not isinstance(change, dict):
            raise InputError(f"layers: found {shown(change)}, an object is wanted")
        scene, state = stage.relayered(change)
        slides = change["change"] == "opacity"
        if not slides:
            self.end_step()
        self._take_edits(scene, "/edits, an opacity")
        if not slides:
            self.end_step()
        return state | {"layers": self.layers}

    def _take_edits(self, scene: Scene, place: str) -> None:
        edits = scene.to_dict()["edits"]
        if edits == self.document["edits"]:
            return
        points = points_in(edits)
        if points > MOST_STROKE_POINTS:
            said = f"found strokes of {points} points, allowed are {MOST_STROKE_POINTS}; remove a layer"
            raise InputError(f"edits: {said}")
        new = stamped(edits) - self._files
        if len(new) > MOST_STAMPED:
            raise InputError(f"edits: found {len(new)} images, allowed are {MOST_STAMPED}; remove a layer")
        self._change(place, {"/edits": edits})

    def move(self, stage: Stage, gesture: Any, right: Any, up: Any, light: Any) -> None:
        """Do what a hand did to the camera or a light, of the scene that the stage shows. Raises InputError."""
        if gesture not in list(GESTURES):  # which asks for no hash
            raise InputError(f"gesture: found {shown(gesture)}, allowed are {', '.join(GESTURES)}")
        for name, number in (("right", right), ("up", up)):
            if isinstance(number, bool) or not isinstance(number, (int, float)) or not abs(number) <= 1e4:
                raise InputError(f"{name}: found {shown(number)}, allowed are numbers up to 10000 either way")
        if isinstance(light, bool) or not isinstance(light, int) or light < 0:
            raise InputError(f"light: found {shown(light)}, allowed is the number of one, from 0")
        member = GESTURES[gesture]
        self.set(f"/{member}", stage.moved(gesture, right, up, light).to_dict()[member])

    def body_at(self, stage: Stage, place: Any) -> str | None:
        """Name of the body at a place [x, y] of the picture, in shares of its size right and down; None beside them.
        Raises InputError.
        """
        ((x, y),) = shares("pick", [place])
        return stage.body_at(x * self.scene.picture["width"], y * self.scene.picture["height"])

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
            raise InputError(f"add: found {shown(kind)}, allowed are {', '.join(made)}")
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
        now = self.document
        self._put(self._undone[-1])
        self._undone.pop()
        self._redone.append(now)
        self.end_step()

    def redo(self) -> None:
        """Do again what was undone last. Raises InputError where there is nothing."""
        if not self._redone:
            raise InputError("redo: there is nothing to redo")
        now = self.document
        self._put(self._redone[-1])
        self._redone.pop()
        self._undone.append(now)
        self.end_step()

    def restore(self) -> None:
        """Go back to the scene as it was opened, the size of the picture apart; a step that can be undone."""
        self._undone = [*self._undone, self.document][-MOST_UNDONE:]
        self._put(self._start, camera=True)
        self._redone = []
        self.end_step()

    def _put(self, document: Mapping[str, Any], camera: bool = False, size: bool = False) -> None:
        now = {} if size else {side: self.document["picture"][side] for side in ("width", "height")}
        picture = {**document["picture"], **now}
        wanted = {**document, "picture": picture}
        members = ("material", "lights", "edits", "deformation", "cuts", "solver")
        for member in (*members, *(("camera",) if camera else ())):
            self._file.set(f"/{member}", wanted[member])
        for member in ("materials", "placements"):
            self._file.set(f"/{member}", wanted.get(member, {}))
        self._file.set("/picture", picture)
        self._scene = None

    def _check_bodies(self, names: Iterable[str]) -> None:
        for name in names:
            if name not in self._bodies:
                allowed = ", ".join(self._bodies) or "none, it is one body"
                raise InputError(f"bodies: found {shown(name)}, the file has {allowed}")

    def _check_placed(self, names: Iterable[str]) -> None:
        names = list(names)
        self._check_bodies(names)
        for name in names:
            if name in self._hosts:
                raise InputError(f"placements: found {shown(name)}, which moves with {self._hosts[name]}, within which "
                                 "it lies")  # fmt: skip

    def _check(self, pointer: str, value: Any) -> None:
        named = set(files(value))
        last = pointer.rsplit("/", 1)[-1]
        if last in NAMES_FILE and isinstance(value, str):
            named.add(value)
        if pointer.startswith("/material"):
            for material in value.values() if isinstance(value, dict) else [value]:
                named |= set(material_files(material))
        if pointer == "/solver/method" and self.scene.cuts and value != _CUTTING:
            raise InputError(f"{pointer}: found {shown(value)}, cuts are shown by {_CUTTING} alone; undo them first")
        if not named <= self._files:
            raise InputError(f"{pointer}: found the file {shown(min(named - self._files))}, a page names no new files")
        if isinstance(value, (list, dict)) and len(value) > MOST_MEMBERS:
            raise InputError(f"{pointer}: found {len(value)} members, allowed are {MOST_MEMBERS}")
        if pointer.startswith("/picture/") and pointer in _SIDES:
            whole = isinstance(value, int) and not isinstance(value, bool)
            if not whole or not LEAST_SIDE <= value <= MOST_SIDE:
                raise InputError(f"{pointer}: found {shown(value)}, allowed are {LEAST_SIDE} to {MOST_SIDE} pixels")


def _point_like(key: Mapping[str, Any], centre: Doubles, far: float) -> dict[str, Any]:
    """A point light that lights the middle of the body as a directional one does, so many mm from it."""
    power = [4 * np.pi * far**2 * each for each in key["irradiance"]]
    return {"type": "point", "position": list(centre - far * np.asarray(key["direction"])), "power": power}
