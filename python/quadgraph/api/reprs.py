"""What values say of themselves: one line, numbers with units."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np
import numpy.typing as npt

_MOST_SHOWN = 4  # numbers of one member; more are counted

# Units of members that are numbers, by their names; others have none, or have it in their name.
UNITS = {
    "sigma_s_prime": "1/mm",
    "sigma_a": "1/mm",
    "second_sigma_s_prime": "1/mm",
    "second_sigma_a": "1/mm",
    "period": "mm",
    "spacing": "mm",
    "origin": "mm",
    "position": "mm",
    "centre": "mm",
    "u": "mm",
    "v": "mm",
    "translate": "mm",
    "displacements": "mm",
    "cage": "mm",
    "moved": "mm",
    "irradiance": "W/mm^2",
    "radiance": "W/(mm^2 sr)",
    "power": "W",
    "angle": "degrees",
    "turn": "degrees",
}


def members_text(value: Any) -> str:
    """Name and members of a dataclass's value, those apart that are None or "none"."""
    given = ((each.name, getattr(value, each.name)) for each in fields(value))
    shown = (f"{name}={with_unit(name, found)}" for name, found in given if found is not None and found != "none")
    return f"{type(value).__name__}({', '.join(shown)})"


def with_unit(name: str, value: object) -> str:
    """A member's value, and its unit if it has one."""
    unit = UNITS.get(name)
    return f"{text(value)} {unit}" if unit else text(value)


def text(value: object) -> str:
    """A value in short: numbers with six digits, of arrays with more than four of them the shape alone."""
    if isinstance(value, float | np.floating):
        return f"{value:.6g}"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{name}: {text(each)}" for name, each in value.items()) + "}"
    if not isinstance(value, tuple | list | np.ndarray):
        return repr(value)
    if np.ndim(value[0] if len(value) else 0) == 0 and len(value) <= _MOST_SHOWN:
        return "(" + ", ".join(map(text, value)) + ")"
    try:
        return f"array of {' x '.join(map(str, np.shape(value)))}"
    except ValueError:  # rows of several lengths, which the engine will refuse
        return f"{len(value)} rows"


def channels(power: npt.NDArray[Any], unit: str) -> str:
    """Red, green and blue with four digits, once where they are the same."""
    shown = [f"{each:.4g}" for each in power]
    return f"{shown[0] if len(set(shown)) == 1 else '(' + ', '.join(shown) + ')'} {unit}"


def share(value: float) -> str:
    """A share in per cent."""
    return f"{100 * value:.2g}%"


def farthest(values: npt.NDArray[Any]) -> float:
    """Of some numbers the one that is farthest from 0."""
    return float(values[np.abs(values).argmax()])
