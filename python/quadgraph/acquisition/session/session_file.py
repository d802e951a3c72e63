"""What a session.json says: a board or cameras of another program, the body on it, lights, and photographs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph.acquisition.board.board import DICTIONARIES, MOST_SQUARES, RULER_MM, SIZES_MM, Board
from quadgraph.acquisition.cameras.rigid_placement import Placement
from quadgraph.acquisition.capture import capture
from quadgraph.acquisition.capture.capture import NoiseModel
from quadgraph.acquisition.capture.strict_json import Member
from quadgraph.acquisition.pose import pose_search
from quadgraph.acquisition.session import light_statements
from quadgraph.acquisition.session.light_statements import LampStatement, ProjectorStatement
from quadgraph.acquisition.session.shots import Shot, read_shot
from quadgraph.base import json_text
from quadgraph.base.errors import InputError
from quadgraph.base.regular_file import read_bytes
from quadgraph.base.units import UNITS_MM

VERSION = 1
MOST_BLACK = 64
DEFAULT_SIZE = 320  # pixels of the square pictures of a capture
_FAR_MM = 1e6
_PLACED = ("axis", "degrees", "translate")  # of `pose` and `world`
_LARGEST = 1e15


@dataclass(frozen=True)
class Session:
    """A whole session. cameras: a file or folder of another program; world: how its world becomes the board's; board:
    None where cameras tell all; placement: of the body on the board; pose_fit: whether masks tell it, pose_near: nearby
    what is stated; noise, saturation: of values where 1 is full scale, None: estimated, and as the kind of file has it;
    black: exposures with the lens covered; size: pixels.
    """

    path: Path
    board: Board | None
    cameras: Path | None
    world: Placement | None
    body: Path
    unit: str | None
    eta: float
    polarised: bool
    placement: Placement
    pose_fit: bool
    pose_near: bool
    lights: Mapping[str, dict[str, Any]]
    lamps: Mapping[str, LampStatement]
    projectors: Mapping[str, ProjectorStatement]
    noise: NoiseModel | None
    saturation: float | None
    black: tuple[Path, ...]
    size: int
    shots: tuple[Shot, ...]

    def all_shots(self) -> tuple[Shot, ...]:
        """Those of the body, and those of the board that tell of lamps."""
        return self.shots + tuple(shot for lamp in self.lamps.values() for shot in lamp.shots)

    def files(self) -> list[Path]:
        """All files that it names, and its own."""
        found = [self.path, self.body, *self.black, *([self.cameras] if self.cameras else [])]
        for shot in self.all_shots():
            found += [frame.file for frame in (*shot.frames, *shot.background)]
            found += [shot.mask] if shot.mask else []
        for projector in self.projectors.values():
            found += [projector.calibrated, projector.shown]
        return found


def read(path: Path) -> Session:
    """Read and check a session.json, or that of a folder; no photograph is opened.

    Raises InputError naming the file, the path into it, what was found, what is allowed and the next step.
    """
    path = path / "session.json" if path.is_dir() else path
    try:
        document = json_text.loads(read_bytes(path))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error}); docs/capture.md shows one") from error
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    return _session(path, Member(str(path), "", document))


def _session(path: Path, document: Member) -> Session:
    required = ("quadgraph_session", "body", "eta", "lights", "photographs")
    optional = ("board", "cameras", "world", "unit", "polarised", "pose", "noise", "saturation", "black", "size")
    members = document.members(required, optional)
    members["quadgraph_session"].whole(VERSION, VERSION, "the version of this format")
    folder = path.parent
    cameras, black = members.get("cameras"), members.get("black")
    if "board" not in members and cameras is None:
        raise InputError(f'{path}: board: is missing, and cameras too; one has to be there: "board": {{}} is the usual')
    if "world" in members and cameras is None:
        members["world"].wrong("allowed is it beside cameras; leave it out")
    polarised = members.get("polarised")
    if polarised is not None and not isinstance(polarised.value, bool):
        polarised.wrong("allowed are true and false")
    lights = light_statements.read(members["lights"], folder, "board" in members)
    names = list(members["lights"].named())
    unit, size, saturation = members.get("unit"), members.get("size"), members.get("saturation")
    shots = tuple(read_shot(each, folder, names) for each in members["photographs"].items(capture.MOST_PHOTOGRAPHS))
    return Session(
        path,
        _board(members["board"]) if "board" in members else None,
        _place(cameras, folder) if cameras else None,
        _placement(members["world"].members((), (*_PLACED, "scale"))) if "world" in members else None,
        capture.file_of(members["body"], folder, "a baked .qgraph or a mesh"),
        unit.one_of(tuple(UNITS_MM), "say the unit of the mesh's coordinates") if unit else None,
        members["eta"].number(1, 3, "index of refraction inside over outside"),
        bool(polarised and polarised.value),
        *_pose(members.get("pose"), shots),
        lights.known,
        lights.lamps,
        lights.projectors,
        capture.noise_of(members["noise"]) if "noise" in members else None,
        saturation.number(0, _LARGEST, "a value; 1 is the full scale of a .png and a raw file", True)
        if saturation
        else None,
        tuple(capture.file_of(each, folder, "an exposure with the lens covered") for each in black.items(MOST_BLACK))
        if black
        else (),
        size.whole(8, capture.MOST_SIDE, "pixels of the capture's pictures") if size else DEFAULT_SIZE,
        shots,
    )


def _place(member: Member, folder: Path) -> Path:
    found = folder / member.text("a file or a folder")
    if not found.exists():
        member.wrong(
            "allowed is what is there beside the session: a folder of COLMAP's, a transforms.json, or a lens as .yml"
        )
    return found


def _board(member: Member) -> Board:
    members = member.members((), ("squares", "square", "marker", "dictionary", "hollow", "printed"))
    usual = Board()
    columns, rows = _pair(members.get("squares"), (usual.columns, usual.rows), 3)
    hollow = _pair(members.get("hollow"), usual.hollow, 0)
    sides = []
    for name, otherwise in (("square", usual.square), ("marker", usual.marker)):
        side = members.get(name)
        sides.append(side.number(0, SIZES_MM[1], "mm", above=True) if side else otherwise)
    dictionary, printed = members.get("dictionary"), members.get("printed")
    rulers = (RULER_MM, RULER_MM)
    if printed:
        measured = [each.number(RULER_MM / 4, RULER_MM * 4, "mm that a ruler measures") for each in printed.items(2)]
        if len(measured) != 2:
            printed.wrong("allowed are two numbers: the ruler along x and that along y, mm")
        rulers = (measured[0], measured[1])
    kind = dictionary.one_of(DICTIONARIES, "as the board says it") if dictionary else usual.dictionary
    board = Board(columns, rows, sides[0], sides[1], kind, hollow, rulers)
    try:
        board.check()
    except InputError as error:
        raise InputError(f"{member.file}: {error}") from None
    return board


def _pair(member: Member | None, otherwise: tuple[int, int], low: int) -> tuple[int, int]:
    if member is None:
        return otherwise
    found = [each.whole(low, MOST_SQUARES, "squares") for each in member.items(2)]
    if len(found) != 2:
        member.wrong("allowed are two numbers: columns and rows")
    return found[0], found[1]


def _pose(member: Member | None, shots: Sequence[Shot]) -> tuple[Placement, bool, bool]:
    """Of the body: what is stated, whether masks tell it, and whether that is nearby."""
    if member is None:
        return _placement({}), False, False
    members = member.members((), (*_PLACED, "fit"))
    fit = members.pop("fit", None)
    if fit is not None and not isinstance(fit.value, bool):
        fit.wrong("allowed are true, by masks, and false")
    masked = sum(1 for shot in shots if shot.mask or shot.background)
    if fit is not None and fit.value and masked < pose_search.LEAST_MASKS:
        fit.wrong(f"{masked} photographs have a mask or a background, allowed are {pose_search.LEAST_MASKS} or more")
    return _placement(members), bool(fit and fit.value), bool(members)


def _placement(members: Mapping[str, Member]) -> Placement:
    axis = _triple(members["axis"], "direction") if "axis" in members else [0.0, 0.0, 1.0]
    if not any(axis):
        members["axis"].wrong("allowed is any direction but zero")
    degrees, scale = members.get("degrees"), members.get("scale")
    return Placement(
        scale.number(0, _FAR_MM, "mm of a unit of the other program's world", above=True) if scale else 1.0,
        (axis[0], axis[1], axis[2]),
        degrees.number(-3600, 3600, "degrees about the axis") if degrees else 0.0,
        np.array(_triple(members["translate"], "mm") if "translate" in members else [0.0, 0.0, 0.0]),
    )


def _triple(member: Member, what: str) -> list[float]:
    found = [each.number(-_FAR_MM, _FAR_MM, what) for each in member.items(3)]
    if len(found) != 3:
        member.wrong(f"allowed are three numbers ({what})")
    return found
