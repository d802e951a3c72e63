"""Lenses and poses of a session's photographs, in the board's coordinates: by the board, or by another program."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from quadgraph.acquisition.board import calibration, corners
from quadgraph.acquisition.board.board import Board
from quadgraph.acquisition.board.calibration import Located
from quadgraph.acquisition.board.corners import Corners
from quadgraph.acquisition.cameras import colmap, nerf_transforms, opencv_yaml
from quadgraph.acquisition.cameras.foreign import ForeignCameras
from quadgraph.acquisition.cameras.lens import Lens, Pose, project
from quadgraph.acquisition.cameras.rigid_placement import Placement
from quadgraph.acquisition.session.session_file import Session
from quadgraph.acquisition.session.shots import Shot
from quadgraph.base.errors import InputError
from quadgraph.base.message import meant

_LEAST_TO_ALIGN = 3  # photographs with the board, by which another program's world is laid on it


@dataclass(frozen=True, eq=False)
class LocatedCamera:
    """Of one photograph: lens, pose, and what the board says of them, where it was found."""

    lens: Lens
    pose: Pose
    board: Located | None


def read_cameras(path: Path) -> ForeignCameras:
    """Cameras of another program: a folder of COLMAP's, a transforms.json, or a lens as .yml. Raises InputError."""
    if path.is_dir():
        if colmap.is_model(path):
            return colmap.read(path)
        if (path / "transforms.json").is_file():
            return nerf_transforms.read(path / "transforms.json")
        raise InputError(f"{path}: found no cameras.bin, cameras.txt or transforms.json, allowed is a folder with one")
    if path.suffix.lower() == ".json":
        return nerf_transforms.read(path)
    if path.suffix.lower() in (".yml", ".yaml", ".xml"):
        return opencv_yaml.read(path)
    raise InputError(
        f"{path}: found {path.suffix or 'no ending'}, allowed are a folder of COLMAP's, transforms.json and .yml"
    )


def locate(
    session: Session, sizes: Mapping[str, tuple[int, int]], found: Mapping[str, Corners]
) -> dict[str, LocatedCamera]:
    """The cameras of all shots by their paths.

    sizes: pixels of each; found: corners of the board, none where it was not seen. Raises InputError.
    """
    board = session.board
    foreign = read_cameras(session.cameras) if session.cameras else None
    if foreign is not None and foreign.poses:
        return _by_program(session, foreign, sizes, found)
    assert board is not None or foreign is not None
    if board is None:
        raise InputError(
            f"{session.path}: board: is missing, {session.cameras} holds a lens without poses; add the board"
        )
    _check_corners(session, session.all_shots(), found)
    if foreign is not None and foreign.lens is not None:
        lens = _of_size(session, foreign.lens, sizes)
        located = {name: calibration.locate(board, lens, each) for name, each in found.items()}
        return {name: LocatedCamera(lens, each.pose, each) for name, each in located.items()}
    return _by_board(session, board, sizes, found)


def _check_corners(session: Session, shots: Iterable[Shot], found: Mapping[str, Corners]) -> None:
    for shot in shots:
        count = len(found[shot.path].numbers)
        if count < corners.LEAST:
            raise InputError(
                f"{session.path}: {shot.path}: {shot.frames[0].file.name}: found {count} corners of the board, allowed "
                f"are {corners.LEAST} or more: is it the board that `board` says, in focus, not too dark, all but what "
                "the body hides in the picture?"
            )


def _by_board(
    session: Session, board: Board, sizes: Mapping[str, tuple[int, int]], found: Mapping[str, Corners]
) -> dict[str, LocatedCamera]:
    """Lens and poses by the board alone; photographs of another size have another lens."""
    cameras: dict[str, LocatedCamera] = {}
    for size in dict.fromkeys(sizes.values()):
        mine = {name: found[name] for name in found if sizes[name] == size}
        try:
            lens, located = calibration.calibrate(board, mine, size)
        except InputError as error:
            raise InputError(f"{session.path}: photographs of {size[0]} x {size[1]} pixels: {error}") from None
        cameras |= {name: LocatedCamera(lens, each.pose, each) for name, each in located.items()}
    return cameras


def _of_size(session: Session, lens: Lens, sizes: Mapping[str, tuple[int, int]]) -> Lens:
    for name, size in sizes.items():
        if size != (lens.width, lens.height):
            raise InputError(
                f"{session.path}: {name}: found {size[0]} x {size[1]} pixels, the lens of {session.cameras} has "
                f"{lens.width} x {lens.height}; calibrate with photographs of the same size"
            )
    return lens


def _by_program(
    session: Session, foreign: ForeignCameras, sizes: Mapping[str, tuple[int, int]], found: Mapping[str, Corners]
) -> dict[str, LocatedCamera]:
    """Cameras of another program, its world laid on the board's as the session says it, or as the board is seen."""
    names = {shot.path: _named(session, shot, foreign) for shot in session.shots}
    for path, name in names.items():
        lens = foreign.lenses[name]
        if sizes[path] != (lens.width, lens.height):
            raise InputError(
                f"{session.path}: {path}: found {sizes[path][0]} x {sizes[path][1]} pixels, {foreign.source} has "
                f"{lens.width} x {lens.height} of {name}; use the photographs that were reconstructed"
            )
    seen: dict[str, Located] = {}
    if session.board is not None:
        seen = {
            path: calibration.locate(session.board, foreign.lenses[names[path]], each)
            for path, each in found.items()
            if path in names and len(each.numbers) >= corners.LEAST
        }
    poses = {path: foreign.poses[name] for path, name in names.items()}
    world = session.world or _aligned(session, foreign, poses, seen)
    cameras = {}
    for path, name in names.items():
        lens, pose = foreign.lenses[name], poses[path].moved(world.scale, world.rotation, world.translation)
        cameras[path] = LocatedCamera(lens, pose, _judged(session.board, lens, pose, seen.get(path)))
    return cameras | _of_lamps(session, foreign, sizes, found)


def _of_lamps(
    session: Session, foreign: ForeignCameras, sizes: Mapping[str, tuple[int, int]], found: Mapping[str, Corners]
) -> dict[str, LocatedCamera]:
    """Photographs of the board alone, which the other program need not know: poses by the board, its lenses."""
    lenses = {(lens.width, lens.height): lens for lens in foreign.lenses.values()}
    cameras = {}
    for shot in (shot for lamp in session.lamps.values() for shot in lamp.shots):
        assert session.board is not None
        _check_corners(session, [shot], found)
        lens = lenses.get(sizes[shot.path])
        if lens is None:
            raise InputError(
                f"{session.path}: {shot.path}: found {' x '.join(map(str, sizes[shot.path]))} pixels, allowed are "
                f"those of a lens of {foreign.source}: " + ", ".join(f"{wide} x {high}" for wide, high in lenses)
            )
        located = calibration.locate(session.board, lens, found[shot.path])
        cameras[shot.path] = LocatedCamera(lens, located.pose, located)
    return cameras


def _named(session: Session, shot: Shot, foreign: ForeignCameras) -> str:
    """The other program's name of a shot, of any of its frames, with or without folders and endings."""
    wanted = [frame.file for frame in shot.frames]
    for name in foreign.poses:
        path = Path(name)
        if any(path.name == each.name or (not path.suffix and path.name == each.stem) for each in wanted):
            return name
    stems = {Path(name).stem: name for name in foreign.poses}
    for each in wanted:
        if each.stem in stems:
            return stems[each.stem]
    raise InputError(
        f"{session.path}: {shot.path}: {wanted[0].name} has no camera in {foreign.source}"
        f"{meant(wanted[0].name, foreign.poses)}; it has {len(foreign.poses)} photographs: leave this one out, or "
        "reconstruct with it"
    )


@dataclass(frozen=True, eq=False)
class _Alignment:
    scale: float
    rotation: np.ndarray
    translation: np.ndarray


def _aligned(
    session: Session, foreign: ForeignCameras, poses: Mapping[str, Pose], seen: Mapping[str, Located]
) -> _Alignment | Placement:
    """The similarity by which the poses are most nearly those that the board gives: turned, then scaled and moved."""
    if len(seen) < _LEAST_TO_ALIGN:
        raise InputError(
            f"{session.path}: world: is missing, and the board is seen in {len(seen)} photographs of {foreign.source}; "
            f'one has to be there: "world": {{"scale": MM, ...}}, or the board in {_LEAST_TO_ALIGN} photographs'
        )
    turns = sum(each.pose.rotation.T @ poses[path].rotation for path, each in seen.items())
    left, _, right = np.linalg.svd(turns)
    rotation = left @ np.diag([1, 1, np.linalg.det(left @ right)]) @ right
    there = np.array([poses[path].eye for path in seen]) @ rotation.T
    here = np.array([each.pose.eye for each in seen.values()])
    spread = there - there.mean(axis=0)
    whole = float((spread**2).sum())
    if whole == 0:
        raise InputError(f"{session.path}: cameras: all stand at one place in {foreign.source}; state `world`")
    scale = float((spread * (here - here.mean(axis=0))).sum()) / whole
    if scale <= 0:
        raise InputError(f"{session.path}: cameras: {foreign.source} contradicts the board; is it of these?")
    return _Alignment(scale, rotation, here.mean(axis=0) - scale * there.mean(axis=0))


def _judged(board: Board | None, lens: Lens, pose: Pose, seen: Located | None) -> Located | None:
    """The board's corners held against a pose that is not from them."""
    if board is None or seen is None:
        return None
    off = project(lens, pose, board.corners()[seen.corners.numbers]) - seen.corners.places
    return Located(pose, seen.corners, off, seen.left_out)
