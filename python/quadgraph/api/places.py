"""Places and triples of numbers that callers give, checked."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from quadgraph.api.values import Floats, numbers, single
from quadgraph.base.errors import InputError


def triple(name: str, values: Sequence[float]) -> tuple[float, float, float]:
    """Three numbers. Raises InputError."""
    found = numbers(name, values, "three numbers are wanted").astype(float)
    if found.shape != (3,) or not np.isfinite(found).all():
        raise InputError(f"{name}: {found.tolist()} found, three finite numbers are wanted")
    x, y, z = map(float, found)
    return x, y, z


def as_points(points: npt.ArrayLike) -> Floats:
    """Points, mm, as float32. Raises InputError."""
    places = single(numbers("points", points, "(n, 3) or (..., 3) is wanted (mm)"))
    if places.ndim < 1 or places.shape[-1] != 3:
        raise InputError(f"points: shape {places.shape} found, (n, 3) or (..., 3) is wanted (mm)")
    return places
