"""A child process under limits of memory and time, signals sent to it, and what it leaves running."""

from __future__ import annotations

import os
import resource
import shutil
import signal
import subprocess
import sys
import threading
import time
import uuid
from pathlib import Path
from typing import IO

from attack.case import Case, Outcome

ROOT = Path(__file__).resolve().parents[2]
MARK = "QUADGRAPH_ATTACK"  # in the environment of a child and of all that it starts
ADDRESSES = 64 * 10**9  # bytes: what is mapped is no measure, but more than this is refused by the system
POLL = 0.02  # s
PRINTED = 2**24  # bytes
TICKS = os.sysconf("SC_CLK_TCK")
PAGE = os.sysconf("SC_PAGE_SIZE")
GRACE = 1.0  # s, in which what a child started may end after it
PEAK = Path("/proc/self/clear_refs")  # 5: forget what this process held at most
WALL = 4.0  # seconds of wall time allowed for each of processor time: others may be at work


def program(name: str) -> str:
    """The path of one of the programs that cases run."""
    if name == "python":
        return sys.executable
    if name == "sh":
        return "/bin/sh"
    folders = [Path(sys.executable).parent, ROOT / "build" / "engine" / "app", *os.get_exec_path()]
    found = shutil.which(name, path=os.pathsep.join(map(str, folders)))
    if found is None:
        raise FileNotFoundError(f"{name}: not built (run tools/setup)")
    return found


def command_line(case: Case) -> list[str]:
    """What is run: the case's command, in a shell that sets limits which a child must have from its first moment."""
    line = [program(case.command[0]), *case.command[1:]]
    limits = ""
    if case.blocks is not None:
        limits += f"trap '' XFSZ; ulimit -f {case.blocks}; "
    if case.files is not None:
        limits += f"ulimit -n {case.files}; "
    return ["/bin/sh", "-c", f'{limits}exec "$@"', "sh", *line] if limits else line


def environment(case: Case, folder: Path, mark: str) -> dict[str, str]:
    """The variables of a case: temporary files and caches beside its folder."""
    kept = {key: value for key, value in os.environ.items() if not key.startswith(("PYTEST_", "QUADGRAPH_", "XDG_"))}
    (folder.parent / "tmp").mkdir(exist_ok=True)
    own = {"TMPDIR": str(folder.parent / "tmp"), "HOME": str(folder.parent / "home"), MARK: mark}
    own |= {"OPENBLAS_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1", "QUADGRAPH_DEVICE": "cpu"}
    return kept | own | dict(case.environment)


def _threads(pid: int) -> list[Path]:
    try:
        return list(Path(f"/proc/{pid}/task").iterdir())
    except OSError:  # it has ended
        return []


def descendants(pid: int) -> list[int]:
    """A process and all below it."""
    found, waiting = [], [pid]
    while waiting:
        each = waiting.pop()
        found.append(each)
        for thread in _threads(each):
            try:
                waiting += map(int, (thread / "children").read_text().split())
            except OSError:
                continue
    return found


def resident(pids: list[int]) -> int:
    """Bytes of memory that processes hold together."""
    total = 0
    for pid in pids:
        try:
            total += int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * PAGE
        except (OSError, IndexError):
            continue
    return total


def held(pid: int) -> int:
    """Bytes of memory that a process held at most since it runs its program; 0 where it is gone."""
    try:
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    except OSError:
        return 0
    return next((int(line.split()[1]) * 1024 for line in lines if line.startswith("VmHWM:")), 0)


def processor_time(pid: int) -> float:
    """Seconds that a process and those it waited for have computed; 0 where it is gone."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return sum(map(int, fields[11:15])) / TICKS


def heeds(pid: int) -> bool:
    """Whether a process has set what it does on TERM."""
    try:
        status = Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return False
    caught = next((line.split()[1] for line in status.splitlines() if line.startswith("SigCgt")), "0")
    return bool(int(caught, 16) >> (signal.SIGTERM - 1) & 1)


def marked(mark: str) -> list[int]:
    """Processes of a case, by its mark in their environment."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                if f"{MARK}={mark}".encode() in (entry / "environ").read_bytes():
                    found.append(int(entry.name))
            except OSError:
                continue
    return found


def end(pids: list[int]) -> None:
    """End processes that the case started."""
    for pid in pids:
        try:
            os.kill(pid, signal.SIGKILL)
        except ProcessLookupError:
            continue


class Stream(threading.Thread):
    """What a child prints: files would be under the limits that it has."""

    def __init__(self, pipe: IO[bytes]) -> None:
        super().__init__(daemon=True)
        self.pipe, self.data = pipe, b""
        self.start()

    def run(self) -> None:
        """Read to the end, and keep the first PRINTED bytes."""
        while block := self.pipe.read1(65536):  # type: ignore[attr-defined]
            if len(self.data) < PRINTED:
                self.data += block

    def text(self) -> str:
        """All of it, once everybody who may write has ended."""
        self.join(GRACE)
        return self.data.decode(errors="replace")


class Watch:
    """One child from its start to its end."""

    def __init__(self, case: Case, process: subprocess.Popen, mark: str, memory: int) -> None:
        self.case, self.process, self.mark, self.memory = case, process, mark, memory
        self.start = time.monotonic()
        self.peak, self.limit = 0, ""
        self.signals = list(case.signals)
        self.heeded: float | None = None  # when signals began to be heeded
        self.first: tuple[float, float] | None = None  # wall and processor time of the first signal

    def step(self) -> None:
        """Measure, send signals that are due, and end what is beyond its limits."""
        pids, now = descendants(self.process.pid), time.monotonic()
        self.peak = max(self.peak, resident(pids), *map(held, pids))
        computed = processor_time(self.process.pid)
        if self.peak > self.memory:
            self.limit = "memory"
        elif computed > self.case.seconds or now - self.start > WALL * self.case.seconds:
            self.limit = "time"
        if self.limit:
            end(list({*pids, *marked(self.mark)}))
        elif self.signals:
            self.send(now, computed)

    def send(self, now: float, computed: float) -> None:
        """Send the next signal if its time has come."""
        if self.heeded is None and (self.case.command[0] == "quadgraph-engine" or heeds(self.process.pid)):
            self.heeded = now
        if self.heeded is not None and now - self.heeded >= self.signals[0][0]:
            self.first = self.first or (now, computed)
            os.kill(self.process.pid, self.signals.pop(0)[1])  # send_signal would reap one that has just ended

    def finish(self, usage: resource.struct_rusage, streams: list[Stream]) -> Outcome:
        """The outcome, once the child has ended."""
        now = time.monotonic()
        orphans = marked(self.mark)
        while orphans and time.monotonic() - now < GRACE:
            time.sleep(POLL)
            orphans = marked(self.mark)
        end(orphans)
        # The system begins to count where a child is a copy of this process: no more than that is no news of it.
        counted = usage.ru_maxrss * 1024
        peak = max(self.peak, counted if counted > held(os.getpid()) else 0)
        limit = "memory" if peak > self.memory else self.limit
        computed = usage.ru_utime + usage.ru_stime
        after = None if self.first is None else (now - self.first[0], computed - self.first[1])
        texts = [stream.text() for stream in streams]
        code = self.process.returncode
        return Outcome(code, *texts, now - self.start, peak, limit, after, len(orphans))


def run(case: Case, folder: Path, input_bytes: int) -> Outcome:
    """Run a case in its folder, which holds so many bytes; memory may be what the case allows and 20 times those."""
    mark = uuid.uuid4().hex
    PEAK.write_text("5")  # the system counts what we took at most as the child's, until it runs its program
    process = subprocess.Popen(
        command_line(case),
        cwd=folder,
        env=environment(case, folder, mark),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
    )
    streams = [Stream(pipe) for pipe in (process.stdout, process.stderr) if pipe]
    resource.prlimit(process.pid, resource.RLIMIT_AS, (ADDRESSES, ADDRESSES))
    resource.prlimit(process.pid, resource.RLIMIT_CORE, (0, 0))
    watch = Watch(case, process, mark, case.memory + 20 * input_bytes)
    while True:
        ended, status, usage = os.wait4(process.pid, os.WNOHANG)
        if ended:
            process.returncode = os.waitstatus_to_exitcode(status)
            return watch.finish(usage, streams)
        watch.step()
        time.sleep(POLL)
