"""Child programs under a time and memory limit: they may abort, hang or grow, and must not outlive us."""

from __future__ import annotations

import ctypes
import math
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from contextvars import ContextVar
from dataclasses import dataclass, field
from pathlib import Path
from types import FrameType
from typing import Any

from quadgraph.base.errors import InputError, ToolError

MOST_TIME_S = 1e6  # that a program may be given
MOST_MEMORY_BYTES = 10**15
_PR_SET_PDEATHSIG = 1
_LAST_WORDS = 600  # characters of a failed program's output that its error repeats
_PATIENCE_S = 2.0  # for a program of ours to clean up
_WAITING = 4  # times its limit that a program may take by the clock: other programs want the processor too
_LIBC = ctypes.CDLL(None, use_errno=True)


@dataclass(frozen=True)
class Program:
    """A program we start, and where to get it when it is missing."""

    name: str
    source: str
    environment: str | None = None

    def path(self) -> Path:
        """Look beside the Python interpreter, then in PATH, then in the environment variable.

        Raises ToolError that says what to install.
        """
        beside = Path(sys.executable).parent / self.name
        if os.access(beside, os.X_OK):
            return beside
        found = shutil.which(self.name) or (os.environ.get(self.environment) if self.environment else None)
        if not found or not os.access(found, os.X_OK):
            hint = f" (or set {self.environment} to its path)" if self.environment else ""
            raise ToolError(f"{self.name}: program not found; {self.source}{hint}")
        return Path(found)


@dataclass(frozen=True)
class Finished:
    """What a program left: its exit status (negative: signal) and its output, both streams together."""

    status: int
    output: str


@dataclass
class _Family:
    """The programs that run in one context, and whether it has ended."""

    members: set[subprocess.Popen[bytes]] = field(default_factory=set)
    ended: bool = False


_FAMILY: ContextVar[_Family | None] = ContextVar("family", default=None)


def check_limits(time_limit_s: float, memory_limit_bytes: int) -> None:
    """Raise InputError for limits that the system cannot hold a program to."""
    if not 0 < time_limit_s <= MOST_TIME_S:
        raise InputError(f"time_limit: {time_limit_s:g} s found, allowed are more than 0 and at most {MOST_TIME_S:g}")
    if not 0 < memory_limit_bytes <= MOST_MEMORY_BYTES:
        raise InputError(
            f"memory_limit: {memory_limit_bytes / 1e9:g} GB found, allowed are more than 0 and at most "
            f"{MOST_MEMORY_BYTES / 1e9:g}"
        )


@contextmanager
def stopped_on_exit() -> Iterator[None]:
    """Kill, at the block's end, programs started in it by threads that run in a copy of its context.

    A main thread that is interrupted would otherwise wait for its workers, and they for their programs.
    """
    family = _Family()
    token = _FAMILY.set(family)
    try:
        yield
    finally:
        _FAMILY.reset(token)
        family.ended = True
        for process in tuple(family.members):
            _kill_group(process)


@contextmanager
def workspace() -> Iterator[Path]:
    """A temporary directory for a program's files, gone afterwards."""
    with _interrupts_wait():
        folder = tempfile.TemporaryDirectory(prefix="quadgraph-")
    try:
        yield Path(folder.name)
    finally:
        with _interrupts_wait():
            folder.cleanup()


def _child_setup(parent: int, time_limit_s: float, memory_limit_bytes: int | None) -> Callable[[], None]:
    processor_s = math.ceil(time_limit_s)

    def setup() -> None:
        _die_with(parent, signal.SIGKILL)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_CPU, (processor_s, processor_s + 1))
        if memory_limit_bytes is not None:
            resource.setrlimit(resource.RLIMIT_AS, (memory_limit_bytes, memory_limit_bytes))

    return setup


def _die_with(parent: int, number: signal.Signals) -> None:
    """Let a killed parent take its child along; the second line covers a parent that died before the first."""
    _LIBC.prctl(_PR_SET_PDEATHSIG, number)
    if os.getppid() != parent:
        os._exit(1)


@contextmanager
def beside(command: list[str], **options: Any) -> Iterator[subprocess.Popen[str]]:
    """Start a program of ours that runs beside this one: told to end (TERM) when the block or this process does.

    options: of subprocess.Popen. One that does not end then is killed with its group. Raises OSError where it cannot be
    started.
    """
    parent = os.getpid()
    with _interrupts_wait():
        process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            text=True,
            start_new_session=True,
            preexec_fn=lambda: _die_with(parent, signal.SIGTERM),
            **options,
        )
    try:
        yield process
    finally:
        with _interrupts_wait():
            process.terminate()
            try:
                process.wait(timeout=_PATIENCE_S)
            except subprocess.TimeoutExpired:
                _kill_group(process)


@contextmanager
def _interrupts_wait() -> Iterator[None]:
    """Hold an interrupt, TERM and HUP back until the block's end.

    Python runs hooks while it forks, and an exception in one of them, that of an interrupt too, is printed and lost.
    """
    if threading.current_thread() is not threading.main_thread():
        yield  # only the main thread is interrupted
        return
    held: list[tuple[int, FrameType | None]] = []
    before = {int(number): signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
    ours = {number: handler for number, handler in before.items() if callable(handler)}  # others are not Python's
    for number in ours:
        signal.signal(number, lambda number, frame: held.append((number, frame)))
    try:
        yield
    finally:
        for number, handler in ours.items():
            signal.signal(number, handler)
        if held:
            ours[held[0][0]](*held[0])


def _last_words(output: str) -> str:
    words = " / ".join(line.strip() for line in output.splitlines() if line.strip())
    return words[-_LAST_WORDS:] or "no output"


def _kill_group(process: subprocess.Popen[Any]) -> None:
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def run(
    program: Program,
    arguments: list[str],
    *,
    directory: Path,
    time_limit_s: float,
    memory_limit_bytes: int | None,
    accept: tuple[int, ...] = (0,),
) -> Finished:
    """Run a program in `directory` to its end, unbuffered, in its own process group.

    Raises ToolError when it is missing, ends with a status not in `accept`, or takes more than `time_limit_s` of the
    processor, in whole seconds, or four times as much by the clock; the message carries its last words. Whatever ends
    the call, interrupts included, the group is dead afterwards.
    """
    # Without stdbuf an aborting TetGen loses its messages.
    prefix = [stdbuf, "-o0", "-e0"] if (stdbuf := shutil.which("stdbuf")) else []
    log = directory / "output.log"
    with log.open("wb") as stream, ExitStack() as held:
        held.enter_context(_interrupts_wait())
        process = subprocess.Popen(
            [*prefix, str(program.path()), *arguments],
            cwd=directory,
            stdin=subprocess.DEVNULL,
            stdout=stream,
            stderr=subprocess.STDOUT,
            start_new_session=True,
            preexec_fn=_child_setup(os.getpid(), time_limit_s, memory_limit_bytes),
        )
        family = _FAMILY.get() or _Family()
        family.members.add(process)
        try:
            held.close()
            # Joined first, asked second: stopped_on_exit does the opposite, so that no program is missed.
            if family.ended:
                raise ToolError(f"{program.name}: stopped, the work it belongs to has ended")
            status = process.wait(timeout=_WAITING * time_limit_s)
        except subprocess.TimeoutExpired:
            status = -signal.SIGXCPU
        finally:
            _kill_group(process)
            family.members.discard(process)
    output = log.read_text(errors="replace")
    if status == -signal.SIGXCPU:
        raise ToolError(f"{program.name}: stopped after {time_limit_s:g} s, its time limit: {_last_words(output)}")
    if status not in accept:
        raise ToolError(_failure(program, status, output, memory_limit_bytes))
    return Finished(status, output)


def _failure(program: Program, status: int, output: str, memory_limit_bytes: int | None) -> str:
    how = f"ended by {signal.Signals(-status).name}" if status < 0 else f"failed with exit status {status}"
    starved = "bad_alloc" in output or "out of memory" in output.lower()
    limit = f", memory limit {memory_limit_bytes / 2**20:.0f} MiB" if starved and memory_limit_bytes else ""
    return f"{program.name}: {how}{limit}: {_last_words(output)}"
