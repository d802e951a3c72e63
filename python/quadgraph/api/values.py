"""What lights and deformers share: frozen values with the members that scene files give them (docs/scene.md)."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, ClassVar, TypeAlias

import numpy as np
import numpy.typing as npt

from quadgraph.api.reprs import members_text
from quadgraph.base.array_types import Doubles as Doubles
from quadgraph.base.array_types import Floats as Floats
from quadgraph.base.errors import InputError

Vector: TypeAlias = Sequence[float] | npt.NDArray[np.floating[Any]]  # x, y, z
RGB: TypeAlias = float | Vector  # one number for all channels, or red, green, blue


def plain(value: object) -> Any:
    """Arrays and sequences as tuples, NumPy's numbers as Python's, paths as texts, also in mappings: comparable, and
    ready for JSON.
    """
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, list | tuple):
        return tuple(plain(item) for item in value)
    return plain_members(value) if isinstance(value, Mapping) else value


def numbers(name: str, value: object, wanted: str) -> npt.NDArray[Any]:
    """An array of real numbers. Raises InputError that names the value, what was found and what is `wanted`."""
    try:
        array = np.asarray(value)
    except ValueError as error:
        raise InputError(f"{name}: rows of several lengths found, {wanted}") from error
    if array.dtype.kind not in "fiub":
        found = "text" if array.dtype.kind in "SU" else "no number" if array.dtype.kind == "O" else array.dtype
        raise InputError(f"{name}: {found} found, {wanted}")
    return array


def single(values: npt.NDArray[Any]) -> Floats:
    """Numbers in single precision, infinite where they are beyond it."""
    with np.errstate(over="ignore"):
        return values.astype(np.float32)


def plain_members(members: Mapping[str, Any]) -> dict[str, Any]:
    """Return an object of a scene file with plain values."""
    return {name: plain(value) for name, value in members.items()}


@dataclass(frozen=True, repr=False)
class Value:
    """A value of one `type`; members that are None are left to the engine."""

    type: ClassVar[str]

    def __post_init__(self) -> None:
        """Make members plain."""
        for each in fields(self):
            object.__setattr__(self, each.name, plain(getattr(self, each.name)))

    def __repr__(self) -> str:
        """Return name and members in one line, with their units."""
        return members_text(self)

    def to_dict(self) -> dict[str, Any]:
        """Return the object that a scene file has for it: `type` and the members that are not None."""
        members = {each.name: getattr(self, each.name) for each in fields(self)}
        return {"type": self.type} | {name: value for name, value in members.items() if value is not None}
