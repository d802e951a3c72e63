"""Folders that studies read: of scenes' mesh files, and of the pictures that come with the repository."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

# Path-traced pictures that come with the repository.
COMMITTED_TRUTH = Path("docs/benchmarks/truth")


def shared_meshes() -> Path:
    """The folder in which scenes' mesh files are looked for by default."""
    return Path(os.environ.get("QUADGRAPH_SHARED", "../shared")) / "meshes"


def add_meshes_argument(group: argparse._ActionsContainer) -> None:
    """Add the folder of scenes' mesh files."""
    group.add_argument(
        "--meshes",
        type=Path,
        default=shared_meshes(),
        metavar="FOLDER",
        help="of the mesh files (default: %(default)s)",
    )
