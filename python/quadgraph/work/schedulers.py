"""Who runs tasks: `--scheduler` of commands, and what it stands for."""

from __future__ import annotations

import argparse
import importlib.util
import os
import re
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from quadgraph.base.errors import InputError
from quadgraph.base.progress import ProgressCallback
from quadgraph.work import dask_workers, own_processes
from quadgraph.work.dask_workers import DaskWorkers
from quadgraph.work.machine_memory import memory_bytes
from quadgraph.work.own_processes import OwnProcesses

_MOST = 1024  # workers of a machine


@dataclass(frozen=True)
class Scheduler:
    """count: of workers on this machine, by Dask (kind "local") or without it ("processes"); else 0, and address: of a
    scheduler that runs, or the file that it wrote.
    """

    kind: str
    count: int = 0
    address: str | Path = ""

    @contextmanager
    def workers(self, tell: ProgressCallback) -> Iterator[DaskWorkers | OwnProcesses]:
        """Those that work by orders, as long as the block runs. Raises InputError, ToolError."""
        if self.kind == "cluster":
            with dask_workers.of_scheduler(self.address, tell) as found:
                yield found
            return
        memory, threads = memory_bytes() // self.count, max(1, (os.cpu_count() or 1) // self.count)
        shares = f"{memory / 1e9:.1f} GB and {threads} {'thread' if threads == 1 else 'threads'}"
        by_dask = self.kind == "local" and importlib.util.find_spec("distributed") is not None
        how = "" if by_dask or self.kind == "processes" else " without Dask (pip install 'quadgraph[cluster]')"
        tell(f"{self.count} {'worker' if self.count == 1 else 'workers'} on this machine{how}, each {shares} at most")
        asked = self.count, memory, threads
        with dask_workers.on_this_machine(*asked, tell) if by_dask else own_processes.started(*asked) as workers:
            yield workers


class StayingWorkers:
    """Those of a scheduler, who stay between one run of tasks and the next."""

    def __init__(self, scheduler: Scheduler, until: ExitStack) -> None:
        """until: ends them."""
        self._scheduler, self._until = scheduler, until
        self._found: DaskWorkers | OwnProcesses | None = None

    @contextmanager
    def workers(self, tell: ProgressCallback) -> Iterator[DaskWorkers | OwnProcesses]:
        """As `Scheduler.workers`, started where they are first wanted."""
        if self._found is None:
            self._found = self._until.enter_context(self._scheduler.workers(tell))
        yield self._found


def scheduler(text: str) -> Scheduler:
    """Argument type: local:N, processes:N, an address, or a file."""
    kind, colon, rest = text.partition(":")
    if kind in ("local", "processes"):
        if not colon or not re.fullmatch("[0-9]{1,4}", rest) or not 1 <= int(rest) <= _MOST:
            raise argparse.ArgumentTypeError(f"{text}: a number of workers is wanted, {kind}:1 to {kind}:{_MOST}")
        return Scheduler(kind, int(rest))
    if "://" in text:
        if not re.fullmatch(r"[a-z]+://[^/\s]+:[0-9]{1,5}", text):
            raise argparse.ArgumentTypeError(f"{text}: an address is wanted like tcp://HOST:PORT")
        return Scheduler("cluster", address=text)
    return Scheduler("cluster", address=Path(text))


def add_scheduler_argument(parser: argparse.ArgumentParser | argparse._ArgumentGroup, what: str) -> None:
    """Add who runs many tasks. what: is run, in words."""
    parser.add_argument(
        "--scheduler",
        type=scheduler,
        metavar="S",
        help=f"spread {what} over workers (docs/cluster.md): local:N on this machine, tcp://HOST:PORT or the FILE of a "
        "Dask scheduler, processes:N without Dask; what is finished is kept, and not done again",
    )


def check_several(args: argparse.Namespace, several: bool, wanted: str) -> None:
    """Raise InputError where a scheduler was typed and nothing is to be spread. wanted: for that, in words."""
    if not several and "scheduler" in args.given:
        raise InputError(f"--scheduler: found with nothing to spread over workers; {wanted}")
