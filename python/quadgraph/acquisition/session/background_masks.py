"""Masks by a photograph without the body: what differs from it by more than noise, and not as a shadow does.

A shadow, and light that the body throws onto the board, change the board's brightness but not its pattern.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import ndimage

from quadgraph.acquisition.board import corners
from quadgraph.acquisition.board.board import Board, opencv
from quadgraph.acquisition.capture.radiance import Radiance
from quadgraph.acquisition.session.session_file import Session
from quadgraph.acquisition.session.shots import Shot
from quadgraph.base.errors import InputError

_DRIFT = 0.02  # of a value, by which a lamp may have changed
_STEADY = 0.25  # pixels, by which the camera may have moved
_MOST_MOVED = 0.5  # pixels, beyond which it has moved
_DIFFERS = 4.0  # times the mean square of noise, from which on a pixel has changed
_BRIGHTENED = 1.3  # times, that the body may light the board beside it
_SURE = 6.0  # deviations, by which a pixel is brighter or of another colour than the background can be
_WINDOW = 13  # pixels, in which the board's pattern is looked for
_PATTERNED = 8.0  # deviations, of the background within a window that has a pattern
_FITS, _UNLIKE = 0.9, 0.25  # correlations from which on, and up to which, the pattern is there, and is not
_SHADED = 0.15  # of the background's brightness, below which what is of no other colour is its shadow
_JOINED, _SMALL = 9, 5  # pixels, across which pieces of the body hang together, and below which a piece is none
_LEAST_SAME, _LEAST_KEPT, _MOST_KEPT = 0.1, 1e-4, 0.9  # shares of the photograph
_BLOCK, _LIT = 4, 20.0  # pixels along blocks by which light is compared, and deviations that they are bright
_ALIKE = 0.05  # of brightness, within which blocks agree on a factor
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722], np.float32)


@dataclass(frozen=True, eq=False)
class _Pair:
    """Photograph and background, (h, w, 3) each, deviations of their difference, and where both are not saturated."""

    shown: np.ndarray
    empty: np.ndarray
    deviations: np.ndarray
    usable: np.ndarray


def kept_of(session: Session, shot: Shot, radiance: Radiance, empty: Radiance) -> np.ndarray:
    """(h, w) where the body is. Raises InputError where the background does not fit the photograph."""
    where = f"{session.path}: {shot.path}.background: {shot.background[0].file.name}"
    return kept(where, session.board, radiance, empty)


def kept(where: str, board: Board | None, radiance: Radiance, empty: Radiance) -> np.ndarray:
    """As `kept_of`; `where` begins every error."""
    if radiance.values.shape != empty.values.shape:
        size, allowed = (" x ".join(map(str, each.values.shape[1::-1])) for each in (empty, radiance))
        raise InputError(f"{where} has {size} pixels, allowed are {allowed}, as the photograph: is it of this camera?")
    if board is not None:
        _check_moved(where, board, radiance, empty)
    pair = _pair(radiance, empty)
    changed = _changed(pair)
    _check_light(where, pair, changed)
    board_there, body = _told(pair, changed)
    found = _grown(pair, board_there, body)
    share = float(found.mean())
    if not _LEAST_KEPT <= share <= _MOST_KEPT:
        raise InputError(
            f"{where}: the body by it is {share:.2%} of the photograph, allowed are {_LEAST_KEPT:.2%} to "
            f"{_MOST_KEPT:.0%}: is the body in the photograph, and not in the background? Else make a mask by hand"
        )
    return found


def _check_moved(where: str, board: Board, radiance: Radiance, empty: Radiance) -> None:
    seen, without = (corners.find(board, each.values @ _LUMINANCE, refine=False) for each in (radiance, empty))
    _, mine, other = np.intersect1d(seen.numbers, without.numbers, return_indices=True)
    if len(seen.numbers) < corners.LEAST:
        return
    if len(mine) < corners.LEAST:
        raise InputError(
            f"{where}: shows {len(mine)} of the {len(seen.numbers)} corners of the board that the photograph shows; "
            "allowed is one from the same place, all but the body as it was"
        )
    moved = float(np.linalg.norm(np.median(without.places[other] - seen.places[mine], axis=0)))
    if moved > _MOST_MOVED:
        raise InputError(
            f"{where}: the camera moved by {moved:.1f} pixels, allowed are {_MOST_MOVED:g}; photograph it from the "
            "same place, on a tripod, or make a mask by hand"
        )


def _pair(radiance: Radiance, empty: Radiance) -> _Pair:
    cv2 = opencv()
    slope = np.hypot(*(cv2.Sobel(empty.values, cv2.CV_32F, dx, 1 - dx, ksize=3, scale=0.125) for dx in (0, 1)))
    variances = radiance.variances + empty.variances
    variances = variances + (_DRIFT * empty.values) ** 2 + (_STEADY * slope) ** 2
    return _Pair(radiance.values, empty.values, np.sqrt(variances), radiance.usable & empty.usable)


def _changed(pair: _Pair) -> np.ndarray:
    """(h, w) what is not as in the background; where only the photograph is saturated, too."""
    squares = np.where(pair.usable, ((pair.shown - pair.empty) / pair.deviations) ** 2, 0).sum(axis=2)
    counts = pair.usable.sum(axis=2).astype(np.float32)
    mean = _mean(squares) / np.maximum(_mean(counts), 1e-3)
    return np.asarray((mean > _DIFFERS) | (counts == 0))


def _mean(picture: np.ndarray, side: int = 3) -> np.ndarray:
    cv2 = opencv()
    return np.asarray(cv2.blur(np.asarray(picture, np.float32), (side, side)))


def _check_light(where: str, pair: _Pair, changed: np.ndarray) -> None:
    """Raise InputError unless enough of the photograph is as bright as in the background."""
    factors = _factors(pair)
    same = 1 - changed.mean() if factors.size < 100 else float((np.abs(factors) < _ALIKE).mean())
    if same >= _LEAST_SAME:
        return
    if factors.size:
        counts, edges = np.histogram(factors, np.arange(-6, 6, _ALIKE))
        usual = float(edges[counts.argmax()] + _ALIKE / 2)
        alike = np.abs(factors - usual) < 2 * _ALIKE
        if alike.mean() > 3 * _LEAST_SAME:
            usual = float(np.median(factors[alike]))
            raise InputError(
                f"{where}: the photograph is {np.exp(usual):.2f} times as bright all over; allowed is the same "
                "exposure, or one that is stated right"
            )
    raise InputError(
        f"{where}: {same:.0%} of it is as bright as in the photograph, allowed is {_LEAST_SAME:.0%} or more: the "
        "background has to be lit by the same lights, and seen from the same place"
    )


def _factors(pair: _Pair) -> np.ndarray:
    """(n,) logarithms of how many times as bright the photograph is, of blocks that are bright in the background."""
    high, wide = (side // _BLOCK * _BLOCK for side in pair.shown.shape[:2])

    def blocks(picture: np.ndarray) -> np.ndarray:
        cut = picture[:high, :wide].mean(axis=2, dtype=np.float32)
        return np.asarray(cut.reshape(high // _BLOCK, _BLOCK, wide // _BLOCK, _BLOCK).mean(axis=(1, 3)))

    shown, empty, noise = blocks(pair.shown), blocks(pair.empty), blocks(pair.deviations) / _BLOCK
    bright = (empty > _LIT * noise) & (blocks(pair.usable) == 1) & (shown > 0)
    return np.asarray(np.log(shown[bright] / empty[bright]))


def _told(pair: _Pair, changed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(h, w) each: what is surely the background, as it was or in another light, and what is surely the body."""
    shown, empty = (np.asarray(each @ _LUMINANCE) for each in (pair.shown, pair.empty))
    noise = np.asarray(np.sqrt((pair.deviations**2) @ _LUMINANCE**2))
    means = [_mean(each, _WINDOW) for each in (shown, empty)]
    squares = [_mean(each**2, _WINDOW) for each in (shown, empty)]
    spread = [np.maximum(square - mean**2, 0) for square, mean in zip(squares, means, strict=True)]
    common = _mean(shown * empty, _WINDOW) - means[0] * means[1]
    alike = common / np.sqrt(np.maximum(spread[0] * spread[1], 1e-30))
    patterned = spread[1] > (_PATTERNED * _mean(noise, _WINDOW)) ** 2
    # Of a shadow so deep that noise hides the pattern nothing is left but darkness.
    dark = np.sqrt(spread[0]) < 2 * _mean(noise, _WINDOW)
    board = patterned & ((alike > _FITS) & (means[0] < _BRIGHTENED * means[1]) | dark & (means[0] < 0.1 * means[1]))
    brighter = (pair.shown - _BRIGHTENED * pair.empty) > _SURE * pair.deviations
    shares = pair.shown / np.maximum(pair.empty, 1e-12)
    unsure = pair.deviations / np.maximum(pair.empty, 1e-12)
    tinted = np.ptp(shares, axis=2) > np.maximum(_SURE * unsure.max(axis=2), 0.3)
    body = changed & ~board & (brighter.any(axis=2) | tinted | (patterned & ~dark & (np.abs(alike) < _UNLIKE)))
    body |= changed & ~pair.usable.any(axis=2)
    shaded = _mean(shares.max(axis=2)) < _SHADED
    return ~changed | board | (shaded & ~body), body


def _grown(pair: _Pair, board: np.ndarray, body: np.ndarray) -> np.ndarray:
    """(h, w) the largest piece of the body, what neither tells divided along the photograph's edges; holes filled."""
    cv2 = opencv()
    near = np.ones((3, 3), np.uint8)
    small, disc = (cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (side, side)) for side in (_SMALL, _JOINED))
    sure = cv2.morphologyEx(body.astype(np.uint8), cv2.MORPH_OPEN, near)
    joined = _largest(cv2.morphologyEx(sure, cv2.MORPH_CLOSE, disc) > 0)
    sure = joined & (sure > 0)
    around = cv2.erode(cv2.morphologyEx((board & ~sure).astype(np.uint8), cv2.MORPH_OPEN, small), near)
    markers = np.where(sure, 2, np.where(around > 0, 1, 0)).astype(np.int32)
    white = float(np.quantile(pair.shown, 0.99)) or 1.0
    picture: Any = np.round(255 * np.sqrt(np.clip(pair.shown / white, 0, 1))).astype(np.uint8)
    found = cv2.watershed(np.ascontiguousarray(picture), markers) == 2
    found = cv2.morphologyEx(found.astype(np.uint8), cv2.MORPH_OPEN, small)
    return np.asarray(ndimage.binary_fill_holes(_largest(found > 0)))


def _largest(picture: np.ndarray) -> np.ndarray:
    """The largest of the pieces that hang together; nothing where there is none."""
    labels, count = ndimage.label(picture)
    if not count:
        return picture
    sizes = np.bincount(labels.ravel())
    sizes[0] = 0
    return np.asarray(labels == sizes.argmax())
