"""Cases of studies as tasks: each by its study and its name or seed."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from quadgraph.base.cache_folder import cache_folder
from quadgraph.work.finished_tasks import LEDGER
from quadgraph.work.schedulers import Scheduler
from quadgraph.work.task import Task
from quadgraph.work.task_run import run_tasks
from quadgraph_validation.accuracy import unseen_study
from quadgraph_validation.accuracy.kept_rows import KeptRows, Row
from quadgraph_validation.accuracy.unseen_study import UnseenRun


def named(study: str, wanted: Any, scheduler: Scheduler) -> Callable[[Sequence[str]], list[Row]]:
    """What makes the rows of cases by their names, of a study by its module and what is wanted of it."""

    def make(names: Sequence[str]) -> list[Row]:
        return run_tasks([row_task(study, wanted, name) for name in names], scheduler, cache_folder() / LEDGER)

    return make


def row_task(study: str, wanted: Any, name: str, reads: tuple[Path, ...] = ()) -> Task:
    """The task of one case. reads: files that are made before."""
    asked = replace(wanted, seed=int(name), count=1) if name.isdigit() else wanted  # whatever else is asked for
    given = {"study": study, "run": type(asked).__name__, "wanted": asdict(asked), "name": name}
    return Task(f"{study} {name}", f"{__name__}:named_row", given, reads)


def named_row(study: str, run: str, wanted: Mapping[str, Any], name: str) -> Row:
    """The row of one case of a study."""
    module = importlib.import_module(f"quadgraph_validation.accuracy.{study}_study")
    asked = {key: tuple(value) if isinstance(value, list) else value for key, value in wanted.items()}
    record = module.run(getattr(module, run)(**asked), KeptRows(only=[name]))
    return next(row for row in record["rows"] if row["name"] == name)


def unseen(wanted: UnseenRun, scheduler: Scheduler) -> dict[str, Any]:
    """The record of `unseen_study.run`, its cases spread over workers. Raises InputError, and ToolError for cases that
    failed.
    """
    unseen_study.check(wanted)
    case = replace(wanted, count=1, truths=wanted.truths.absolute(), sweeps=list(wanted.sweeps))
    given = asdict(case) | {"truths": str(case.truths)}
    function = f"{__name__}:unseen_row"
    seeds = range(wanted.seed, wanted.seed + wanted.count)
    tasks = [Task(f"unseen {seed}", function, {"wanted": given | {"seed": seed}}) for seed in seeds]
    return unseen_study.record_of(wanted, run_tasks(tasks, scheduler, case.truths / LEDGER))


def unseen_row(wanted: Mapping[str, Any]) -> Row:
    """The row of one unseen case. wanted: members of UnseenRun."""
    case = UnseenRun(**{**wanted, "truths": Path(wanted["truths"])})
    return unseen_study.judged(case.seed, case, _say_nothing)


def _say_nothing(what: str, walks: int) -> None:
    """Nobody reads along where a task runs."""
