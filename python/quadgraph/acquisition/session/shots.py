"""Photographs as a session.json states them: exposures of one place, the lights that were on, and what counts."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

from quadgraph.acquisition.capture import capture
from quadgraph.acquisition.capture.strict_json import Member

MOST_FRAMES = 16
_LARGEST = 1e15


@dataclass(frozen=True)
class FrameFile:
    """One exposure: file, and what its values are times the radiance; None where the file says it."""

    path: str
    file: Path
    exposure: float | None


@dataclass(frozen=True)
class Shot:
    """One photograph of the session: exposures from one place under the same lights. gain: as captures have it."""

    path: str
    frames: tuple[FrameFile, ...]
    lights: tuple[str, ...]
    gain: float | str
    mask: Path | None


def read_shot(member: Member, folder: Path, lights: Collection[str]) -> Shot:
    """A photograph of the session. Raises InputError."""
    members = member.members(("frames", "lights"), ("gain", "mask"))
    lit = tuple(
        each.one_of(tuple(lights), "name one of `lights`, or add it there")
        for each in members["lights"].items(capture.MOST_PHOTOGRAPHS)
    )
    frames = frames_of(members["frames"], folder)
    gain = capture.gain_of(members.get("gain"), " + ".join(lit))
    mask = capture.file_of(members["mask"], folder, "a mask, an image") if "mask" in members else None
    return Shot(member.path, frames, lit, gain, mask)


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
        exposure.number(0, _LARGEST, "shutter time times aperture times sensitivity", above=True) if exposure else None,
    )
