"""The lens of a camera, and where it stood for each photograph, from the corners of the board that they show."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from quadgraph.acquisition.board import corners as board_corners
from quadgraph.acquisition.board.board import Board, opencv
from quadgraph.acquisition.board.corners import Corners
from quadgraph.acquisition.cameras.lens import Lens, Pose, project
from quadgraph.base.errors import InputError

LEAST_PHOTOGRAPHS = 4  # of which a lens is found
_FEW = 15  # photographs, below which k3 is taken for 0
_FAR_OFF, _LEAST_OFF = 5.0, 0.03  # medians of a photograph's errors, and pixels, beyond which a corner is left out
FLAT = 10.0  # degrees between the ways that photographs look, below which focal length and distance cannot be told


class AlikeError(Exception):
    """All photographs look the same way, to so many degrees."""

    def __init__(self, degrees: float) -> None:
        super().__init__()
        self.degrees = degrees


@dataclass(frozen=True, eq=False)
class Located:
    """One photograph: pose, the corners that were kept, and by how many pixels each is off, (n, 2)."""

    pose: Pose
    corners: Corners
    off: np.ndarray
    left_out: int = 0

    @property
    def rms(self) -> float:
        """RMS distance of the corners from where the board's should be, pixels."""
        return float(np.sqrt((self.off**2).sum(axis=1).mean()))


def calibrate(board: Board, found: Mapping[str, Corners], size: tuple[int, int]) -> tuple[Lens, dict[str, Located]]:
    """Lens and poses together, by least squares of the distances in pixels; outliers are left out once.

    found: by photograph, each with as many corners as a pose takes; size: of all photographs, pixels. Raises
    InputError if they are too few, or all look the same way.
    """
    if len(found) < LEAST_PHOTOGRAPHS:
        raise InputError(
            f"{len(found)} photographs show the board, allowed are {LEAST_PHOTOGRAPHS} or more to find the lens by; "
            'take more from other sides, or state a calibrated lens ("cameras": "lens.yml")'
        )
    try:
        return fitted(board, found, size)
    except AlikeError as error:
        raise InputError(
            f"all photographs look the same way, to {error.degrees:.1f} degrees, allowed are more than {FLAT:g}: focal "
            "length and distance cannot be told apart; photograph from other sides, or state a lens in `cameras`"
        ) from None


def fitted(board: Board, found: Mapping[str, Corners], size: tuple[int, int]) -> tuple[Lens, dict[str, Located]]:
    """As `calibrate`, of any number of photographs. Raises AlikeError where all look the same way, and InputError."""
    lens, located = _least_squares(board, found, size)
    widest = _widest(list(located.values()))
    if widest < FLAT:
        raise AlikeError(widest)
    kept = {name: _without_outliers(each) for name, each in located.items()}
    if any(each.left_out for each in kept.values()):
        lens, again = _least_squares(board, {name: each.corners for name, each in kept.items()}, size)
        return lens, {
            name: Located(each.pose, each.corners, each.off, kept[name].left_out) for name, each in again.items()
        }
    return lens, located


def _least_squares(
    board: Board, found: Mapping[str, Corners], size: tuple[int, int]
) -> tuple[Lens, dict[str, Located]]:
    cv2 = opencv()
    places = board.corners()
    objects = [places[each.numbers].astype(np.float32) for each in found.values()]
    pixels = [(each.places - 0.5).astype(np.float32) for each in found.values()]
    flags = cv2.CALIB_FIX_K3 if len(found) < _FEW else 0
    until = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 200, 1e-12)
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)  # several add up in an order that differs from run to run
    try:
        _, matrix, distortion, turns, moves = cv2.calibrateCamera(
            objects, pixels, size, None, None, flags=flags, criteria=until
        )
    except cv2.error as error:
        raise InputError(f"the board's corners make no lens ({str(error)[:120]}); take more photographs") from None
    finally:
        cv2.setNumThreads(threads)
    k1, k2, p1, p2, k3 = (float(each) for each in np.ravel(distortion)[:5])
    principal = float(matrix[0, 2]) + 0.5, float(matrix[1, 2]) + 0.5
    focal = float(matrix[0, 0]), float(matrix[1, 1])
    lens = Lens(*size, *focal, *principal, (k1, k2, k3, 0.0, 0.0, 0.0), (p1, p2))
    located = {}
    for (name, each), turn, move in zip(found.items(), turns, moves, strict=True):
        pose = Pose(cv2.Rodrigues(turn)[0], np.ravel(move).astype(float))
        located[name] = Located(pose, each, project(lens, pose, places[each.numbers]) - each.places)
    return lens, located


def _without_outliers(located: Located) -> Located:
    """Without corners that are far off, unless that would leave too few."""
    distance = np.linalg.norm(located.off, axis=1)
    kept = distance <= max(_FAR_OFF * float(np.median(distance)), _LEAST_OFF)
    if kept.sum() < board_corners.LEAST or kept.all():
        return located
    corners = Corners(located.corners.numbers[kept], located.corners.places[kept])
    return Located(located.pose, corners, located.off[kept], located.left_out + int((~kept).sum()))


def _widest(located: Sequence[Located]) -> float:
    """Degrees between the ways of the two photographs that look most differently."""
    ways = np.array([each.pose.rotation[2] for each in located])
    return float(np.degrees(np.arccos(np.clip(ways @ ways.T, -1, 1))).max())


def locate(board: Board, lens: Lens, corners: Corners) -> Located:
    """The pose of one photograph by a lens that is known; outliers are left out once."""
    first = _posed(board, lens, corners)
    kept = _without_outliers(first)
    if not kept.left_out:
        return first
    again = _posed(board, lens, kept.corners)
    return Located(again.pose, again.corners, again.off, kept.left_out)


def _posed(board: Board, lens: Lens, corners: Corners) -> Located:
    cv2 = opencv()
    places = board.corners()[corners.numbers]
    matrix = np.array([[lens.fx, 0, lens.cx - 0.5], [0, lens.fy, lens.cy - 0.5], [0, 0, 1.0]])
    k1, k2, k3, k4, k5, k6 = lens.radial
    distortion = np.array([k1, k2, *lens.tangential, k3, k4, k5, k6])
    pixels = corners.places - 0.5
    fine, turn, move = cv2.solvePnP(places, pixels, matrix, distortion, flags=cv2.SOLVEPNP_IPPE)
    if not fine:
        raise InputError("the board's corners make no pose; take the photograph again")
    turn, move = cv2.solvePnPRefineLM(places, pixels, matrix, distortion, turn, move)
    pose = Pose(cv2.Rodrigues(turn)[0], np.ravel(move).astype(float))
    return Located(pose, corners, project(lens, pose, places) - corners.places)
