"""Where the engine's program is, and how it refuses, for the tests that run it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def find_engine() -> str | None:
    """The path of quadgraph-engine: beside the interpreter, in the build, on the PATH; None if it is not there."""
    folders = [Path(sys.executable).parent, ROOT / "build" / "engine" / "app", *os.get_exec_path()]
    return shutil.which("quadgraph-engine", path=os.pathsep.join(map(str, folders)))


ENGINE = find_engine()


def assert_refused(result: subprocess.CompletedProcess, *words: str) -> None:
    """The program failed with one line of words, these among them."""
    assert result.returncode == 1
    assert result.stdout == ""
    assert len(result.stderr.splitlines()) == 1
    for word in words:
        assert word in result.stderr
