"""Where what is costly to make is kept between runs."""

from __future__ import annotations

import os
from pathlib import Path


def cache_folder() -> Path:
    """Where what is costly to make is kept: $XDG_CACHE_HOME/quadgraph, else ~/.cache/quadgraph."""
    cache = os.environ.get("XDG_CACHE_HOME")
    return (Path(cache) if cache else Path.home() / ".cache") / "quadgraph"
