"""Libraries that only an extra of this distribution brings."""

from __future__ import annotations

import importlib
from typing import Any

from quadgraph.base.errors import InputError


def load(name: str, extra: str) -> Any:
    """Import a module. Raises InputError, naming the extra that has it, if it is absent."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        install = f"pip install './python/validation[{extra}]'"
        raise InputError(f"{name} cannot be loaded ({error}); {install} in the source tree installs it") from error
