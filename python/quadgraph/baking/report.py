"""What a bake did, as it is told to users and programs."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from typing import Any


@dataclass
class BakeReport:
    """What a bake did. Times in s; of levels, `seconds` per step; memory in bytes, children apart.

    exchange: what faces see of each other, as `exchange.summary` tells; None if left out. budget: what was measured and
    chosen for an error that was asked for (`quadgraph.baking.budget.plan`). interior: what the
    inner tets are sized by (`quadgraph.baking.inside.metadata`), None of polygrids. polygrid: how good it is
    (`quadgraph.tets.polygrid.grid_report`), None of other meshers. normals: what those of the displayed surface are
    (`quadgraph.mesh.looks.file_normals.FoundNormals`), None of several bodies.
    """

    output: str
    byte_size: int = 0
    source: dict[str, Any] = field(default_factory=dict)
    unit_mm: float = 0.0
    repairs: list[dict[str, Any]] = field(default_factory=list)
    levels: list[dict[str, Any]] = field(default_factory=list)
    exchange: dict[str, Any] | None = None
    budget: dict[str, Any] | None = None
    interior: dict[str, Any] | None = None
    polygrid: dict[str, Any] | None = None
    normals: dict[str, Any] | None = None
    notes: list[str] = field(default_factory=list)
    seconds: dict[str, float] = field(default_factory=dict)
    peak_memory: dict[str, int] = field(default_factory=dict)

    def as_dict(self) -> dict[str, Any]:
        """Everything, ready for JSON."""
        return asdict(self)

    @contextmanager
    def timed(self, stage: str) -> Iterator[None]:
        """Book the time of the block under `stage`."""
        start = time.perf_counter()
        yield
        self.seconds[stage] = self.seconds.get(stage, 0.0) + time.perf_counter() - start
