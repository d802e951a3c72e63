"""Photographs as a session.json states them: exposures of one place, the lights that were on, and what counts."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

from quadgraph.acquisition.capture import capture
from quadgraph.acquisition.capture.strict_json import Member

MOST_FRAMES = 16
LARGEST = 1e15


@dataclass(frozen=True)
class FrameFile:
    """One exposure: file, and what its values are times the radiance; None where the file says it."""

    path: str
    file: Path
    exposure: float | None


@dataclass(frozen=True)
class Shot:
    """One photograph of the session: exposures from one place under the same lights.

    gain: as captures have it; mask: a file; background: exposures of the same without the body, which make a mask; none
    where there are none.
    """

    path: str
    frames: tuple[FrameFile, ...]
    lights: tuple[str, ...]
    gain: float | str
    mask: Path | None
    background: tuple[FrameFile, ...] = ()

    def emptied(self) -> Shot:
        """The photograph of the background."""
        return Shot(f"{self.path}.background", self.background, self.lights, self.gain, None)


def read_shot(member: Member, folder: Path, lights: Collection[str]) -> Shot:
    """A photograph of the session. Raises InputError."""
    members = member.members(("frames", "lights"), ("gain", "mask", "background"))
    lit = tuple(
        each.one_of(tuple(lights), "name one of `lights`, or add it there")
        for each in members["lights"].items(capture.MOST_PHOTOGRAPHS)
    )
    frames = frames_of(members["frames"], folder)
    gain = capture.gain_of(members.get("gain"), " + ".join(lit))
    mask = capture.file_of(members["mask"], folder, "a mask, an image") if "mask" in members else None
    background = members.get("background")
    if background and mask:
        background.wrong("allowed is it or mask, not both")
    empty = frames_of(background, folder) if background else ()
    return Shot(member.path, frames, lit, gain, mask, empty)


def frames_of(member: Member, folder: Path) -> tuple[FrameFile, ...]:
    """The exposures of one place. Raises InputError."""
    return tuple(_frame(each, folder) for each in member.items(MOST_FRAMES))


def _frame(member: Member, folder: Path) -> FrameFile:
    """A file, or an object of file and exposure."""
    if isinstance(member.value, str):
        return FrameFile(member.path, capture.file_of(member, folder, "an exposure"), None)
    members = member.members(("file",), ("exposure",))
    exposure = members.get("exposure")
    return FrameFile(
        member.path,
        capture.file_of(members["file"], folder, "an exposure"),
        exposure.number(0, LARGEST, "shutter time times aperture times sensitivity", above=True) if exposure else None,
    )
