"""The record that `quadgraph capture import` leaves beside a capture, as `capture check` reads it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from quadgraph.acquisition.capture.capture import MOST_PHOTOGRAPHS
from quadgraph.acquisition.capture.strict_json import Member
from quadgraph.acquisition.pose.pose_search import PoseByMasks
from quadgraph.acquisition.session import capture_writing
from quadgraph.base import json_text
from quadgraph.base.errors import InputError
from quadgraph.base.regular_file import read_bytes

_FAR = 1e9
_MOST_CORNERS = 10_000
_MEMBERS = ("photograph", "files", "exposures", "exposure_ratios", "moved", "samples", "size", "eye")
_MORE_OF_LAMPS = ("ambient", "falloff", "samples", "reflectance", "reflectance_deviation", "aim")


@dataclass(frozen=True, eq=False)
class Imported:
    """One photograph: size, pixels; corners: (n, 4), places and by how much they are off, pixels; the rest as
    `capture_writing.record` has it.
    """

    size: tuple[int, int]
    moved: float
    ratios: list[float]
    reprojection: float | None
    corners: np.ndarray


@dataclass(frozen=True)
class FoundLamp:
    """As `near_lamp.NearLamp` has it; boards: photographs of the board; worst: the largest RMS distance of its
    corners in one of them, pixels; moved: the farthest that a camera moved between exposures, pixels.
    """

    position: tuple[float, ...]
    position_deviation: tuple[float, ...]
    power: tuple[float, ...]
    power_deviation: tuple[float, ...]
    share: float
    off: float
    unlike: bool
    boards: int
    worst: float
    moved: float

    def line(self) -> str:
        """Place and power with their deviations."""
        place = ", ".join(f"{each:.1f}" for each in self.position)
        unsure = float(np.linalg.norm(self.position_deviation))
        power = " / ".join(f"{each:.4g}" for each in self.power)
        relative = max(deviation / each for deviation, each in zip(self.power_deviation, self.power, strict=True))
        return (
            f"{place} mm, to {unsure:.1f} mm; power {power} W times gain, to {relative:.1%}; other light "
            f"{self.share:.1%} of that on the board; {self.boards} photographs of it, {self.off:.1%} off"
        )


@dataclass(frozen=True)
class Record:
    """printed: what the two rulers measure, mm, None without a board; photographs: by the names of their cameras;
    lamps: those that the board told, by their names; pose: of the body, None where it was stated.
    """

    printed: tuple[float, float] | None
    photographs: Mapping[str, Imported]
    lamps: Mapping[str, FoundLamp] = field(default_factory=dict)
    pose: PoseByMasks | None = None


def place_of(path: Path) -> Path:
    """Where the record of a capture would be."""
    return capture_writing.record_of(path)


def read(capture: Path) -> Record | None:
    """The record beside a capture, None where there is none. Raises InputError for one that cannot be read."""
    path = place_of(capture)
    if not path.is_file():
        return None
    try:
        document = Member(str(path), "", json_text.loads(read_bytes(path)))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from error
    except InputError as error:
        raise InputError(f"{path}: {error}; import again, or remove it") from None
    members = document.members(("quadgraph_import", "noise", "lenses", "board", "photographs"), ("lamps", "pose"))
    members["quadgraph_import"].whole(1, 1, "the version of this format")
    printed = None
    if members["board"].value is not None:
        rulers = members["board"].members(("size", "printed"), ())["printed"].items(2)
        measured = [each.number(0, _FAR, "mm") for each in rulers]
        printed = (measured[0], measured[-1])
    found = {}
    for each in members["photographs"].items(MOST_PHOTOGRAPHS):
        own = each.members(_MEMBERS, ("reprojection", "left_out", "corners"))
        found[own["photograph"].text("its camera")] = _imported(own)
    lamps = members["lamps"].value and members["lamps"].named() if "lamps" in members else {}
    pose = found_pose(members["pose"]) if "pose" in members else None
    return Record(printed, found, {name: found_lamp(each) for name, each in (lamps or {}).items()}, pose)


def found_pose(member: Member) -> PoseByMasks:
    """The pose of a record. Raises InputError."""
    own = member.members(("off", "shared", "degrees", "mm", "photographs", "symmetric", "others", "lowest"), ())
    degrees, mm = (
        None if own[name].value is None else own[name].number(0, _FAR, "a deviation") for name in ("degrees", "mm")
    )
    others = own["others"].named() if own["others"].value else {}
    return PoseByMasks(
        own["off"].number(0, _FAR, "pixels"),
        own["shared"].number(0, 1, "share of masks and outlines"),
        degrees,
        mm,
        own["photographs"].whole(1, MOST_PHOTOGRAPHS, "photographs"),
        own["symmetric"].value is True,
        {path: each.number(0, 1, "share of a mask and the body") for path, each in others.items()},
        own["lowest"].number(-_FAR, _FAR, "mm"),
    )


def found_lamp(member: Member) -> FoundLamp:
    """A lamp of a record. Raises InputError."""
    triples = ("position", "position_deviation", "power", "power_deviation")
    own = member.members((*triples, "share", "off", "unlike", "boards"), _MORE_OF_LAMPS)
    position, position_deviation, power, power_deviation = (
        tuple(each.number(-_FAR, _FAR, "mm, or W") for each in own[name].items(3)) for name in triples
    )
    boards = [each.members(("files", "moved", "reprojection"), ()) for each in own["boards"].items(MOST_PHOTOGRAPHS)]
    if any(len(each) != 3 for each in (position, position_deviation, power, power_deviation)) or min(power) <= 0:
        member.wrong("allowed are three numbers each of place and power, powers above 0")
    return FoundLamp(
        position,
        position_deviation,
        power,
        power_deviation,
        own["share"].number(-_FAR, _FAR, "share of the light"),
        own["off"].number(0, _FAR, "share of a value"),
        own["unlike"].value is True,
        len(boards),
        max(each["reprojection"].number(0, _FAR, "pixels") for each in boards),
        max(each["moved"].number(0, _FAR, "pixels") for each in boards),
    )


def _imported(own: Mapping[str, Member]) -> Imported:
    size = [each.whole(1, 1 << 20, "pixels") for each in own["size"].items(2)]
    ratios = own["exposure_ratios"]
    corners = np.empty((0, 4))
    if "corners" in own:
        rows = [row.items(4) for row in own["corners"].items(_MOST_CORNERS)]
        if any(len(row) != 4 for row in rows):
            own["corners"].wrong("allowed are rows of four numbers")
        corners = np.array([[value.number(-_FAR, _FAR, "pixels") for value in row] for row in rows])
    return Imported(
        (size[0], size[-1]),
        own["moved"].number(0, _FAR, "pixels"),
        [each.number(-_FAR, _FAR, "ratio") for each in ratios.items(64)] if ratios.value else [],
        own["reprojection"].number(0, _FAR, "pixels") if "reprojection" in own else None,
        corners,
    )
