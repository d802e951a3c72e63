"""Photographs through a lens with distortion as cameras of scene files see them: a turn of the rays about the eye."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from scipy import sparse

from quadgraph.acquisition.cameras.lens import Lens, PinholeView, Pose
from quadgraph.acquisition.capture.radiance import Radiance

_MOST_SAMPLES = 32  # along a side of a pixel
_AT_ONCE = 1 << 20  # rays
_STEPS, _AROUND = 64, 4.0  # of the search for the part that a view shows, and pixels around it


def resampled(radiance: Radiance, kept: np.ndarray | None, lens: Lens, pose: Pose, view: PinholeView) -> Radiance:
    """The picture of a view from the same eye: in each pixel the mean of rays as dense as the photograph's pixels.

    kept: (h, w), what a mask keeps. A pixel is usable where all that it is made of is. Variances are those of the mean,
    of pixels of the photograph that are independent; those of neighbours in the picture are not.
    """
    samples = samples_of(lens, view)
    rows, columns = _part(lens, pose, view)
    usable = radiance.usable[rows, columns]
    if kept is not None:
        usable = usable & kept[rows, columns, None]
    unusable = (~usable).reshape(-1, 3).astype(np.float32)
    values, variances = (each[rows, columns].reshape(-1, 3) for each in (radiance.values, radiance.variances))
    height, width, _ = usable.shape
    lens = replace(lens, width=width, height=height, cx=lens.cx - columns.start, cy=lens.cy - rows.start)
    at_once = max(_AT_ONCE // (view.width * samples**2), 1)
    parts = []
    for first in range(0, view.height, at_once):
        last = min(first + at_once, view.height)
        weights, inside = _weights(lens, pose, view, (first, last), samples)
        spoilt = (weights @ unusable) > 0
        squared = weights.multiply(weights).tocsr()
        parts.append((weights @ values, squared @ variances, ~spoilt & inside[:, None]))
    shape = (view.height, view.width, 3)
    found, spread, fine = (np.concatenate(each).reshape(shape) for each in zip(*parts, strict=True))
    return Radiance(np.where(fine, found, 0).astype(np.float32), np.where(fine, spread, 1).astype(np.float32), fine)


def _part(lens: Lens, pose: Pose, view: PinholeView) -> tuple[slice, slice]:
    """Rows and columns of the photograph that the view shows a part of, of which there is at least a pixel."""
    steps = [np.linspace(0, side, min(side, _STEPS) + 1) for side in (view.width, view.height)]
    at, seen = shown_at(lens, pose, view, np.stack(np.meshgrid(*steps), axis=-1).reshape(-1, 2))
    if not seen.any():
        return slice(0, 1), slice(0, 1)
    low, high = at[seen].min(axis=0), at[seen].max(axis=0)
    between = (high - low) / _STEPS + _AROUND
    sides = []
    for axis, side in ((1, lens.height), (0, lens.width)):
        first = int(np.clip(low[axis] - between[axis], 0, side - 1))
        sides.append(slice(first, int(np.clip(high[axis] + between[axis], first + 1, side))))
    return sides[0], sides[1]


def samples_of(lens: Lens, view: PinholeView) -> int:
    """Rays along a side of a view's pixel."""
    across = max(lens.fx, lens.fy) / view.lens.fy
    return min(max(math.ceil(across - 1e-6), 1), _MOST_SAMPLES)


def _weights(
    lens: Lens, pose: Pose, view: PinholeView, rows: tuple[int, int], samples: int
) -> tuple[sparse.csr_matrix, np.ndarray]:
    """The matrix from the photograph's pixels to those of rows of the view, and which of them lie within."""
    steps = (np.arange(samples) + 0.5) / samples
    down = (np.arange(*rows)[:, None] + steps).ravel()
    across = (np.arange(view.width)[:, None] + steps).ravel()
    places = np.stack(np.meshgrid(across, down), axis=-1).reshape(-1, 2)
    count = (rows[1] - rows[0]) * view.width
    target = (places[:, 1] - rows[0]).astype(np.int64) * view.width + places[:, 0].astype(np.int64)
    at, seen = shown_at(lens, pose, view, places)
    corner = at - 0.5
    low = np.floor(corner)
    seen &= (low >= 0).all(axis=1) & (low[:, 0] < lens.width - 1) & (low[:, 1] < lens.height - 1)
    low = np.where(seen[:, None], low, 0)
    share = np.where(seen[:, None], corner - low, 0)
    columns, weights = [], []
    for y in (0, 1):
        for x in (0, 1):
            columns.append((low[:, 1].astype(np.int64) + y) * lens.width + low[:, 0].astype(np.int64) + x)
            weights.append(np.abs(1 - x - share[:, 0]) * np.abs(1 - y - share[:, 1]) * seen / samples**2)
    shape = (count, lens.width * lens.height)
    entries = (np.concatenate(weights), (np.tile(target, 4), np.concatenate(columns)))
    matrix = sparse.csr_matrix(entries, shape=shape)  # what meets in one place is added
    outside = np.bincount(target, ~seen, minlength=count) > 0
    return matrix, ~outside


def shown_at(lens: Lens, pose: Pose, view: PinholeView, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where the photograph shows what a view shows at places (n, 2), pixels, and whether the lens shows it at all."""
    slopes = view.lens.slopes(places)
    rays = np.concatenate([slopes, np.ones((len(slopes), 1))], axis=1) @ view.axes() @ pose.rotation.T
    before = rays[:, 2] > 1e-9
    slopes = rays[:, :2] / np.where(before, rays[:, 2], 1)[:, None]
    before &= np.linalg.norm(slopes, axis=1) < lens.widest_slope()
    return lens.places(np.where(before[:, None], slopes, 0)), before
