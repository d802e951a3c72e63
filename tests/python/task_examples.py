"""Functions for tasks of tests, and a program that runs some; they note what they do in a file."""

from __future__ import annotations

import os
import signal
import sys
import time
from pathlib import Path

from quadgraph.base import atomic_file, program
from quadgraph.base.errors import InputError
from quadgraph.work.schedulers import Scheduler
from quadgraph.work.task import Task
from quadgraph.work.task_run import run_tasks


def noted(number: int, folder: str, seconds: float = 0.0) -> dict[str, float]:
    """Note the start and this process, take time, and write a file."""
    with (Path(folder) / "log").open("a") as log:
        log.write(f"{number} {os.getpid()}\n")
    time.sleep(seconds)
    with atomic_file.replacing(Path(folder) / f"{number}.txt") as stream:
        stream.write(str(number).encode())
    return {"third": number / 3}


def killed_at_first(marker: str) -> str:
    """Be killed, as by the system, unless that was so before."""
    path = Path(marker)
    if not path.exists():
        path.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return "survived"


def greedy(size: int) -> int:
    """Hold so many bytes until somebody ends it."""
    held = b"\1" * size
    time.sleep(600)
    return len(held)


def torn(name: str) -> None:
    """Fail, as what a user gives may."""
    raise InputError(f"{name}: is torn")


def notes(folder: Path, count: int, seconds: float = 0.0, reads: tuple[Path, ...] = ()) -> list[Task]:
    """Tasks of `noted`."""
    return [
        Task(
            f"note-of {number}",
            "task_examples:noted",
            {"number": number, "folder": str(folder), "seconds": seconds},
            reads,
            (folder / f"{number}.txt",),
        )
        for number in range(count)
    ]


def starts(folder: Path) -> list[tuple[int, int]]:
    """The numbers that were begun, with their processes."""
    log = folder / "log"
    lines = log.read_text().splitlines() if log.exists() else []
    return [(int(number), int(process)) for number, process in map(str.split, lines)]


if __name__ == "__main__":
    FOLDER = Path(sys.argv[1])
    ASKED = notes(FOLDER, int(sys.argv[2]), float(sys.argv[3]))
    sys.exit(program.ended(lambda: len(run_tasks(ASKED, Scheduler("processes", 2), FOLDER / "ledger")) - len(ASKED)))
