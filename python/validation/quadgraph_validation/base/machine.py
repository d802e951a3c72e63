"""What a record was measured on."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path
from typing import Any

from quadgraph.base.version import __version__


def machine(copied: dict[str, Any]) -> dict[str, Any]:
    """What a record starts with: device, driver and copy bandwidth, cores and their load, commit and version."""
    return {
        "device": copied["device"],
        "driver": copied["driver"],
        "copy": {key: copied[key] for key in ("gb_per_s", "kernel", "transfer", "bytes")},
        "cores": os.cpu_count(),
        "load": round(os.getloadavg()[0], 1),
        "commit": commit(),
        "version": __version__,
    }


def commit() -> str:
    """Return the commit of the source tree with '-dirty' if it was changed, 'unknown' outside one.

    QUADGRAPH_COMMIT of the environment says it for programs that were carried elsewhere (tools/gpu).
    """
    if carried := os.environ.get("QUADGRAPH_COMMIT"):
        return carried
    command = ["git", "-C", str(Path(__file__).parent), "describe", "--always", "--dirty", "--abbrev=12"]
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True, timeout=10).stdout.strip()
    except (OSError, subprocess.SubprocessError):
        return "unknown"
