"""How far the frames of a film are, in a file for a program that shows it: a window, a page."""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from quadgraph.base import atomic_file


def add_argument(group: argparse._ArgumentGroup) -> None:
    """Add --progress."""
    group.add_argument(
        "--progress",
        type=Path,
        metavar="FILE",
        help='a JSON file, replaced whole after each frame, for programs that show how far it is: {"done": 12, '
        '"frames": 48, "seconds_left": 31.5}; null seconds as long as they are not known',
    )


class FrameProgress:
    """Counts frames, and says so in a file."""

    def __init__(self, path: Path | None, frames: int) -> None:
        """Begin with none of so many done; no path: nothing is said. Raises InputError if it cannot be written."""
        self._path, self._frames = path, frames
        self._done = 0
        self._first: float | None = None  # when the first was done, which took longer than those that follow
        self._say(None)

    def add(self) -> None:
        """Count a frame that is done. Raises InputError if it cannot be written."""
        self._done += 1
        now = time.monotonic()
        if self._first is None:
            self._first = now
        left = None
        if self._done > 1:
            left = (now - self._first) / (self._done - 1) * (self._frames - self._done)
        self._say(left)

    def _say(self, seconds_left: float | None) -> None:
        if self._path is not None:
            said = {"done": self._done, "frames": self._frames, "seconds_left": seconds_left}
            atomic_file.write_json(self._path, said)
