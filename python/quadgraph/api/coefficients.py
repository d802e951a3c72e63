"""Coefficients as a function of position: called, checked, and sampled on a grid."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from quadgraph import core
from quadgraph.api.values import Floats, Vector, numbers, single
from quadgraph.base.errors import InputError

Coefficients: TypeAlias = Callable[[Floats], tuple[npt.ArrayLike, npt.ArrayLike]]
Box: TypeAlias = Sequence[Vector] | npt.NDArray[np.floating[Any]]  # the lowest and the highest corner, mm

MOST_CELLS = (1 << 25) // 3  # of a grid: what the engine reads of a .npz, three numbers a cell (docs/limits.md)


def coefficients_at(function: Coefficients, points: Floats) -> tuple[Floats, Floats]:
    """Return sigma_s_prime and sigma_a of a function at points (n, 3), mm, as (n, 3) each, 1/mm.

    Each may be one number, (n,), (n, 3), or (3,) for all points. Raises InputError saying which is not, and where.
    """
    found = function(points)
    try:
        scattering, absorption = found
    except (TypeError, ValueError) as error:
        raise InputError(
            f"the function of coefficients: {_what(found)} found, two are wanted: sigma_s_prime, sigma_a"
        ) from error
    return _checked("sigma_s_prime", scattering, points), _checked("sigma_a", absorption, points)


def grid_of(function: Coefficients, box: Box, spacing: float | Vector) -> tuple[Floats, Floats]:
    """Return a function's coefficients as (nz, ny, nx, 3) each, at points `spacing` mm apart.

    The first lies at the box's lowest corner, the last at or beyond its highest. Raises InputError.
    """
    (low, high), steps = _corners(box), _steps(spacing)
    extent = high - low
    # A rounding error of the box's size is no reason for another layer.
    counts = np.maximum(np.ceil(extent / steps - 1e-6), 0) + 1
    if math.prod(counts.tolist()) > MOST_CELLS:
        wide = extent[extent > 0].tolist()
        least = (math.prod(wide) / MOST_CELLS) ** (1 / len(wide))
        size = " x ".join(f"{count:.6g}" for count in counts)
        raise InputError(
            f"spacing: {_listed(steps)} mm makes {size} cells in the box, at most {MOST_CELLS:,} are allowed: "
            f"take more, about {1.05 * least:.3g} mm"
        )
    axes = [first + step * np.arange(int(count)) for first, step, count in zip(low, steps, counts, strict=True)]
    z, y, x = np.meshgrid(axes[2], axes[1], axes[0], indexing="ij")
    points = np.stack([x, y, z], axis=-1).astype(np.float32)
    scattering, absorption = coefficients_at(function, points.reshape(-1, 3))
    return scattering.reshape(points.shape), absorption.reshape(points.shape)


def _checked(name: str, values: npt.ArrayLike, points: Floats) -> Floats:
    """Values of a function at points as (n, 3) float32. Raises InputError."""
    where, n = f"{name} of the function", len(points)
    array = numbers(where, values, "numbers are wanted")
    try:
        array = np.broadcast_to(array[:, None] if array.shape == (n,) else array, points.shape)
    except ValueError as error:
        wanted = f"one number, ({n},), ({n}, 3) or (3,) is wanted for {n} points"
        raise InputError(f"{where}: shape {array.shape} found; {wanted}") from error
    found = single(array)
    wrong = ~((found >= 0) & (found <= core.COEFFICIENT_MAX))
    if wrong.any():
        row, channel = np.argwhere(wrong)[0]
        raise InputError(
            f"{where}: {array[row, channel]} found at {_listed(points[row])} mm, allowed are 0 to 1e6 (1/mm)"
        )
    return found


def _corners(box: Box) -> npt.NDArray[np.float64]:
    """The corners of a box, (2, 3) mm. Raises InputError."""
    corners = numbers("box", box, "the lowest and the highest corner are wanted (mm)").astype(np.float64)
    if corners.shape != (2, 3):
        raise InputError(f"box: shape {corners.shape} found, (2, 3) is wanted: lowest and highest corner (mm)")
    if not (np.isfinite(single(corners)).all() and (corners[0] <= corners[1]).all()):
        raise InputError(
            f"box: {_listed(corners[0])} to {_listed(corners[1])} mm found, finite corners are wanted, the lowest first"
        )
    return corners


def _steps(spacing: float | Vector) -> npt.NDArray[np.float64]:
    """The spacing along x, y, z, mm. Raises InputError."""
    steps = numbers("spacing", spacing, "one number or three are wanted (mm)").astype(np.float64)
    if steps.shape not in ((), (3,)) or not (np.isfinite(steps).all() and (steps > 0).all()):
        raise InputError(f"spacing: {spacing} found, one number or three above 0 (mm) allowed")
    return np.broadcast_to(steps, 3)


def _listed(found: npt.NDArray[Any]) -> str:
    return "(" + ", ".join(f"{number:.6g}" for number in found) + ")"


def _what(found: object) -> str:
    if isinstance(found, tuple | list):
        return f"{len(found)} values"
    return "nothing" if found is None else type(found).__name__
