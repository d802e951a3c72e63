"""How many threads the programs that begin meanwhile may have."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

_NAMES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "QUADGRAPH_THREADS")


@contextmanager
def limited_threads(count: int) -> Iterator[None]:
    """Have processes that begin meanwhile take so many threads each."""
    before = {name: os.environ.get(name) for name in _NAMES}
    os.environ.update(dict.fromkeys(_NAMES, str(count)))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
