"""The process that a task runs in: `python -m quadgraph.work.task_process ORDER ANSWER`, both files of JSON."""

from __future__ import annotations

import importlib
import json
import os
import platform
import shutil
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from quadgraph.base import program
from quadgraph.base.errors import InputError, QuadGraphError, ToolError
from quadgraph.work import finished_tasks
from quadgraph.work.task import Task, of_order


def run(order: Path, answer: Path) -> int:
    """Work by an order, note that it is finished, and answer with its value, or with the error of it."""
    document = json.loads(order.read_text())
    try:
        found = {"value": _value(document)}
    except QuadGraphError as error:
        found = {"error": str(error)}
    except OSError as error:
        found = {"error": f"{error.filename or document['name']}: {error.strerror or error}"}
    answer.write_text(json.dumps(found))
    return 0


def _value(document: Mapping[str, Any]) -> Any:
    task, content = of_order(document), document["content"]
    try:
        os.chdir(task.folder)
    except OSError as error:
        raise _unseen(task.folder, error.strerror or "") from error
    _check(task, content)
    ledger = Path(document["ledger"])
    found = finished_tasks.find(ledger, task, content)
    if found is not None:  # by another run, since the order was written
        return found.value
    module, _, name = task.function.partition(":")
    value = getattr(importlib.import_module(module), name)(**task.arguments)
    finished_tasks.keep(ledger, task, content, value)
    return value


def _check(task: Task, wanted: Mapping[str, Any]) -> None:
    """Raise unless code and files are here what they were where the order was written."""
    try:
        found = task.content()
    except InputError as error:
        raise _unseen(error, "") from error
    for package, code in wanted["code"].items():
        if found["code"][package] is None:
            raise ToolError(f"{package} is not installed on {platform.node()}, where this was to run; install it there")
        if found["code"][package] != code:
            raise ToolError(
                f"{package} on {platform.node()} is another build than the one that asks, so that results would depend "
                "on who makes them; install the same one there"
            )
    for path, sha256 in wanted["reads"].items():
        if found["reads"][path] != sha256:
            raise _unseen(path, "another content than where this was asked for")


def _unseen(what: object, why: str) -> InputError:
    words = f"{what}: {why}" if why else str(what)
    return InputError(f"{words}; found on {platform.node()}: workers have to see the same files under the same names")


def main() -> int:
    """Run; a process that is told to end takes its folder along, for who would else do so may have been killed."""
    order, answer = map(Path, sys.argv[1:])
    status = program.ended(lambda: run(order, answer))
    if status:
        shutil.rmtree(order.parent, ignore_errors=True)
    return status


if __name__ == "__main__":
    sys.exit(main())
