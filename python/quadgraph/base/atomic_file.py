"""Files that are either written whole or not at all."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, BinaryIO

from quadgraph.base import outputs
from quadgraph.base.errors import InputError


def new_file(path: Path, suffix: str) -> tuple[int, Path]:
    """Make an empty file beside `path`, of a name that nobody can foresee; it is open for writing.

    Raises InputError if `path` is no regular file or new name, OSError if there is no room or right to write.
    """
    outputs.check_kind(path)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.stem[:200]}.", suffix=suffix)
    os.fchmod(handle, 0o666 & ~_umask())
    return handle, Path(name)


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
            with suppress(FileNotFoundError):
                temporary.unlink()
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror})") from error


def write_json(path: Path, value: Any, dense: bool = False) -> None:
    """Write `value` as JSON, indented or without any space. Raises InputError if `path` cannot be written."""
    form = {"separators": (",", ":")} if dense else {"indent": 1}
    with replacing(path) as stream:
        stream.write((json.dumps(value, **form) + "\n").encode())


def _umask() -> int:
    # mkstemp makes private files; the only portable way to read the mask is to set it.
    mask = os.umask(0)
    os.umask(mask)
    return mask
