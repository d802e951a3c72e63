"""The environment that tools written in Python run in: .venv, which tools/setup makes."""

from __future__ import annotations

import os
import sys
from importlib.util import find_spec
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / ".venv"


def enter(*modules: str, setup: str = "tools/setup") -> None:
    """Start this tool anew with the interpreter of .venv where its own lacks one of these modules.

    Ends in one line that names `setup`, what installs them, where .venv is not there or lacks them too.
    """
    missing = next((name for name in modules if find_spec(name) is None), None)
    if missing is None:
        return
    tool = Path(sys.argv[0]).name
    if Path(sys.prefix).resolve() == FOLDER.resolve():
        sys.exit(f"tools/{tool}: the module {missing} is not in {FOLDER}; {setup} installs it")
    python = FOLDER / "bin" / "python"
    if not os.access(python, os.X_OK):
        sys.exit(f"tools/{tool}: {FOLDER} is not there, with what this tool needs; {setup} makes it")
    os.execv(python, [str(python), *sys.argv])
