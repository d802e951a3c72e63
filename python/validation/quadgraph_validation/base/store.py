"""Arrays on disk under a key of everything that enters them: what was made for anything else is refused by name."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from quadgraph.base import atomic_file
from quadgraph.base.errors import InputError


def digest(key: dict[str, Any]) -> str:
    """SHA-256 of a key."""
    return hashlib.sha256(json.dumps(key, sort_keys=True).encode()).hexdigest()


def kept(path: Path, make: Callable[[Path], Any]) -> Path:
    """The file at `path`, which `make` writes to the path that it is given, if it is not there yet."""
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        working = path.with_name(f".{os.getpid()}.{path.name}")
        try:
            make(working)
            working.replace(path)
        finally:
            working.unlink(missing_ok=True)
    return path


def save(path: Path, key: dict[str, Any], arrays: dict[str, np.ndarray]) -> None:
    """Write arrays under a key ready for JSON, whole or not at all. Raises InputError if `path` cannot be written."""
    record = json.dumps({"key": key, "sha256": digest(key)}, sort_keys=True)
    with atomic_file.replacing(path) as stream:
        sections: dict[str, Any] = arrays | {"record": np.array(record)}
        np.savez_compressed(stream, **sections)


def load(path: Path, key: dict[str, Any], names: tuple[str, ...], what: str) -> dict[str, np.ndarray]:
    """Read the arrays of these names that `save` wrote for this very key.

    what: the file ought to be, for the message. Raises InputError if it cannot be read or was made for anything else,
    naming what differs.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            record = json.loads(str(file["record"]))
            arrays = {name: file[name] for name in names}
        found, stated = record["key"], record["sha256"]
    except (OSError, EOFError, KeyError, ValueError, TypeError, BadZipFile) as problem:
        raise InputError(f"{path}: cannot be read as {what}: {problem}") from problem
    if stated != digest(found):
        raise InputError(f"{path}: sha256 of the key: {stated} found, its key has {digest(found)}")
    wrong = _differences(found, key)
    if wrong:
        raise InputError(f"{path}: made for something else: {'; '.join(wrong)}; remove it to have it made again")
    return arrays


def _differences(found: Any, wanted: Any, where: str = "") -> list[str]:
    if isinstance(found, dict) and isinstance(wanted, dict):
        names = sorted(found.keys() | wanted.keys())
        below = [_differences(found.get(n), wanted.get(n), f"{where}.{n}" if where else n) for n in names]
        return [text for texts in below for text in texts]
    return [] if found == wanted else [f"{where}: {found!r} found, {wanted!r} wanted"]
