"""Frames of a scene that changes: quick ones while it does, and the whole picture at rest.

The engine is used by the thread that runs `FrameLoop.run`, the main one, whose solve at rest a signal ends where
something changes; the server's thread hands over what pages say and takes what they are to show.
"""

from __future__ import annotations

import io
import signal
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import FrameType
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from quadgraph.api.options import PictureOptions, SolveOptions
from quadgraph.api.picture import Picture
from quadgraph.api.scene import Scene
from quadgraph.api.solution import ErrorEstimate, Solution
from quadgraph.api.stage import Stage
from quadgraph.base.errors import QuadGraphError, SolverError
from quadgraph.browser.pace import Pace
from quadgraph.browser.shown_scene import GESTURES, ShownScene

_SETTLED_S = 0.25  # after the last change, before the scene is solved at rest
_MOST_WAITING = 256  # messages
_QUALITY = {False: 80, True: 93}  # of JPEG, by whether the frame is the one at rest
# Members that a solve depends on.
_SOLVED = ("material", "materials", "lights", "edits", "deformation", "cuts", "solver")


_Made = TypeVar("_Made")


class _Dropped(BaseException):
    """A picture at rest is not wanted any more: something has changed."""


@dataclass(frozen=True)
class ShownFrame:
    """A picture for pages. serial: of it; jpeg: the file; said: what stands beside it, ready for JSON; srgb: (h, w, 3)
    of one at rest.
    """

    serial: int
    jpeg: bytes
    said: Mapping[str, Any]
    srgb: npt.NDArray[np.uint8] | None


@dataclass(frozen=True)
class Message:
    """What a page said; `refuse` tells it why that cannot be."""

    content: Mapping[str, Any]
    refuse: Callable[[str], None]


class Inbox:
    """What pages have said and the engine has not done. Safe between threads."""

    def __init__(self, wake: Callable[[], None]) -> None:
        """wake: called after each message."""
        self._waiting: deque[Message] = deque()
        self._changed = threading.Condition()
        self._wake = wake

    def put(self, message: Message) -> None:
        """Add one; a gesture joins the one before it where both are of a kind. Refuses where too many wait."""
        with self._changed:
            last = self._waiting[-1] if self._waiting else None
            joined = _joined(last.content, message.content) if last else None
            if joined is not None:
                self._waiting[-1] = Message(joined, message.refuse)
            elif len(self._waiting) < _MOST_WAITING:
                self._waiting.append(message)
            else:
                message.refuse(f"{_MOST_WAITING} changes are waiting already")
                return
            self._changed.notify()
        self._wake()

    @property
    def waiting(self) -> bool:
        """Whether there is anything to do; asked without the lock, which an exception of a signal might leave held."""
        return bool(self._waiting)

    def take(self, seconds: float | None) -> list[Message]:
        """Wait so long, or None for ever, for messages, and take all there are."""
        with self._changed:
            self._changed.wait_for(lambda: bool(self._waiting), seconds)
            found = list(self._waiting)
            self._waiting.clear()
        return found


def _joined(before: Mapping[str, Any], now: Mapping[str, Any]) -> dict[str, Any] | None:
    """One message for two that follow each other: sums of a gesture, the later of two values at a place."""
    if now.get("gesture") in list(GESTURES) and before.get("gesture") == now["gesture"]:
        same = before.get("light") == now.get("light")
        numbers = [of.get(name, 0) for of in (before, now) for name in ("right", "up")]
        if same and all(isinstance(number, (int, float)) for number in numbers):
            return {**now, "right": numbers[0] + numbers[2], "up": numbers[1] + numbers[3]}
    if "set" in now and before.get("set") == now["set"]:
        return dict(now)
    return None


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
            while True:
                messages = self.inbox.take(_SETTLED_S if self._at_rest is None else None)
                if messages:
                    self._take(messages)
                else:
                    self._rest()
        finally:
            self._droppable = False
            signal.signal(signal.SIGUSR1, before)

    def _drop(self) -> None:
        """End the solve at rest, from any thread."""
        if self._droppable:
            signal.pthread_kill(self._main, signal.SIGUSR1)

    def _heed_drop(self, _number: int, _frame: FrameType | None) -> None:
        if self._droppable:
            self._droppable = False
            raise _Dropped

    def _take(self, messages: list[Message]) -> None:
        """Do what was said, and show it."""
        for message in messages:
            try:
                self._do(message.content)
            except QuadGraphError as error:
                message.refuse(str(error))
        if self._at_rest != self._shown.scene:
            self._at_rest = None
            self._move()

    def _do(self, said: Mapping[str, Any]) -> None:
        if "gesture" in said:
            right, up, light = (said.get(name, 0) for name in ("right", "up", "light"))
            self._shown.move(self._stage, said["gesture"], right, up, light)
            self._stage.show(self._shown.scene)  # what the next gesture starts from
        elif "set" in said:
            self._shown.set(said["set"], said.get("value"))
        elif "add" in said:
            self._shown.add_light(self._stage, said["add"])
        elif said.get("do") == "undo":
            self._shown.undo()
        elif said.get("do") == "restore":
            self._shown.restore()
        else:
            self._shown.end_step()

    def _move(self) -> None:
        """A frame in motion."""
        scene, start = self._shown.scene, time.perf_counter()
        try:
            self._stage.show(scene)
            wanted = _solved_members(scene)
            solving = wanted != self._solved
            if solving:
                self._solved = None
                corrected = bool(scene.solver.get("correction", True)) and self._pace.corrects
                quick: SolveOptions = {"correction": corrected, "certify": 0.0}
                self._stage.engine.solve(motion=True, **(scene.solver | quick))
                self._solved = wanted
                self._pace.solved(time.perf_counter() - start, corrected)
            self._show_frame(self._drawn(scene, solving), scene, start, at_rest=False)
        except SolverError as error:
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
        except SolverError as error:
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
        state = {"scene": scene.to_dict(), "undo": self._shown.can_undo, "roughness": self._shown.roughness}
        self._show(ShownFrame(self._serial, jpeg, {**told, **said, **state}, srgb))


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
    said += [solution.model_warning, solution.size_warning, solution.phase_warning, solution.light_warning]
    said += [solution.deformed, solution.advice]
    return list(dict.fromkeys(text for text in said if text))
