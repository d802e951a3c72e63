"""Lights as a session.json states them: those of scene files, and lamps that photographs of the board alone tell."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quadgraph.acquisition.capture import capture
from quadgraph.acquisition.capture.strict_json import Member
from quadgraph.acquisition.lighting.point_lamp import REFLECTANCE, REFLECTANCE_DEVIATION
from quadgraph.acquisition.session.shots import Shot, frames_of
from quadgraph.base.errors import InputError

MOST_BOARDS = 64  # photographs of the board under one lamp


@dataclass(frozen=True)
class LampStatement:
    """A point light to be found. path: into the session; shots: of the board alone, under it alone; reflectance,
    deviation: of the white paper.
    """

    path: str
    shots: tuple[Shot, ...]
    reflectance: float
    deviation: float


def read(member: Member, folder: Path, board: bool) -> tuple[dict[str, dict[str, Any]], dict[str, LampStatement]]:
    """The lights that are known, and those to be found, by their names. board: whether there is one to tell them.

    Raises InputError.
    """
    known, lamps = {}, {}
    for name, each in member.named().items():
        if isinstance(each.value, Mapping) and "calibrate" in each.value:
            if not board:
                raise InputError(f"{each.file}: {each.path}.calibrate: found without `board`, whose paper tells it")
            lamps[name] = _lamp(name, each, folder)
        else:
            known[name] = capture.light(each, folder)
    return known, lamps


def _lamp(name: str, member: Member, folder: Path) -> LampStatement:
    members = member.members(("type", "calibrate"), ("reflectance", "deviation"))
    members["type"].one_of(("point",), "photographs of the board tell place and power of a point light alone")
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
    )
