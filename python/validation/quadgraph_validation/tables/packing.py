"""What packed order is worth: the same bodies with nodes in breadth-first blocks and in random order, in turn."""

from __future__ import annotations

import os
from collections.abc import Iterator
from functools import partial
from statistics import median
from typing import Any

from quadgraph.base.progress import ProgressCallback
from quadgraph.core import load_core
from quadgraph_validation.benchmark.frame_passes import SOLVER_PASSES
from quadgraph_validation.tables import published, table_ways
from quadgraph_validation.tables.table_bodies import BUNNY, DONUT, TableSubject
from quadgraph_validation.tables.table_row import TableRow, TableSetting

_FACES = 280_000  # surface nodes at scale 1
_ORDERS = ("blocks", "random")
_ROUNDS = 3  # for each of the setting's: what is compared differs by less than load does
_CYCLES = 10  # of ours; only the ratio of equal work counts


def rows(setting: TableSetting) -> Iterator[TableRow]:
    """One per body."""
    for subject in (BUNNY, DONUT):
        yield TableRow(subject.name, subject.name, "", partial(_measure, subject, setting))


def _measure(subject: TableSubject, setting: TableSetting, tell: ProgressCallback) -> dict[str, Any]:
    faces = setting.nodes(_FACES)
    # Blocks are what the bake makes by default, which Figure 12 has too.
    baked = {
        order: setting.store.body(subject, faces, tell, **({} if order == "blocks" else {"order": order}))
        for order in _ORDERS
    }
    entries = {}
    # Bounces are as many as it takes: the default's work is not fixed.
    for way in (way for way in table_ways.ways(published.USUAL_ITERATIONS) if way.name != table_ways.DEFAULT):
        tell(f"{subject.name} in both orders: {way.name}")
        engines = {order: load_core().Engine(found.path, device=setting.device) for order, found in baked.items()}
        for engine in engines.values():
            engine.set_material(table_ways.MATERIAL)
            engine.set_lights([table_ways.light(0)])
        iterations = way.iterations or _CYCLES
        times: dict[str, list[float]] = {order: [] for order in _ORDERS}
        for number in range(_ROUNDS * setting.repeats + 1):
            for order, engine in engines.items():
                engine.solve(**way.budget(iterations))
                if number:  # the first assembles
                    times[order].append(_iterating(engine.passes))
        entries[way.name] = _entry(times)
    return {"body": subject.name, "load": round(os.getloadavg()[0], 2), "ways": entries} | baked["blocks"].report


def _iterating(passes: list[dict[str, Any]]) -> float:
    """Time that a solve iterates, ms."""
    return sum(entry["time_ms"] for entry in passes if entry["name"] in SOLVER_PASSES)


def _entry(times: dict[str, list[float]]) -> dict[str, Any]:
    """Medians, and the median gain over the pairs that were measured next to each other, which load disturbs least."""
    pairs = zip(times["random"], times["blocks"], strict=True)
    return {
        "ms": {order: round(median(found), 3) for order, found in times.items()},
        "gain": round(median(random / blocks for random, blocks in pairs) - 1, 4),
    }
