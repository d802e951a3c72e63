"""Files that are either written whole or not at all."""

from __future__ import annotations

import atexit
import json
import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, BinaryIO

from quadgraph.base import outputs
from quadgraph.base.errors import InputError

_unfinished: dict[Path, int] = {}  # temporary files and the processes that make them


def new_file(path: Path, suffix: str) -> tuple[int, Path]:
    """Make an empty file beside `path`, of a name that nobody can foresee; it is open for writing.

    Until `discard` it is one that goes when Python ends: a signal may come before the caller knows of the file.
    Raises InputError if `path` is no regular file or new name, OSError if there is no room or right to write.
    """
    outputs.check_kind(path)
    stem = os.fsdecode(os.fsencode(path.stem)[:200])
    temporary = path.parent.absolute() / f".{stem}.{secrets.token_hex(8)}{suffix}"
    _unfinished[temporary] = os.getpid()
    try:
        return os.open(temporary, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o666), temporary
    except OSError:  # nothing was made, or what is there is somebody else's
        del _unfinished[temporary]
        raise


def discard(temporary: Path) -> None:
    """Remove a file of `new_file`, if it has not become another."""
    temporary.unlink(missing_ok=True)
    _unfinished.pop(temporary, None)


@atexit.register
def _discard_all() -> None:
    for temporary, process in list(_unfinished.items()):
        if process == os.getpid():
            with suppress(OSError):
                discard(temporary)


@contextmanager
def replacing(path: Path) -> Iterator[BinaryIO]:
    """Give a stream under a temporary name beside `path`, which it becomes when the block ends well.

    Whatever interrupts the block, `path` is either untouched or complete. Raises InputError if it cannot be written.
    """
    try:
        handle, temporary = new_file(path, ".tmp")
        try:
            with os.fdopen(handle, "wb") as stream:
                yield stream
                stream.flush()
                os.fsync(stream.fileno())
            temporary.replace(path)
        finally:
            discard(temporary)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror})") from error


def write_json(path: Path, value: Any, dense: bool = False) -> None:
    """Write `value` as JSON, indented or without any space. Raises InputError if `path` cannot be written."""
    form = {"separators": (",", ":")} if dense else {"indent": 1}
    with replacing(path) as stream:
        stream.write((json.dumps(value, **form) + "\n").encode())
