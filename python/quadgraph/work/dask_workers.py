"""Workers of a Dask cluster that work by orders (dask.distributed, an extra)."""

from __future__ import annotations

import json
import logging
import os
import platform
import shutil
import signal
import tempfile
import warnings
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

from quadgraph.base.errors import InputError, QuadGraphError, ToolError
from quadgraph.base.optional_package import optional_package
from quadgraph.base.progress import ProgressCallback
from quadgraph.base.version import __version__
from quadgraph.work.machine_memory import memory_bytes
from quadgraph.work.task_runner import STOPPED, Outcome, run_order

EXTRA = "cluster"
_REACHED = 5.0  # s, within which a scheduler answers
_JOINED = 30.0  # s, within which a first worker is there
_CLOSED = 2.0  # s for a cluster of ours to end, at most
_DASHBOARD = "127.0.0.1:8787"  # of a cluster on this machine, for its own user
_FAILURES = 1000  # times that a worker may be lost under a task: tasks run in processes apart and cannot be why
_HYPHEN = "\N{NON-BREAKING HYPHEN}"
_LOGS = ("distributed", "distributed.client", "asyncio", "tornado")  # each with a level of its own
_NOTHING = logging.CRITICAL + 1
_KEY = 12  # digits of a content that a task's key ends with


@contextmanager
def on_this_machine(count: int, memory: int, threads: int, tell: ProgressCallback) -> Iterator[DaskWorkers]:
    """A cluster of `count` workers on this machine, each with so much memory, bytes, and so many threads; gone
    afterwards.
    """
    distributed, dask = optional_package("distributed", EXTRA), optional_package("dask", EXTRA)
    settings = {"distributed.scheduler.allowed-failures": _FAILURES, "distributed.scheduler.worker-saturation": 1.0}
    with ExitStack() as stack:
        stack.enter_context(_quiet())
        stack.enter_context(dask.config.set(settings))
        folder = tempfile.mkdtemp(prefix="quadgraph-")  # of all that workers leave, who are killed at the end
        stack.callback(shutil.rmtree, folder, ignore_errors=True)
        cluster = distributed.LocalCluster(
            n_workers=count,
            threads_per_worker=1,
            memory_limit=memory,
            dashboard_address=_DASHBOARD,
            silence_logs=logging.CRITICAL,
            local_directory=folder,
            env={"TMPDIR": folder},
        )
        stack.callback(_end, cluster)
        client = stack.enter_context(distributed.Client(cluster))
        tell(f"dashboard: {client.dashboard_link}")
        yield DaskWorkers(distributed, client, "the cluster on this machine", threads)


def _end(cluster: Any) -> None:
    """End the workers at once: asked to end by themselves, they take seconds."""
    for worker in cluster.workers.values():
        if worker.pid is not None:
            with suppress(ProcessLookupError):
                os.kill(worker.pid, signal.SIGKILL)
    with suppress(TimeoutError):
        cluster.close(timeout=_CLOSED)


@contextmanager
def of_scheduler(where: str | Path, tell: ProgressCallback) -> Iterator[DaskWorkers]:
    """The workers of a scheduler that runs already, by its address or by the file that it wrote.

    Raises InputError where the scheduler or its workers cannot be reached, ToolError where they are others than ours.
    """
    distributed = optional_package("distributed", EXTRA)
    address = _address_of(where) if isinstance(where, Path) else where
    with _quiet(), _client(distributed, address) as client:
        count = _checked_workers(client, address)
        tell(f"{address}: {count} {'worker' if count == 1 else 'workers'}; dashboard: {client.dashboard_link}")
        yield DaskWorkers(distributed, client, address)


def _address_of(file: Path) -> str:
    try:
        return str(json.loads(file.read_text())["address"])
    except FileNotFoundError:
        raise InputError(f"{file}: there is no such file; `dask scheduler --scheduler-file {file}` writes it") from None
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"{file}: not a scheduler file of Dask ({error!r})") from error


@contextmanager
def _client(distributed: Any, address: str) -> Iterator[Any]:
    try:
        client = distributed.Client(address, timeout=_REACHED, name="quadgraph")
    except (OSError, ValueError, TimeoutError) as error:
        raise InputError(
            f"--scheduler {address}: no Dask scheduler answers there ({_first_line(error)}); `dask scheduler` starts "
            "one and says its address"
        ) from error
    with client:
        yield client


def _checked_workers(client: Any, address: str) -> int:
    """How many there are."""
    try:
        client.wait_for_workers(1, timeout=_JOINED)
    except TimeoutError as error:
        raise InputError(
            f"--scheduler {address}: it has no workers after {_JOINED:g} s; `dask worker {address}` starts one, on any "
            "machine that sees the same files"
        ) from error
    ours, theirs = versions(), client.run(versions, on_error="return")
    for worker, found in theirs.items():
        if isinstance(found, Exception):
            raise ToolError(f"worker {worker}: cannot work for quadgraph {__version__}: {_first_line(found)}")
        wrong = [f"{name} {found[name]}, here {ours[name]}" for name in ours if found[name] != ours[name]]
        if wrong:
            raise ToolError(f"worker {worker}: has {'; '.join(wrong)}; install the same versions there")
    return len(theirs)


def versions() -> dict[str, str]:
    """What has to be the same on workers."""
    distributed = optional_package("distributed", EXTRA)
    major, minor, _ = platform.python_version_tuple()
    return {"Python": f"{major}.{minor}", "quadgraph": __version__, "distributed": distributed.__version__}


class LetGoError(Exception):
    """A task was stopped because nobody waited for it any more; somebody may have asked for it again since."""


def work(order: str, threads: int | None) -> Outcome:
    """Work by an order on a worker, whose child the order's process is, until it is let go. threads: as `run_order`."""
    from distributed import get_worker

    worker = get_worker()
    key = worker.get_current_task()
    limit = worker.memory_manager.memory_limit or memory_bytes()

    def let_go() -> bool:
        state = worker.state.tasks.get(key)
        return state is None or state.state == "cancelled"

    outcome = run_order(order, limit // worker.state.nthreads, threads, let_go)
    if outcome == STOPPED:
        raise LetGoError
    return outcome


class DaskWorkers:
    """A client that hands orders to workers."""

    def __init__(self, distributed: Any, client: Any, where: str, threads: int | None = None) -> None:
        """distributed: the package; where: the scheduler, in words; threads: as `run_order` takes them."""
        self._distributed = distributed
        self._client = client
        self._where = where
        self._threads = threads

    def outcomes(self, orders: Mapping[str, str]) -> Iterator[tuple[str, Outcome]]:
        """As `OwnProcesses.outcomes`. Raises ToolError where the scheduler is lost."""
        names = {self._name(key, order): key for key, order in orders.items()}
        futures = self._client.map(work, list(orders.values()), threads=self._threads, key=list(names))
        running = self._distributed.as_completed(futures)
        for future in running:
            if future.status == "error" and isinstance(future.exception(), self._distributed.KilledWorker | LetGoError):
                future.retry()
                running.add(future)
            elif future.status == "error":
                yield names[future.key], {"error": _first_line(future.exception())}
            elif future.status != "finished":
                raise ToolError(f"{self._where}: the scheduler is gone")
            else:
                yield names[future.key], future.result()

    @staticmethod
    def _name(key: str, order: str) -> tuple[str, str]:
        """The key that Dask knows a task by: of which kind it is, and which of them.

        Of one kind Dask expects that they take equally long, and has them wait at the scheduler for the next worker
        that is free; others it hands out at once, and moves them by guesses that leave workers without work. The
        dashboard shows a kind up to a hyphen.
        """
        name = str(json.loads(order)["name"])
        return name.partition(" ")[0].strip(",").replace("-", _HYPHEN), f"{name}-{key[:_KEY]}"


def _first_line(error: Any) -> str:
    if isinstance(error, QuadGraphError):
        return str(error)
    return (str(error).splitlines() or [""])[0] or type(error).__name__


@contextmanager
def _quiet() -> Iterator[None]:
    """What Dask has to say of lost workers and other versions is said by us."""
    logs = [logging.getLogger(name) for name in _LOGS]
    before = [log.level for log in logs]
    for log in logs:
        log.setLevel(_NOTHING)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        for log, level in zip(logs, before, strict=True):
            log.setLevel(level)
