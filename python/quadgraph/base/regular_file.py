"""Reading what may be no file: a pipe that nobody writes into would be waited for, a device never end."""

from __future__ import annotations

import errno
from pathlib import Path


def read_bytes(path: Path) -> bytes:
    """The bytes of a regular file, or of one that a link leads to. Raises OSError, also for all other kinds."""
    if path.exists() and not path.is_file() and not path.is_dir():
        raise OSError(errno.EINVAL, "no regular file", str(path))
    return path.read_bytes()
