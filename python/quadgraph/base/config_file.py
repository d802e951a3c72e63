"""The user's file of defaults: $XDG_CONFIG_HOME/quadgraph/config.toml, else ~/.config/quadgraph/config.toml."""

from __future__ import annotations

import os
import tomllib
from pathlib import Path
from typing import Any

from quadgraph.base import regular_file
from quadgraph.base.errors import InputError

_MOST_BYTES = 1_000_000


def place() -> Path:
    """Where it is, or would be."""
    folder = os.environ.get("XDG_CONFIG_HOME")
    return (Path(folder) if folder else Path.home() / ".config") / "quadgraph" / "config.toml"


def exists() -> bool:
    """Whether there is one that can be looked at."""
    try:
        return place().exists()
    except (OSError, RuntimeError):  # the last: there is no home
        return False


def load() -> dict[str, Any]:
    """What it says; nothing where there is none. Raises InputError where it cannot be read or is no TOML."""
    try:
        path = place()
        if path.stat().st_size > _MOST_BYTES:
            raise InputError(f"{path}: larger than the {_MOST_BYTES} bytes that are allowed")
        return tomllib.loads(regular_file.read_bytes(path).decode())
    except (FileNotFoundError, NotADirectoryError, RuntimeError):  # the last: there is no home
        return {}
    except OSError as error:
        raise InputError(f"{place()}: cannot be read ({error.strerror})") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise InputError(f"{place()}: is no TOML: {error}; correct it, or use --no-config") from error
