"""Programs of ours beside the command: they end with it, however it ends and whatever they do."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

from quadgraph.base import child_process

STUBBORN = """
import signal, time
signal.signal(signal.SIGTERM, signal.SIG_IGN)
print("ready", flush=True)
time.sleep(600)
"""
PARENT = """
import sys
from quadgraph.base import child_process
with child_process.beside([sys.executable, "-c", "import time; time.sleep(600)"]) as child:
    print(child.pid, flush=True)
    child.wait()
"""


def alive(process: int) -> bool:
    """Whether a process runs, and is not one that nobody has waited for."""
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return False
    return state != "Z"


def test_a_program_that_does_not_end_when_it_is_told_is_killed():
    with child_process.beside([sys.executable, "-c", STUBBORN], stdout=subprocess.PIPE) as child:
        assert child.stdout is not None
        with child.stdout:
            assert child.stdout.readline() == "ready\n"
    assert child.returncode == -signal.SIGKILL


def test_a_program_ends_with_a_command_that_was_killed():
    command = subprocess.Popen([sys.executable, "-c", PARENT], stdout=subprocess.PIPE, text=True)
    assert command.stdout is not None
    with command.stdout:
        child = int(command.stdout.readline())
    os.kill(command.pid, signal.SIGKILL)
    command.wait()
    deadline = time.monotonic() + 20
    while alive(child):
        assert time.monotonic() < deadline, "it goes on"
        time.sleep(0.02)
