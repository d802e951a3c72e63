"""Processes of this machine that work by orders, without any cluster."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from contextlib import contextmanager

from quadgraph.work.task_runner import Outcome, run_order

_LOOKS = 0.1  # s, within which an interrupt is heeded


@contextmanager
def started(count: int, memory_bytes: int, threads: int) -> Iterator[OwnProcesses]:
    """Processes, at most `count` at once and each with so much memory and so many threads; none is left afterwards."""
    own = OwnProcesses(count, memory_bytes, threads)
    try:
        yield own
    finally:
        own.stop()


class OwnProcesses:
    """A thread for each of the processes that may run at once, which watches it."""

    def __init__(self, count: int, memory_bytes: int, threads: int) -> None:
        """As `started` has it."""
        self._memory_bytes = memory_bytes
        self._threads = threads
        self._stopped = threading.Event()
        self._pool = ThreadPoolExecutor(count)

    def outcomes(self, orders: Mapping[str, str]) -> Iterator[tuple[str, Outcome]]:
        """Orders by key to outcomes by key, each when it is there."""
        waiting = {
            self._pool.submit(run_order, order, self._memory_bytes, self._threads, self._stopped.is_set): key
            for key, order in orders.items()
        }
        while waiting:
            for future in wait(waiting, timeout=_LOOKS, return_when=FIRST_COMPLETED).done:
                yield waiting.pop(future), future.result()

    def stop(self) -> None:
        """End all processes; what has not begun does not."""
        self._stopped.set()
        self._pool.shutdown(cancel_futures=True)
