"""Tools written in Python run with any interpreter, as documents say: they find what they need in .venv, or say so."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TOOLS = [path for path in sorted((ROOT / "tools").iterdir()) if path.is_file() and b"env python3" in path.read_bytes()]
TOOL = """
import environment
environment.enter("argparse", "module_that_nobody_has", setup="tools/setup --tests")
print("went on")
"""
PYTHON = '#!/bin/sh\necho "$@"\n'


@pytest.mark.parametrize("tool", TOOLS, ids=lambda path: path.name)
def test_a_tool_helps_without_an_activated_environment(tool: Path):
    """Started with the interpreter that the environment was made by, which has none of its modules."""
    if not (ROOT / ".venv" / "bin" / "python").exists():
        pytest.skip("there is no .venv")
    done = subprocess.run(
        [sys._base_executable, "-S", str(tool), "--help"], capture_output=True, text=True, timeout=120
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("usage: ")


def run(root: Path) -> subprocess.CompletedProcess[str]:
    """Run a tool of a tree of its own."""
    (root / "tools").mkdir()
    shutil.copy(ROOT / "tools" / "environment.py", root / "tools")
    tool = root / "tools" / "draw"
    tool.write_text(TOOL)
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    command = [sys.executable, str(tool), "one", "--two"]
    return subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60)


def test_without_an_environment_a_tool_names_what_makes_one(tmp_path: Path):
    done = run(tmp_path)
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr == (
        f"tools/draw: {tmp_path / '.venv'} is not there, with what this tool needs; tools/setup --tests makes it\n"
    )


def test_a_tool_starts_anew_in_the_environment_with_its_arguments(tmp_path: Path):
    python = tmp_path / ".venv" / "bin" / "python"
    python.parent.mkdir(parents=True)
    python.write_text(PYTHON)
    python.chmod(0o755)
    done = run(tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == f"{tmp_path / 'tools' / 'draw'} one --two\n"


def test_in_an_environment_that_lacks_a_module_a_tool_names_it(tmp_path: Path):
    (tmp_path / ".venv").symlink_to(sys.prefix)
    done = run(tmp_path)
    assert (done.returncode, done.stdout) == (1, "")
    assert "the module module_that_nobody_has is not in" in done.stderr
    assert done.stderr.endswith("tools/setup --tests installs it\n")
