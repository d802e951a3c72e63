"""Long calls into compiled code that Ctrl-C can end."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TypeVar

Result = TypeVar("Result")
_PATIENCE = 0.1  # s between looks for an interruption


def interruptible(call: Callable[[], Result]) -> Result:
    """What `call` returns or raises, worked out on a thread of its own.

    KeyboardInterrupt is raised within a tenth of a second; the call then goes on unheard until it or the process ends.
    """
    outcome: list[Result] = []
    problem: list[BaseException] = []

    def work() -> None:
        try:
            outcome.append(call())
        except BaseException as error:  # handed to the caller, whatever it is
            problem.append(error)

    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    while thread.is_alive():
        thread.join(_PATIENCE)
    if problem:
        raise problem[0]
    return outcome[0]
