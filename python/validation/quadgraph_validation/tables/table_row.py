"""A row of a table, and what all rows are measured with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quadgraph.base.progress import ProgressCallback
from quadgraph_validation.tables.table_bodies import Store

_FEWEST = 200  # surface nodes


@dataclass(frozen=True)
class Setting:
    """What all rows share. scale: of the paper's numbers of surface nodes; pixels: edge of a frame's picture; truth:
    folder of path-traced pictures.
    """

    scale: float
    repeats: int
    pixels: int
    device: str
    store: Store
    truth: Path

    def nodes(self, full: int) -> int:
        """How many there are of what is so many at scale 1."""
        return max(_FEWEST, round(self.scale * full))

    @property
    def key(self) -> dict[str, Any]:
        """What the rows of one record have in common."""
        return {"scale": self.scale, "repeats": self.repeats, "pixels": self.pixels}


@dataclass(frozen=True)
class Row:
    """key: unique in its table; body: what it is about; missing: what it needs and is not there, "" if nothing;
    measure: it, telling its progress, to what JSON can hold.
    """

    key: str
    body: str
    missing: str
    measure: Callable[[ProgressCallback], dict[str, Any]]
