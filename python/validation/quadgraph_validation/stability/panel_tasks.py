"""Panels of maps as tasks: a map and a method each."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from quadgraph.work.finished_tasks import LEDGER
from quadgraph.work.schedulers import Scheduler
from quadgraph.work.task import Task
from quadgraph.work.task_run import run_tasks
from quadgraph_validation.stability import stability_suite
from quadgraph_validation.stability.stability_maps import Map, StabilitySetting
from quadgraph_validation.stability.stability_methods import chosen


def run(
    maps: Sequence[Map], thin: int | None, methods: Sequence[str], setting: StabilitySetting, scheduler: Scheduler
) -> dict[str, Any]:
    """The record of `stability_suite.run`, its panels spread over workers. thin: as the maps were thinned, None: not.

    Raises ToolError for panels that failed.
    """
    if setting.kept is None:
        raise ValueError("true solutions are kept where workers find them")
    kept = setting.kept.absolute()
    given = {"thin": thin, "device": setting.device, "kept": str(kept)}
    wanted = {each.name: [method.name for method in chosen(each.methods, list(methods))] for each in maps}
    tasks = [
        Task(f"{name}, {method}", f"{__name__}:panel", given | {"name": name, "method": method})
        for name, of_map in wanted.items()
        for method in of_map
    ]
    rows = iter(run_tasks(tasks, scheduler, kept / LEDGER))
    return stability_suite.record_of(
        [
            stability_suite.described(each) | {"panels": {method: next(rows) for method in wanted[each.name]}}
            for each in maps
        ]
    )


def panel(name: str, method: str, thin: int | None, device: str, kept: str) -> list[list[dict[str, Any]]]:
    """The points of one panel, row by row."""
    (found,) = (each for each in stability_suite.MAPS if each.name == name)
    found = found.thinned(thin) if thin else found
    (one,) = chosen(found.methods, [method])
    case_of = found.cases(StabilitySetting(device, Path(kept)), found.x.values, found.y.values)
    return stability_suite.panel(found, one, case_of)
