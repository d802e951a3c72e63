"""What pages have said, until the engine does it."""

from __future__ import annotations

import contextlib
import threading
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from quadgraph.browser.page_values import MOST_PLACES
from quadgraph.browser.shown_scene import GESTURES

_MOST_WAITING = 256  # messages
_MOST_RINGS = 16  # of the brush, asked for; the newest


@dataclass(frozen=True)
class Message:
    """What a page said; `answer` tells that page alone something in return, ready for JSON."""

    content: Mapping[str, Any]
    answer: Callable[[Mapping[str, Any]], None]

    def refuse(self, why: str) -> None:
        """Tell the page why that cannot be."""
        self.answer({"refused": why})


class Inbox:
    """What pages have said and the engine has not done. Safe between threads."""

    def __init__(self, wake: Callable[[], None]) -> None:
        """wake: called after each message."""
        self._waiting: deque[Message] = deque()
        self._rings: deque[Message] = deque(maxlen=_MOST_RINGS)
        self._changed = threading.Condition()
        self._wake = wake

    def put(self, message: Message) -> None:
        """Add one; a gesture joins the one before it where both are of a kind. Refuses where too many wait.

        What asks for a ring changes nothing, and waits apart.
        """
        with self._changed:
            if "ring" in message.content:
                self._rings.append(message)
                self._changed.notify()
                self._wake()
                return
            last = self._waiting[-1] if self._waiting else None
            joined = _joined(last.content, message.content) if last else None
            if joined is not None:
                self._waiting[-1] = Message(joined, message.answer)
            elif len(self._waiting) < _MOST_WAITING:
                self._waiting.append(message)
            else:
                message.refuse(f"{_MOST_WAITING} changes are waiting already")
                return
            self._changed.notify()
        self._wake()

    @property
    def waiting(self) -> bool:
        """Whether there is anything to do, rings apart; asked without the lock, which an exception of a signal might
        leave held.
        """
        return bool(self._waiting)

    def take(self, seconds: float | None) -> list[Message]:
        """Wait so long, or None for ever, for messages, and take all there are; none where only rings are asked for."""
        with self._changed:
            self._changed.wait_for(lambda: bool(self._waiting or self._rings), seconds)
            found = list(self._waiting)
            self._waiting.clear()
        return found

    def take_rings(self) -> list[Message]:
        """Take what asks for rings, without waiting and without the lock, for the handler of a signal."""
        found = []
        for _ in range(len(self._rings)):
            with contextlib.suppress(IndexError):  # the newest push out the oldest, from another thread
                found.append(self._rings.popleft())
        return found


def _joined(before: Mapping[str, Any], now: Mapping[str, Any]) -> dict[str, Any] | None:
    """One message for two that follow each other: sums of a gesture, the later of two values, more of a stroke."""
    if now.get("gesture") in list(GESTURES) and before.get("gesture") == now["gesture"]:
        same = before.get("light") == now.get("light")
        numbers = [of.get(name, 0) for of in (before, now) for name in ("right", "up")]
        if same and all(isinstance(number, (int, float)) for number in numbers):
            return {**now, "right": numbers[0] + numbers[2], "up": numbers[1] + numbers[3]}
    if "paint" in now and now.get("begins") is False and before.get("paint") == now["paint"]:
        there, on = before.get("at"), now.get("at")
        if isinstance(there, list) and isinstance(on, list) and len(there) + len(on) <= MOST_PLACES:
            return {**before, "at": [*there, *on]}
    if "set" in now and before.get("set") == now["set"]:
        return dict(now)
    return None
