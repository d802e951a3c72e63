"""Frames of a scene that changes: quick ones while it does, and the whole picture at rest.

The engine is used by the thread that runs `FrameLoop.run`, the main one, whose solve at rest a signal ends where
something changes, and interrupts to tell where rings of the brush lie; the server's thread hands over what pages say
and takes what they are to show.
"""

from __future__ import annotations

import io
import signal
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import FrameType
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from quadgraph.api.options import MotionOptions, PictureOptions
from quadgraph.api.picture import Picture
from quadgraph.api.scene import Scene
from quadgraph.api.solution import ErrorEstimate, Solution
from quadgraph.api.stage import Stage
from quadgraph.base.errors import InputError, QuadGraphError, SolverError
from quadgraph.browser.inbox import Inbox, Message
from quadgraph.browser.pace import Pace
from quadgraph.browser.shown_scene import ShownScene

_SETTLED_S = 0.25  # after the last change, before the scene is solved at rest
_QUALITY = {False: 80, True: 93}  # of JPEG, by whether the frame is the one at rest
# Members that a solve depends on.
_SOLVED = ("material", "materials", "lights", "edits", "placements", "deformation", "cuts", "solver")


# What ends a picture and not the server: of a method, say, that the file has no levels for.
_NO_PICTURE = (SolverError, InputError)

_Made = TypeVar("_Made")


class _Dropped(BaseException):
    """A picture at rest is not wanted any more: something has changed."""


@dataclass(frozen=True)
class ShownFrame:
    """A picture for pages. serial: of it; jpeg: the file; said: what stands beside it, ready for JSON; scene: what it
    shows, as in a scene file; srgb: (h, w, 3) of one at rest.
    """

    serial: int
    jpeg: bytes
    said: Mapping[str, Any]
    scene: Mapping[str, Any]
    srgb: npt.NDArray[np.uint8] | None


class FrameLoop:
    """The engine's loop. Made and run in the main thread."""

    def __init__(self, stage: Stage, shown: ShownScene, show: Callable[[ShownFrame], None]) -> None:
        """Hold a stage and a scene; `show` is given every frame, and is quick."""
        self._stage, self._shown, self._show = stage, shown, show
        self._pace = Pace()
        self._solved: tuple[Any, ...] | None = None  # what the last solution is of
        self._at_rest: Scene | None = None  # what the last picture at rest shows
        self._serial = 0
        self._droppable = False
        self._main = threading.get_ident()
        self.inbox = Inbox(self._drop)

    def run(self) -> None:
        """Show frames until an interrupt. Raises DeviceError."""
        before = signal.signal(signal.SIGUSR1, self._heed_drop)
        try:
            self._move()
            settled = time.monotonic() + _SETTLED_S
            while True:
                wait = max(0.0, settled - time.monotonic()) if self._at_rest is None else None
                messages = self.inbox.take(wait)
                self._tell_rings()
                if messages:
                    self._take(messages)
                    settled = time.monotonic() + _SETTLED_S
                elif self._at_rest is None and time.monotonic() >= settled:
                    self._rest()
        finally:
            self._droppable = False
            signal.signal(signal.SIGUSR1, before)

    def _drop(self) -> None:
        """End the solve at rest, or have it tell rings, from any thread."""
        if self._droppable:
            signal.pthread_kill(self._main, signal.SIGUSR1)

    def _heed_drop(self, _number: int, _frame: FrameType | None) -> None:
        if self._droppable and self.inbox.waiting:
            self._droppable = False
            raise _Dropped
        if self._droppable:
            self._tell_rings()

    def _tell_rings(self) -> None:
        """Answer what asks for rings: in the midst of a solve, too, which only reads what they are made of."""
        for message in self.inbox.take_rings():
            asked = message.content
            try:
                message.answer({"rings": self._shown.rings(self._stage, asked["ring"], asked.get("at"))})
            except QuadGraphError as error:
                message.refuse(str(error))

    def _take(self, messages: list[Message]) -> None:
        """Do what was said, and show it."""
        for message in messages:
            try:
                self._stage.show(self._shown.scene)  # what hands start from
                answer = self._do(message.content)
                if answer:
                    message.answer(answer)
            except QuadGraphError as error:
                message.refuse(str(error))
        if self._at_rest != self._shown.scene:
            self._at_rest = None
            self._move()

    def _do(self, said: Mapping[str, Any]) -> Mapping[str, Any] | None:
        """Do one thing, and return what its page alone is told. Raises InputError."""
        shown = self._shown
        if "gesture" in said:
            right, up, light = (said.get(name, 0) for name in ("right", "up", "light"))
            shown.move(self._stage, said["gesture"], right, up, light)
        elif "pick" in said:
            return {"picked": shown.body_at(self._stage, said["pick"])}
        elif "paint" in said:
            begins = said.get("begins", False)
            state = shown.paint(self._stage, said["paint"], said.get("at"), begins)
            return {"painted": state} if begins else None
        elif "layers" in said:
            return {"layered": shown.relayer(self._stage, said["layers"])}
        elif "set" in said:
            shown.set(said["set"], said.get("value"))
        elif "add" in said:
            shown.add_light(self._stage, said["add"])
        else:
            steps = {"undo": shown.undo, "redo": shown.redo, "restore": shown.restore}
            steps.get(str(said.get("do")), shown.end_step)()
        return None

    def _move(self) -> None:
        """A frame in motion."""
        scene, start = self._shown.scene, time.perf_counter()
        try:
            self._stage.show(scene)
            wanted = _solved_members(scene)
            solving = wanted != self._solved
            if solving:
                self._solved = None
                wants = bool(scene.solver.get("correction", True))
                corrected = wants and self._pace.corrects
                quick: MotionOptions = {"correction": corrected, "carry": wants and not corrected, "certify": 0.0}
                self._stage.engine.solve(motion=True, **(scene.solver | quick))
                self._solved = wanted
                self._pace.solved(time.perf_counter() - start, corrected)
            self._show_frame(self._drawn(scene, solving), scene, start, at_rest=False)
        except _NO_PICTURE as error:
            self._tell(str(error), scene, start)

    def _drawn(self, scene: Scene, solving: bool) -> Picture:
        start = time.perf_counter()
        whole = scene.picture["width"] * scene.picture["height"]
        share, gathers = self._pace.share(whole, solving), self._pace.gathers(solving)
        width, height = (max(1, round(share * scene.picture[side])) for side in ("width", "height"))
        changed: PictureOptions = {"width": width, "height": height, "samples": 4, "converge": 0.0}
        if not gathers and scene.picture["radiance"] in ("auto", "gathered"):
            changed["radiance"] = "lambertian"
        picture = self._stage.engine.render(scene.camera, **(scene.picture | changed))
        self._pace.drawn(time.perf_counter() - start, width * height, gathers)
        return picture

    def _until_dropped(self, work: Callable[[], _Made]) -> _Made:
        """Do what may be dropped where something is said meanwhile. Raises _Dropped."""
        try:
            self._droppable = True
            if self.inbox.waiting:  # what was said before is not told by a signal
                raise _Dropped
            self._tell_rings()
            return work()
        finally:
            self._droppable = False

    def _rest(self) -> None:
        """The picture at rest, unless something is said meanwhile."""
        scene, start = self._shown.scene, time.perf_counter()
        try:
            self._stage.show(scene)
            self._solved = None
            self._until_dropped(self._stage.solve)
            self._solved = _solved_members(scene)
            once: PictureOptions = {"converge": 0.0}
            picture = self._until_dropped(
                lambda: self._stage.engine.render(scene.camera, **(scene.picture | once)),
            )
            self._show_frame(picture, scene, start, at_rest=True)
            if scene.picture["converge"] > 0:
                self._show_frame(self._until_dropped(self._stage.render), scene, start, at_rest=True)
        except _Dropped:
            return
        except _NO_PICTURE as error:
            self._tell(str(error), scene, start)
        self._at_rest = scene

    def _show_frame(self, picture: Picture, scene: Scene, start: float, at_rest: bool) -> None:
        from PIL import Image

        srgb = picture.srgb()
        encoded = io.BytesIO()
        Image.fromarray(srgb).save(encoded, "JPEG", quality=_QUALITY[at_rest], subsampling=0)
        solution = self._stage.engine.solution
        said = {
            "width": srgb.shape[1],
            "height": srgb.shape[0],
            "exposure": picture.auto_exposure(),
            "error": _error_text(picture.error or (solution.error if solution else None)),
            "notes": _notes(solution) if at_rest else [],
        }
        self._publish(said, encoded.getvalue(), srgb if at_rest else None, scene, start, at_rest)

    def _tell(self, trouble: str, scene: Scene, start: float) -> None:
        """Say why there is no picture."""
        self._publish({"trouble": trouble}, b"", None, scene, start, at_rest=True)

    def _publish(
        self,
        said: Mapping[str, Any],
        jpeg: bytes,
        srgb: npt.NDArray[np.uint8] | None,
        scene: Scene,
        start: float,
        at_rest: bool,
    ) -> None:
        self._serial += 1
        told = {"serial": self._serial, "rest": at_rest, "ms": 1e3 * (time.perf_counter() - start)}
        document = scene.to_dict()
        shown = {name: value for name, value in document.items() if name != "edits"}  # of thousands of points, maybe
        can = {"undo": self._shown.can_undo, "redo": self._shown.can_redo}
        painted = {"layers": self._shown.layers, "sent": self._shown.sent_stamps}
        state = {"scene": shown, **painted, "roughness": self._shown.roughness, **can}
        self._show(ShownFrame(self._serial, jpeg, {**told, **said, **state}, document, srgb))


def _solved_members(scene: Scene) -> tuple[Any, ...]:
    document = scene.to_dict()
    return tuple(document.get(name) for name in _SOLVED)


def _error_text(error: ErrorEstimate | None) -> str:
    if error is None:
        return "error not known"
    return f"error {100 * error.whole:.2g}%, unlit {100 * error.unlit:.2g}%"


def _notes(solution: Solution | None) -> list[str]:
    """What the report of a solve has to say in words."""
    if solution is None:
        return []
    said = [solution.stopped, solution.missed, solution.mesh_warning]
    said += [solution.model_warning, solution.size_warning, solution.phase_warning]
    said += [solution.index_warning, solution.light_warning]
    said += [solution.deformed, solution.advice]
    return list(dict.fromkeys(text for text in said if text))
