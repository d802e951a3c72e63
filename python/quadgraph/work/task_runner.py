"""Runs an order in a process of its own, under a memory limit, as often as somebody kills it."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from quadgraph.base import child_process

ATTEMPTS = 5  # of a task whose process is killed
_LOOKS = 0.05  # s between two looks at a process
_PATIENCE = 0.3  # s for a process to clean up
_LAST_WORDS = 300  # characters of a failed process's output that its error repeats
_ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
_THREADS = ("QUADGRAPH_THREADS", "NUMBA_NUM_THREADS")

Outcome = dict[str, Any]  # "value", or "error" in words, or "stopped"
STOPPED: Outcome = {"stopped": True}


def never() -> bool:
    """Nobody stops it."""
    return False


def run_order(
    order: str, memory_bytes: int, threads: int | None = None, stopped: Callable[[], bool] = never
) -> Outcome:
    """Work by a task's order in a child process.

    memory_bytes: resident, that it may have; threads: of the engine and of walks, None for all that there are; stopped:
    is asked often, and ends the process when it says so.
    """
    name = json.loads(order)["name"]
    for _ in range(ATTEMPTS):
        outcome = _attempt(order, name, memory_bytes, _environment(threads), stopped)
        if outcome is not None:
            return outcome
    return {"error": f"{name}: its process was killed {ATTEMPTS} times, by the system or by somebody"}


def _environment(threads: int | None) -> dict[str, str]:
    """Of the child. Sums of linear algebra are split by threads: one, so that they are the same everywhere."""
    given = dict.fromkeys(_ONE_THREAD, "1")
    if threads is not None:
        given |= {variable: os.environ.get(variable, str(threads)) for variable in _THREADS}
    return {**os.environ, **given}


def _attempt(
    order: str, name: str, memory_bytes: int, environment: Mapping[str, str], stopped: Callable[[], bool]
) -> Outcome | None:
    """None where the process was killed by a signal that is not ours."""
    with child_process.workspace() as folder:
        asked, answer = folder / "order.json", folder / "answer.json"
        asked.write_text(order)
        command = [sys.executable, "-P", "-m", "quadgraph.work.task_process", str(asked), str(answer)]
        with (folder / "output.log").open("w+") as log:
            options = {"stdout": log, "stderr": log, "env": {**environment, "TMPDIR": str(folder)}}
            with child_process.beside(command, **options) as process:
                while (status := _status(process)) is None:
                    if stopped():
                        _end(process)
                        return STOPPED
                    if _resident_bytes(process.pid) > memory_bytes:
                        _end(process)
                        limit = f"{memory_bytes / 1e9:.1f} GB, the limit of a worker"
                        return {"error": f"{name}: took more than {limit}; with fewer workers each may have more"}
            log.seek(0)
            words = log.read()
        if status == 0 and answer.exists():
            return json.loads(answer.read_text())
        return None if status < 0 else {"error": f"{name}: ended with status {status}: {_last(words)}"}


def _status(process: subprocess.Popen[str]) -> int | None:
    with suppress(subprocess.TimeoutExpired):
        return process.wait(timeout=_LOOKS)
    return None


def _end(process: subprocess.Popen[str]) -> None:
    process.terminate()
    try:
        process.wait(timeout=_PATIENCE)
    except subprocess.TimeoutExpired:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)


def _resident_bytes(process: int) -> int:
    """0 where the system does not tell."""
    try:
        pages = Path(f"/proc/{process}/statm").read_text().split()[1]
    except (OSError, IndexError):
        return 0
    return int(pages) * os.sysconf("SC_PAGE_SIZE")


def _last(words: str) -> str:
    return " / ".join(line.strip() for line in words.splitlines() if line.strip())[-_LAST_WORDS:] or "no output"
