"""Pairs of axes, and the points of their grids."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from quadgraph_validation.stability.judged_points import Case, judge
from quadgraph_validation.stability.stability_methods import METHODS, Method


@dataclass(frozen=True)
class Axis:
    """A name for --axis, and the values of a map with their texts."""

    name: str
    label: str
    values: tuple[float, ...]
    texts: tuple[str, ...] = ()

    def text(self, index: int) -> str:
        """A value as it stands at a map."""
        return self.texts[index] if self.texts else f"{self.values[index]:g}"

    def thinned(self, count: int) -> Axis:
        """At most `count` of the values, both ends among them."""
        last = len(self.values) - 1
        kept = sorted({round(k * last / max(count - 1, 1)) for k in range(count)})
        texts = tuple(self.texts[k] for k in kept) if self.texts else ()
        return replace(self, values=tuple(self.values[k] for k in kept), texts=texts)


@dataclass(frozen=True)
class Setting:
    """device: part of its name; kept: a folder for true solutions, None: they are found anew."""

    device: str = ""
    kept: Path | None = None


# From values of both axes to a case.
CaseOf = Callable[[float, float], Case]


@dataclass(frozen=True)
class Map:
    """A grid over two axes. cases: makes what its points share, when the map is to be run, of its setting, x and y.

    truth: what errors are against, in words.
    """

    name: str
    title: str
    truth: str
    x: Axis
    y: Axis
    cases: Callable[[Setting, Sequence[float], Sequence[float]], CaseOf]
    methods: tuple[Method, ...] = METHODS
    judge: Callable[[Case, Method], dict[str, Any]] = judge

    def thinned(self, count: int) -> Map:
        """The map with at most `count` values on either axis."""
        return replace(self, x=self.x.thinned(count), y=self.y.thinned(count))
