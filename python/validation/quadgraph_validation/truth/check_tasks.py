"""Cross-checks as tasks: of the sphere some batches of our walks each, and pmmc's; each slab."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from quadgraph.work.finished_tasks import LEDGER
from quadgraph.work.schedulers import Scheduler
from quadgraph.work.task import Task
from quadgraph.work.task_run import run_tasks
from quadgraph_validation.bodies.scenes import SCENES
from quadgraph_validation.truth import cross_checks, walk_truth
from quadgraph_validation.truth.cross_checks import CheckRow
from quadgraph_validation.truth.monte_carlo import Estimate

_BATCHES = 10  # of our walks through the sphere, in a task


def rows(
    chosen: Sequence[str], walks: int, folder: Path, pictures: Path, pmmc: bool, scheduler: Scheduler
) -> list[CheckRow]:
    """What `cross_checks.rows` says, bit for bit, its walks spread over workers. Raises InputError, and ToolError for
    walks that failed.
    """
    folder = folder.absolute()
    ours = _our_walks(walks, folder) if "sphere" in chosen else []
    asked = pmmc and "sphere" in chosen
    theirs = [Task("walks sphere, pmmc", f"{__name__}:by_pmmc", {"walks": walks})] if asked else []
    slabs = _slabs(walks, pmmc) if "slab" in chosen else []
    values = iter(run_tasks([*ours, *theirs, *slabs], scheduler, folder / LEDGER))
    found = []
    if "sphere" in chosen:
        walk_truth.extend(SCENES["sphere"], folder, [next(values) for _ in ours])
        exitance = [_estimate(*next(values)) for _ in theirs]
        found += cross_checks.sphere(walks, folder, pictures, Console(quiet=True), *exitance)
    for task, value in zip(slabs, values, strict=True):
        given = [task.arguments[name] for name in ("name", "channel", "eta")]
        found += cross_checks.slab(*given, *(_estimate(*each) for each in value))
    return found


def _our_walks(walks: int, folder: Path) -> list[Task]:
    """What is missing of those through the sphere, cut at the same places however many are asked for."""
    first, goal = walk_truth.stored(SCENES["sphere"], folder).batches, walk_truth.batches_of(walks)
    tasks = []
    while first < goal:
        end = min(goal, (first // _BATCHES + 1) * _BATCHES)
        name = f"walks sphere, to {end * walk_truth.BATCH:,}"
        tasks.append(Task(name, f"{__name__}:walked", {"first": first, "count": end - first}))
        first = end
    return tasks


def _slabs(walks: int, pmmc: bool) -> list[Task]:
    tasks = []
    for name, channel, eta in cross_checks.SLABS:
        given = {"name": name, "channel": channel, "eta": eta, "walks": walks, "pmmc": pmmc}
        title = cross_checks.title_of(name, channel, eta)
        tasks.append(Task(f"walks {title}", f"{__name__}:slab_walks", given))
    return tasks


def walked(first: int, count: int) -> dict[str, Any]:
    """Some batches of our walks through the sphere."""
    return walk_truth.counts(SCENES["sphere"], first, count)


def by_pmmc(walks: int) -> list[list[float]]:
    """pmmc's exitance of the sphere's zones, and its standard errors."""
    return _members(cross_checks.sphere_by_pmmc(walks))


def slab_walks(name: str, channel: int, eta: float, walks: int, pmmc: bool) -> list[list[list[float]]]:
    """What our walks find of a slab and, if asked for, pmmc's."""
    return [_members(found) for found in cross_checks.slab_walks(name, channel, eta, walks, pmmc)]


def _members(found: Estimate) -> list[list[float]]:
    return [found.mean.tolist(), found.error.tolist()]


def _estimate(mean: list[float], error: list[float]) -> Estimate:
    return Estimate(np.array(mean), np.array(error))
