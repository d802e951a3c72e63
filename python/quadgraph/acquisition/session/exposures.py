"""The exposures of a session: read, their noise estimated, merged, and what they show of the board."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from quadgraph.acquisition.board import corners
from quadgraph.acquisition.board.board import Board
from quadgraph.acquisition.board.corners import Corners
from quadgraph.acquisition.capture.capture import NoiseModel
from quadgraph.acquisition.capture.radiance import Radiance
from quadgraph.acquisition.session import brackets, frames
from quadgraph.acquisition.session.frames import Frame
from quadgraph.acquisition.session.session_file import Session
from quadgraph.acquisition.session.shots import Shot
from quadgraph.base.errors import InputError

_LUMINANCE = np.array([0.2126, 0.7152, 0.0722], np.float32)
_DEFAULT_FLOOR = 1e-5  # of noise, where it comes out as nothing: a hundred thousandth of full scale
_BRACKETS = 4  # of which the noise is estimated


@dataclass(frozen=True, eq=False)
class ShotContent:
    """What the exposures of a shot show. size: pixels; moved: by how many pixels the board of one exposure lies beside
    that of all; ratios: of each exposure to the next longer, as stated, 1 where that is right.
    """

    size: tuple[int, int]
    corners: Corners
    moved: float
    ratios: list[float]
    exposures: list[float]


class Exposures:
    """The exposures of a session, read when they are asked for."""

    def __init__(self, session: Session) -> None:
        """Read the black ones, and estimate the noise where it is not stated. Raises InputError."""
        self._session = session
        self._black = _black(session)
        self.noise = session.noise or _noise(session, self._black)

    def merged(self, shot: Shot) -> Radiance:
        """The radiance of a shot. Raises InputError."""
        read, exposures = _frames(self._session, shot, self._black)
        return brackets.merge(read, exposures, self.noise, self._black, len(self._session.black))

    def content(self, shot: Shot) -> ShotContent:
        """What a shot shows. Raises InputError."""
        read, exposures = _frames(self._session, shot, self._black)
        radiance = brackets.merge(read, exposures, self.noise, self._black, len(self._session.black))
        ratios = brackets.ratios(read, exposures, self.noise, self._black)
        height, width, _ = radiance.values.shape
        board = self._session.board
        if board is None:
            none = Corners(np.empty(0, np.int64), np.empty((0, 2)))
            return ShotContent((width, height), none, 0.0, ratios, exposures)
        whole = corners.find(board, radiance.values @ _LUMINANCE)
        moved = max(_moved(board, whole, frame) for frame in read) if len(read) > 1 else 0.0
        return ShotContent((width, height), whole, moved, ratios, exposures)


def _black(session: Session) -> np.ndarray | None:
    """The mean of the exposures without light."""
    total: np.ndarray | None = None
    for number, path in enumerate(session.black):
        values = frames.read(f"{session.path}: black[{number}]", path, session.saturation).values
        if total is not None and total.shape != values.shape:
            raise InputError(f"{session.path}: black[{number}]: {path.name} has another size than the first one")
        total = values if total is None else total + values
    return None if total is None else total / np.float32(len(session.black))


def _frames(session: Session, shot: Shot, black: np.ndarray | None) -> tuple[list[Frame], list[float]]:
    """The exposures of a shot, of one size, and how long each is."""
    read: list[Frame] = []
    exposures: list[float] = []
    for each in shot.frames:
        where = f"{session.path}: {each.path}"
        frame = frames.read(where, each.file, session.saturation)
        exposure = each.exposure if each.exposure is not None else frame.exposure
        if exposure is None and len(shot.frames) > 1:
            raise InputError(
                f'{where}: exposure: is missing, {each.file.name} does not say it; write {{"file": "{each.file.name}", '
                '"exposure": SECONDS}'
            )
        for what, values in (("the first exposure", read[0].values if read else None), ("the black ones", black)):
            if values is not None and values.shape != frame.values.shape:
                size = " x ".join(map(str, frame.values.shape[1::-1]))
                allowed = " x ".join(map(str, values.shape[1::-1]))
                raise InputError(f"{where}: {each.file.name} has {size} pixels, allowed are {allowed}, as {what}")
        read.append(frame)
        exposures.append(1.0 if exposure is None else exposure)
    return read, exposures


def _noise(session: Session, black: np.ndarray | None) -> NoiseModel:
    """Noise as the brackets tell it. Raises InputError where there is none."""
    shots = [shot for shot in session.shots if len(shot.frames) > 1]
    found = brackets.estimate_noise((_frames(session, shot, black) for shot in shots[:_BRACKETS]), black)
    if found is None:
        raise InputError(
            f"{session.path}: noise: is missing, and no photograph has two exposures that tell it; state it: "
            '"noise": {"read_out": 0.001, "shot": 0.0001}, where 1 is full scale'
        )
    return found if found.read_out > 0 or found.shot > 0 else NoiseModel(_DEFAULT_FLOOR, 0.0)


def _moved(board: Board, whole: Corners, frame: Frame) -> float:
    """By how many pixels the board lies elsewhere in an exposure than in the merged picture; 0 where it is not seen."""
    found = corners.find(board, frame.values @ _LUMINANCE, refine=False)
    _, mine, other = np.intersect1d(found.numbers, whole.numbers, return_indices=True)
    if len(mine) < corners.LEAST:
        return 0.0
    return float(np.linalg.norm(np.median(found.places[mine] - whole.places[other], axis=0)))
