"""What a recovered volume says, in numbers and words."""

from __future__ import annotations

from typing import Any

import numpy as np

from quadgraph.acquisition.model.prediction import CHANNELS, NAMES
from quadgraph.acquisition.volume.volume_fit import VolumeFit

UNDETERMINED = 0.35  # standard deviation of a logarithm, from which on a coefficient is said not to be determined
_QUANTILES = (0.05, 0.5, 0.95)


def numbers(found: VolumeFit) -> dict[str, Any]:
    """All of it but the arrays, ready for JSON; coefficients in 1/mm."""
    return {
        "points": list(found.grid.size),
        "spacing": found.grid.spacing,
        "chi_squared_per_square": found.chi_squared.tolist(),
        "quantiles": list(_QUANTILES),
        "coefficients": {name: _quantiles(found, found.coefficients[row]) for row, name in enumerate(NAMES)},
        **_known(found),
        "steps": [
            {"smoothing": step.smoothing, "chi_squared_per_square": step.chi_squared.tolist()} for step in found.steps
        ],
    }


def _known(found: VolumeFit) -> dict[str, Any]:
    """How well the coefficients are known, where the scheme states it; lengths in mm."""
    if found.deviations is None or found.resolution is None:
        return {}
    return {
        "deviations_of_logarithms": {name: _quantiles(found, found.deviations[row]) for row, name in enumerate(NAMES)},
        "resolution": {name: _quantiles(found, found.resolution[row]) for row, name in enumerate(NAMES)},
        "undetermined_share": {name: _undetermined(found, row).tolist() for row, name in enumerate(NAMES)},
    }


def lines(found: VolumeFit) -> list[str]:
    """A line a coefficient, and the fit."""
    said = []
    for row, name in enumerate(NAMES):
        values = np.array(_quantiles(found, found.coefficients[row]))
        parts = [
            f"{colour} {low:.3g} to {high:.3g}, middle {middle:.3g}"
            for colour, (low, middle, high) in zip(CHANNELS, values.T, strict=True)
        ]
        if found.deviations is not None and found.resolution is not None:
            spread, length = (
                np.array(_quantiles(found, each[row]))[1] for each in (found.deviations, found.resolution)
            )
            parts = [
                f"{part} ± {100 * deviation:.0f}% over {mm:.2g} mm"
                for part, deviation, mm in zip(parts, spread, length, strict=True)
            ]
        said.append(f"{name}, 1/mm: {'; '.join(parts)}")
    chi = ", ".join(f"{each:.3g}" for each in found.chi_squared)
    return [*said, f"chi^2 per square: {chi}"]


def undetermined(found: VolumeFit) -> list[str]:
    """What the photographs leave open, in words."""
    if found.deviations is None:
        return [f"the scheme that was asked for does not say how well {NAMES[0]} and {NAMES[1]} are known"]
    said = []
    for row, name in enumerate(NAMES):
        share = float(_undetermined(found, row).max())
        if share > 0:
            said.append(
                f"{name} is not determined at {100 * share:.0f}% of the points inside: there it is what smoothing made "
                "of its surroundings"
            )
    return said


def _quantiles(found: VolumeFit, values: np.ndarray) -> list[list[float]]:
    """(3, 3) of the points inside, by channel."""
    return np.quantile(values[found.inside], _QUANTILES, axis=0).tolist()


def _undetermined(found: VolumeFit, row: int) -> np.ndarray:
    """(3,) shares of the points inside."""
    assert found.deviations is not None
    return (found.deviations[row][found.inside] > UNDETERMINED).mean(axis=0)
