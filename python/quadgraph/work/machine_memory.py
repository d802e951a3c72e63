"""How much memory the programs of this machine, or of the container that they run in, may have."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

_CONTAINER = Path("/sys/fs/cgroup/memory.max")


def memory_bytes() -> int:
    """All of it."""
    found = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    with suppress(OSError, ValueError):  # without a container, or with "max"
        found = min(found, int(_CONTAINER.read_text()))
    return found
