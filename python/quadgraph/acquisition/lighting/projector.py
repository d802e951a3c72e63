"""A projector as a camera that works the other way: lens and place by what it shows on the board in several places.

Which pixel of the projector lights a corner of the board is told by the stripes around the corner; the rest is the
calibration of a camera.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from quadgraph.acquisition.board import calibration
from quadgraph.acquisition.board.board import Board, opencv
from quadgraph.acquisition.board.calibration import Located
from quadgraph.acquisition.board.corners import Corners
from quadgraph.acquisition.cameras.lens import Lens
from quadgraph.base.errors import InputError

LEAST_PLACES, LEAST_CORNERS = 3, 12
_REACH = (6.0, 40.0)  # pixels around a corner whose stripes tell, 0.4 of the way to the nearest one
_TOLD = 0.3  # of them, that have to tell


@dataclass(frozen=True, eq=False)
class Projector:
    """lens: of the projector's own pixels; places: of the board, each with its pose, as a camera's, and how far its
    corners are off, by their names.
    """

    lens: Lens
    places: Mapping[str, Located]

    @property
    def rms(self) -> float:
        """RMS distance of all corners from where the projector should light them, of its pixels."""
        squares = np.concatenate([(each.off**2).sum(axis=1) for each in self.places.values()])
        return float(np.sqrt(squares.mean()))


def lit_corners(where: str, corners: Corners, lit: np.ndarray, stripe: int) -> Corners:
    """The projector's pixels that light corners of the board, where the stripes around them tell.

    lit: (h, w, 2) as `stripes.decode` has it. Raises InputError, which begins with `where`, where too few are lit.
    """
    numbers, places = [], []
    for number, place, reach in zip(corners.numbers, corners.places, _reaches(corners.places), strict=True):
        found = _at(lit, place, reach, stripe)
        if found is not None:
            numbers.append(number)
            places.append(found)
    if len(numbers) < LEAST_CORNERS:
        raise InputError(
            f"{where}: the projector's stripes tell {len(numbers)} of {len(corners.numbers)} corners of the board that "
            f"are seen, allowed are {LEAST_CORNERS} or more; light the whole board, in focus, and take all patterns in "
            "their order, the camera standing still"
        )
    return Corners(np.array(numbers), np.array(places))


def _reaches(places: np.ndarray) -> np.ndarray:
    """(n,) pixels around each corner that count."""
    apart = np.linalg.norm(places[:, None] - places, axis=2) + np.diag(np.full(len(places), np.inf))
    return np.clip(0.4 * apart.min(axis=1), *_REACH)


def _at(lit: np.ndarray, place: np.ndarray, reach: float, stripe: int) -> np.ndarray | None:
    """Where the homography from photograph to projector that fits the surroundings best takes a place, (2,)."""
    cv2 = opencv()
    low = np.maximum(np.floor(place - reach).astype(int), 0)
    high = np.minimum(np.ceil(place + reach).astype(int), lit.shape[1::-1])
    near = lit[low[1] : high[1], low[0] : high[0]]
    told = np.isfinite(near[..., 0])
    if told.sum() < max(_TOLD * told.size, 30):
        return None
    rows, columns = np.nonzero(told)
    there = near[told]
    if (np.ptp(there, axis=0) < 2 * stripe).any():
        return None
    here = np.stack([columns, rows], axis=1) + low + 0.5 - place
    # A pixel on the way is told to half a stripe along both; codes that were misread are far away.
    across, _ = cv2.findHomography(here, there, cv2.RANSAC, 1.5 * stripe, maxIters=300)
    if across is None:
        return None
    found = across[:, 2] / across[2, 2]
    return np.asarray(found[:2])


def calibrate(board: Board, lit: Mapping[str, Corners], size: tuple[int, int]) -> Projector:
    """Lens and places together, by least squares in the projector's pixels; outliers are left out once.

    lit: by place of the board, the projector's pixels at its corners; size: of the projector, pixels. Raises InputError
    for too few places, or ones that look the same way.
    """
    if len(lit) < LEAST_PLACES:
        raise InputError(
            f"found {len(lit)} places of the board, allowed are {LEAST_PLACES} or more, tilted each in another way"
        )
    try:
        lens, located = calibration.fitted(board, lit, size)
    except calibration.AlikeError as error:
        raise InputError(
            f"all places of the board are tilted alike before the projector, to {error.degrees:.1f} degrees, allowed "
            f"are more than {calibration.FLAT:g}: how far it is away cannot be told; prop the board up"
        ) from None
    return Projector(lens, located)
