"""The board's corners in a photograph, to hundredths of a pixel.

OpenCV finds them; each is then where two edges cross that fit the photograph best. What OpenCV's own refinement finds
was 0.05 pixels off in the median of sharp photographs, this a tenth of that.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.special import erf

from quadgraph.acquisition.board.board import Board, opencv

LEAST = 6  # corners, of which a pose is taken
_WHITE = 0.98  # quantile of a photograph that is shown as white
_EDGE, _LEAST_REACH, _MOST_REACH = 1.5, 2.5, 16.0  # pixels: how far from a marker, and from the corner, pixels count
_BLUR = 0.6  # pixels, standard deviation, that the fit starts from
_MISFIT = 0.12  # of the step between black and white, RMS, beyond which something hides the corner
_UNLIKE = 2.0  # times that of the median corner, beyond which something does in part
_STRAY = 3.0  # pixels from where OpenCV found it


@dataclass(frozen=True, eq=False)
class Corners:
    """numbers: (n,) of corners in the board; places: (n, 2) pixels from the photograph's upper left corner."""

    numbers: np.ndarray
    places: np.ndarray


def none() -> Corners:
    """Those of a photograph without a board."""
    return Corners(np.empty(0, np.int64), np.empty((0, 2)))


def find(board: Board, linear: np.ndarray, refine: bool = True) -> Corners:
    """The corners in a photograph, (h, w) linear luminance, in the order of their numbers; none where it has none.

    refine: from where OpenCV finds them, which takes most of the time. Raises InputError if OpenCV is not there.
    """
    cv2 = opencv()
    white = float(np.quantile(linear, _WHITE)) or 1.0
    shown = np.round(255 * np.sqrt(np.clip(linear / white, 0, 1))).astype(np.uint8)
    places, numbers, _, _ = cv2.aruco.CharucoDetector(board.detected()).detectBoard(shown)
    if numbers is None or len(numbers) < 4:
        return none()
    numbers = np.asarray(numbers, np.int64).ravel()
    places = np.asarray(places, np.float64).reshape(-1, 2)
    order = np.argsort(numbers)
    numbers, places = numbers[order], places[order]
    if not refine:
        return Corners(numbers, places + 0.5)
    steps = _steps(board, numbers, places)
    if steps is None:
        return none()
    gap = (board.square - board.marker) / 2
    shares = linear / white
    refined = [_refined(shares, place, step, gap) for place, step in zip(places, steps, strict=True)]
    misfits = np.array([np.inf if each is None else each[1] for each in refined])
    usual = float(np.median(misfits[np.isfinite(misfits)])) if np.isfinite(misfits).any() else 0.0
    kept = np.flatnonzero(misfits <= min(_MISFIT, _UNLIKE * usual))
    places = np.array([each[0] for each in refined if each is not None]).reshape(-1, 2)
    where = np.cumsum(np.isfinite(misfits)) - 1
    return Corners(numbers[kept], places[where[kept]] + 0.5)


def _steps(board: Board, numbers: np.ndarray, places: np.ndarray) -> np.ndarray | None:
    """(n, 2, 2) columns: by how many pixels a mm along x and y of the board goes at each corner."""
    cv2 = opencv()
    flat = board.corners()[numbers, :2]
    across, _ = cv2.findHomography(flat, places, cv2.RANSAC, 5.0)
    if across is None:
        return None
    whole = np.concatenate([flat, np.ones((len(flat), 1))], axis=1) @ across.T
    weight = whole[:, 2, None, None]
    return np.asarray((across[:2, :2] - (whole[:, :2] / whole[:, 2:])[:, :, None] * across[2, :2]) / weight)


def _refined(linear: np.ndarray, place: np.ndarray, step: np.ndarray, gap: float) -> tuple[np.ndarray, float] | None:
    """Where two edges along `step` cross, from the middle of the first pixel, and how far off the photograph is, as a
    share of the step between black and white; None where it shows no edges.

    gap: mm from the corner to the nearest marker along x and y.
    """
    scale = np.linalg.norm(step, axis=0)
    if not np.isfinite(step).all() or abs(np.linalg.det(step)) < 0.1 * scale.prod():
        return None
    reach = np.clip(gap * scale - _EDGE, _LEAST_REACH, _MOST_REACH)
    wide = int(np.ceil(reach.sum()))
    low = np.round(place).astype(int) - wide
    if (low < 0).any() or low[0] + 2 * wide >= linear.shape[1] or low[1] + 2 * wide >= linear.shape[0]:
        return None
    columns, rows = np.meshgrid(low[0] + np.arange(2 * wide + 1), low[1] + np.arange(2 * wide + 1))
    offsets = np.stack([columns.ravel(), rows.ravel()], axis=1) - place
    near = (np.abs(offsets @ np.linalg.inv(step).T * scale) <= reach).all(axis=1)
    offsets, values = offsets[near], linear[rows, columns].ravel()[near]
    if len(values) < 20:
        return None
    angles = np.arctan2(step[1], step[0])
    start = np.array([0.0, 0.0, *angles, np.log(_BLUR), values.mean(), 0.0])
    start[6] = float(np.polyfit(_edges(start, offsets)[0], values, 1)[0])
    found = least_squares(
        lambda x: x[5] + x[6] * _edges(x, offsets)[0] - values,
        start,
        lambda x: _slopes(x, offsets),
        method="lm",
        max_nfev=400,
    )
    contrast = abs(found.x[6])
    off = float(np.sqrt((found.fun**2).mean()))
    if not contrast or np.linalg.norm(found.x[:2]) > _STRAY:
        return None
    return place + found.x[:2], off / (2 * contrast)


def _edges(x: np.ndarray, offsets: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """From -1 to 1, (n,), the squares around a corner at x[:2] between edges of angles x[2:4], blurred by exp(x[4]);
    what each edge makes of it, and distances from the edges over sqrt(2) times the blur, (2, n) each.
    """
    from_corner = offsets - x[:2]
    width = np.sqrt(2) * np.exp(np.clip(x[4], -3, 3))
    angles = x[2:4, None]
    away = (from_corner[:, 1] * np.cos(angles) - from_corner[:, 0] * np.sin(angles)) / width
    sides = erf(away)
    return np.asarray(sides[0] * sides[1]), sides, away


def _slopes(x: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """(n, 7) derivatives of x[5] + x[6] * `_edges` with respect to x."""
    whole, sides, away = _edges(x, offsets)
    width = np.sqrt(2) * np.exp(np.clip(x[4], -3, 3))
    each = x[6] * 2 / np.sqrt(np.pi) * np.exp(-(away**2)) * sides[::-1]  # with respect to the distances
    along = np.cos(x[2:4, None]) * (offsets[:, 0] - x[0]) + np.sin(x[2:4, None]) * (offsets[:, 1] - x[1])
    columns = [
        (each * np.sin(x[2:4, None])).sum(axis=0) / width,
        -(each * np.cos(x[2:4, None])).sum(axis=0) / width,
        *(-each * along / width),
        -(each * away).sum(axis=0) if abs(x[4]) < 3 else np.zeros(len(offsets)),
        np.ones(len(offsets)),
        whole,
    ]
    return np.stack(columns, axis=1)
