"""Threads that wait for the programs which fill levels with tets."""

from __future__ import annotations

import contextvars
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any

from quadgraph.base import child_process

WORKERS = 2  # levels filled with tets at the same time


@contextmanager
def workers() -> Iterator[Callable[..., Future]]:
    """Threads for the block's work; what has not begun at its end never does, and child programs are stopped."""
    pool = ThreadPoolExecutor(WORKERS)

    def submit(*call: Any) -> Future:
        in_context: Callable[..., Any] = contextvars.copy_context().run
        return pool.submit(in_context, *call)

    with child_process.stopped_on_exit():
        try:
            yield submit
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
