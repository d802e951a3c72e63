"""Many tasks, from what is finished already to the values of all."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import Any, Protocol

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from quadgraph.base.errors import ToolError
from quadgraph.work import finished_tasks
from quadgraph.work.schedulers import Scheduler, StayingWorkers
from quadgraph.work.task import Task, key_of

_SAID = 3  # failures that an error repeats
_AGAIN = "what is finished is kept, and the same command goes on from there"


class Progressing(Protocol):
    """Who is told how tasks come along."""

    def say(self, text: str) -> None:
        """What workers do, a line."""

    def advance(self, text: str) -> None:
        """One more task is finished, and what is to be said of it."""


def run_tasks(
    tasks: Sequence[Task], scheduler: Scheduler | StayingWorkers, ledger: Path, told: Progressing | None = None
) -> list[Any]:
    """The values of tasks in their order; those that `ledger` has are not run again.

    told: of progress, None: standard error. All others are finished where one fails. Raises ToolError, naming those
    that failed, and what starting workers raises.
    """
    contents = [task.content() for task in tasks]
    keys = [key_of(content) for content in contents]
    found = [finished_tasks.find(ledger, task, content) for task, content in zip(tasks, contents, strict=True)]
    values = {key: one.value for key, one in zip(keys, found, strict=True) if one is not None}
    orders = {key: task.order(ledger) for key, task in zip(keys, tasks, strict=True) if key not in values}
    names = {key: task.name for key, task in zip(keys, tasks, strict=True)}
    failures: list[str] = []
    with nullcontext(told) if told else _told(len(names), len(values)) as progress:
        if told:
            for key in values:
                told.advance(f"{names[key]}: finished already")
        if orders:
            try:
                values |= _made(orders, names, scheduler, progress, failures)
            except KeyboardInterrupt:
                progress.say(f"interrupted; {_AGAIN}")
                raise
    if failures:
        said = "; ".join(failures[:_SAID]) + ("; ..." if len(failures) > _SAID else "")
        raise ToolError(f"{len(failures)} of {len(names)} failed: {said}")
    return [values[key] for key in keys]


def _made(
    orders: dict[str, str],
    names: dict[str, str],
    scheduler: Scheduler | StayingWorkers,
    progress: Progressing,
    failures: list[str],
) -> dict[str, Any]:
    values = {}
    with scheduler.workers(progress.say) as workers:
        try:
            for key, outcome in workers.outcomes(orders):
                if "error" in outcome:
                    failures.append(_failure(names[key], str(outcome["error"])))
                else:
                    values[key] = outcome["value"]
                progress.advance(f"{names[key]}: {'failed' if 'error' in outcome else 'done'}")
        except ToolError as error:
            raise ToolError(f"{error}; {_AGAIN}") from error
    return values


def _failure(name: str, error: str) -> str:
    return error if error.startswith(f"{name}: ") else f"{name}: {error}"


class TaskProgress:
    """A line for each task that is finished, above a bar with the time left where standard error is a terminal."""

    def __init__(self, shown: Progress, total: int, done: int) -> None:
        """done: of all tasks, before."""
        self._shown = shown
        self._total = total
        self._done = done
        self._bar = shown.add_task("tasks", total=total, completed=done)

    def say(self, text: str) -> None:
        """Print a line."""
        self._shown.console.print(text, markup=False, soft_wrap=True)

    def advance(self, text: str) -> None:
        """One more is finished, and what is to be said of it."""
        self._done += 1
        self._shown.update(self._bar, completed=self._done)
        self.say(f"{text} ({self._done} of {self._total})")


@contextmanager
def _told(total: int, done: int) -> Iterator[TaskProgress]:
    console = Console(stderr=True, highlight=False)
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as shown:
        progress = TaskProgress(shown, total, done)
        if done:
            progress.say(f"{done} of {total} are finished already")
        yield progress
