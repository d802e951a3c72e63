"""Lights as a session.json states them.

They are those of scene files, lamps that photographs of the board alone tell, and projectors that were calibrated.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quadgraph.acquisition.capture import capture
from quadgraph.acquisition.capture.strict_json import Member
from quadgraph.acquisition.lighting.near_lamp import REFLECTANCE, REFLECTANCE_DEVIATION
from quadgraph.acquisition.session.shots import LARGEST, Shot, frames_of
from quadgraph.base.errors import InputError

MOST_BOARDS = 64  # photographs of the board under one lamp


@dataclass(frozen=True)
class LampStatement:
    """A light to be found. path: into the session; shots: of the board alone, under it alone; reflectance,
    deviation: of the white paper; side: mm, of a small square that shines forwards, None of a point that shines all
    around.
    """

    path: str
    shots: tuple[Shot, ...]
    reflectance: float
    deviation: float
    side: float | None


@dataclass(frozen=True)
class ProjectorStatement:
    """A projector. path: into the session; calibrated: file of `projector_file`; shown: the picture that it showed, of
    its own size; power: W, of three channels, if it shows white all over.
    """

    path: str
    calibrated: Path
    shown: Path
    power: tuple[float, float, float]


@dataclass(frozen=True)
class Lights:
    """All lights by their names: those that are known, lamps to be found, and projectors."""

    known: Mapping[str, dict[str, Any]]
    lamps: Mapping[str, LampStatement]
    projectors: Mapping[str, ProjectorStatement]


def read(member: Member, folder: Path, board: bool) -> Lights:
    """All lights. board: whether there is one to tell lamps. Raises InputError."""
    known, lamps, projectors = {}, {}, {}
    for name, each in member.named().items():
        if isinstance(each.value, Mapping) and "calibrated" in each.value:
            projectors[name] = _projector(each, folder)
        elif isinstance(each.value, Mapping) and "calibrate" in each.value:
            if not board:
                raise InputError(f"{each.file}: {each.path}.calibrate: found without `board`, whose paper tells it")
            lamps[name] = _lamp(name, each, folder)
        else:
            known[name] = capture.light(each, folder)
    return Lights(known, lamps, projectors)


def _projector(member: Member, folder: Path) -> ProjectorStatement:
    members = member.members(("type", "calibrated", "shown"), ("power",))
    members["type"].one_of(("projector",), "what is calibrated is a projector")
    power, found = members.get("power"), [1.0]
    if power:
        each = power.items(3) if isinstance(power.value, list) else [power]
        found = [one.number(0, LARGEST, "W, if it shows white all over") for one in each]
    if len(found) == 2:
        member.wrong("allowed is a power, or three of red, green and blue")
    return ProjectorStatement(
        member.path,
        capture.file_of(members["calibrated"], folder, "what quadgraph capture projector wrote"),
        capture.file_of(members["shown"], folder, "the picture that it showed"),
        (found[0], found[len(found) // 2], found[-1]),
    )


def _lamp(name: str, member: Member, folder: Path) -> LampStatement:
    members = member.members(("type", "calibrate"), ("reflectance", "deviation", "side"))
    kind = members["type"].one_of(("point", "rectangle"), "the board tells of no other: state position and power")
    side = members.get("side")
    if (side is not None) != (kind == "rectangle"):
        said = "has to be there with type rectangle, mm, of a square" if side is None else "is for type rectangle alone"
        raise InputError(f"{member.file}: {member.path}.side: {said}")
    shots = []
    for each in members["calibrate"].items(MOST_BOARDS):
        frames = frames_of(each.members(("frames",), ())["frames"], folder)
        shots.append(Shot(each.path, frames, (name,), 1.0, None))
    reflectance, deviation = members.get("reflectance"), members.get("deviation")
    return LampStatement(
        member.path,
        tuple(shots),
        reflectance.number(0.05, 1, "of the white paper") if reflectance else REFLECTANCE,
        deviation.number(0, 0.5, "standard deviation of `reflectance`") if deviation else REFLECTANCE_DEVIATION,
        side.number(0, 200, "mm, of the square that shines; a larger one is not small", True) if side else None,
    )
