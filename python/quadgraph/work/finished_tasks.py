"""Which tasks are finished: a small file each, beside the results, which any later run finds."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quadgraph.base import atomic_file
from quadgraph.base.errors import InputError
from quadgraph.work.task import Task, key_of, sha256_of

LEDGER = ".quadgraph-tasks"  # folder beside results


@dataclass(frozen=True)
class FinishedTask:
    """value: what the task's function returned."""

    value: Any


def find(ledger: Path, task: Task, content: Mapping[str, Any]) -> FinishedTask | None:
    """What is known of a task of this content, None where it or a file that it wrote is not as it was left."""
    key = key_of(content)
    try:
        noted = json.loads(_place(ledger, key).read_text())
        if noted["key"] != key:
            return None
        files = dict(noted["files"])
        if all(files[str(path)] == sha256_of(task.folder / path) for path in task.writes):
            return FinishedTask(noted["value"])
    except (OSError, ValueError, KeyError, TypeError, InputError):  # nothing, or nothing that can be used
        return None
    return None


def keep(ledger: Path, task: Task, content: Mapping[str, Any], value: Any) -> None:
    """Note that a task is finished. Raises InputError where that, or what it ought to have written, cannot be read."""
    files = {str(path): sha256_of(task.folder / path) for path in task.writes}
    key = key_of(content)
    try:
        ledger.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{ledger}: cannot be made ({error.strerror})") from error
    atomic_file.write_json(_place(ledger, key), {"task": task.name, "key": key, "value": value, "files": files})


def _place(ledger: Path, key: str) -> Path:
    return ledger / f"{key[:32]}.json"
