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


@contextmanager
def replacing(path: Path) -> Iterator[BinaryIO]:
    """Give a stream under a temporary name beside `path`, which it becomes when the block ends well.

    Whatever interrupts the block, `path` is either untouched or complete. Raises InputError if it cannot be written.
    """
    outputs.check_kind(path)
    try:
        handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=".tmp")
        try:
            with os.fdopen(handle, "wb") as stream:
                yield stream
                stream.flush()
                os.fsync(stream.fileno())
                os.fchmod(stream.fileno(), 0o666 & ~umask())
            Path(temporary).replace(path)
        finally:
            with suppress(FileNotFoundError):
                Path(temporary).unlink()
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror})") from error


def write_json(path: Path, value: Any, dense: bool = False) -> None:
    """Write `value` as JSON, indented or without any space. Raises InputError if `path` cannot be written."""
    form = {"separators": (",", ":")} if dense else {"indent": 1}
    with replacing(path) as stream:
        stream.write((json.dumps(value, **form) + "\n").encode())


def umask() -> int:
    """Return the permissions that new files are not to have."""
    # mkstemp makes private files; the only portable way to read the mask is to set it.
    mask = os.umask(0)
    os.umask(mask)
    return mask
