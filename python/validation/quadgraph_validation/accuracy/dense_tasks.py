"""The study of dense balls as tasks: the balls, each baked once, then what is solved of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import asdict, replace
from pathlib import Path

from quadgraph.base.cache_folder import cache_folder
from quadgraph.work.finished_tasks import LEDGER
from quadgraph.work.schedulers import Scheduler, StayingWorkers
from quadgraph.work.task import Task
from quadgraph.work.task_run import run_tasks
from quadgraph_validation.accuracy import dense_study, row_tasks
from quadgraph_validation.accuracy.dense_study import CASES, DenseBall, DenseRun
from quadgraph_validation.accuracy.kept_rows import Row


def named(wanted: DenseRun, scheduler: Scheduler) -> Callable[[Sequence[str]], list[Row]]:
    """What makes the rows of materials by their names; balls are kept in the cache folder."""
    ledger, folder = cache_folder() / LEDGER, cache_folder().absolute() / "dense"

    def make(names: Sequence[str]) -> list[Row]:
        asked = replace(wanted, baked=str(folder))
        chosen = {material: _bakes(ball, folder) for material, ball in CASES if material in names}
        bakes = {task.name: task for tasks in chosen.values() for task in tasks}
        with ExitStack() as until:
            workers = StayingWorkers(scheduler, until)
            run_tasks(list(bakes.values()), workers, ledger)
            rows = []
            for material, tasks in chosen.items():
                files = tuple(path for task in tasks for path in task.writes)
                rows.append(row_tasks.row_task("dense", asked, material, files))
            return run_tasks(rows, workers, ledger)

    return make


def _bakes(ball: DenseBall, folder: Path) -> list[Task]:
    """Of the ball, and of the finer one."""
    tasks = []
    for finer in (False, True):
        name = f"dense ball of {ball.radius:g} mm{', finer' if finer else ''}"
        given = {"ball": asdict(ball), "finer": finer, "folder": str(folder)}
        tasks.append(Task(name, f"{__name__}:baked", given, (), (dense_study.file_of(ball, finer, folder),)))
    return tasks


def baked(ball: dict[str, int], finer: bool, folder: str) -> None:
    """Bake a ball, or the finer one, into a folder."""
    Path(folder).mkdir(parents=True, exist_ok=True)
    dense_study.bake_ball(DenseBall(**ball), finer, Path(folder))
