"""How bright the paper of a printed board is where it is white: the strips around its markers, in one photograph."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from quadgraph.acquisition.board.board import RULER_MM, Board
from quadgraph.acquisition.cameras.lens import Lens, Pose
from quadgraph.acquisition.capture.radiance import Radiance
from quadgraph.base.errors import InputError

_ACROSS = np.linspace(-0.2, 0.2, 5)  # of a strip's width, from its middle: places that are averaged
_ALONG = np.linspace(0.05, 0.45, 22)  # of a strip's length, from either end
_CLEAR = 1.5  # pixels from the places to the ink, that blur must not reach
LEAST = 24  # samples of a photograph


@dataclass(frozen=True, eq=False)
class Whites:
    """Samples of one photograph.

    places: (n, 2) mm on the board; values, variances: (n, 3) of radiance as the camera has it; slopes2: (n,) squared
    slopes of the rays from the lens's axis; eye: (3,) mm.
    """

    places: np.ndarray
    values: np.ndarray
    variances: np.ndarray
    slopes2: np.ndarray
    eye: np.ndarray


def sample(where: str, board: Board, radiance: Radiance, lens: Lens, pose: Pose) -> Whites:
    """The means over pieces of white strips that one photograph shows; those that are saturated are left out.

    Raises InputError, which begins with `where`, if it shows too few, saturated ones, or no light.
    """
    places = _pieces(board)  # (pieces, points, 2)
    flat = np.concatenate([places.reshape(-1, 2), np.zeros((places.shape[0] * places.shape[1], 1))], axis=1)
    seen = pose.seen(flat)
    before = seen[:, 2] > 0
    slopes = seen[:, :2] / np.where(before, seen[:, 2], 1)[:, None]
    at = lens.places(slopes)
    within = before & (at >= 0).all(axis=1) & (at < [lens.width, lens.height]).all(axis=1)
    within &= np.linalg.norm(slopes, axis=1) < lens.widest_slope()
    clear = _clear(board, pose, lens, places)
    fine = np.asarray(within.reshape(places.shape[:2]).all(axis=1) & clear)
    if fine.sum() < LEAST:
        raise InputError(
            f"{where}: found {int(fine.sum())} pieces of white paper that are in the picture and wide enough "
            f"({int(clear.sum())} are), allowed are {LEAST} or more; photograph the whole board from nearer"
        )
    usable, values, variances = _means(radiance, np.floor(at).astype(int).reshape(*places.shape), fine)
    if usable.sum() < max(LEAST, fine.sum() / 2):
        raise InputError(
            f"{where}: {1 - usable.sum() / fine.sum():.0%} of the white paper is saturated, allowed is half; expose "
            "for less"
        )
    signal = float(np.median(values[usable] / np.sqrt(variances[usable])))
    if signal < 5:
        raise InputError(
            f"{where}: the board is dark, {signal:.1f} standard deviations of noise, allowed are 5 or more: is the "
            "lamp on, and before the board rather than behind it? Else expose for longer"
        )
    middles = places[fine][usable].mean(axis=1)
    squares = (slopes**2).sum(axis=1).reshape(places.shape[:2])[fine][usable].mean(axis=1)
    return Whites(middles, values[usable], variances[usable], squares, pose.eye)


def _pieces(board: Board) -> np.ndarray:
    """(n, m, 2) places, mm, within pieces of the white strips around each marker, two on each side."""
    gap = (board.square - board.marker) / 2
    across, along = (each.ravel() for each in np.meshgrid(_ACROSS * gap, _ALONG * board.marker))
    pieces = []
    for _, x, y in board.markers():
        for far in (-gap / 2, board.marker + gap / 2):
            for steps in (along, board.marker - along):
                pieces.append(np.stack([x + far + across, y + steps], axis=1))
                pieces.append(np.stack([x + steps, y + far + across], axis=1))
    places = np.array(pieces)
    places[..., 1] = board.size[1] - places[..., 1]
    return places * [each / RULER_MM for each in board.printed]


def _clear(board: Board, pose: Pose, lens: Lens, places: np.ndarray) -> np.ndarray:
    """(n,) whether the ink is far enough from the places of each piece, in pixels of the photograph."""
    gap = (board.square - board.marker) / 2 * min(board.printed) / RULER_MM
    free = (0.5 - _ACROSS[-1]) * gap
    middles = np.concatenate([places.mean(axis=1), np.zeros((len(places), 1))], axis=1)
    narrowest = np.full(len(places), np.inf)
    for step in ([free, 0, 0], [0, free, 0]):
        ends = [pose.seen(middles + sign * np.array(step)) for sign in (0, 1)]
        before = np.minimum(ends[0][:, 2], ends[1][:, 2]) > 0
        at = [lens.places(end[:, :2] / np.where(before, end[:, 2], 1)[:, None]) for end in ends]
        distance = np.linalg.norm(at[1] - at[0], axis=1)
        narrowest = np.minimum(narrowest, np.where(before, distance, 0))
    return narrowest >= _CLEAR


def _means(radiance: Radiance, pixels: np.ndarray, fine: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of each piece that is fine: whether all its pixels count, the mean, (n, 3), and its variance: each pixel once."""
    usable, values, variances = [], [], []
    for each in pixels[fine]:
        columns, rows = np.unique(each, axis=0).T
        usable.append(radiance.usable[rows, columns].all())
        values.append(radiance.values[rows, columns].mean(axis=0, dtype=float))
        variances.append(radiance.variances[rows, columns].mean(axis=0, dtype=float) / len(rows))
    return np.array(usable), np.array(values), np.array(variances)
