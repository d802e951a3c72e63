"""The bunny that is there without the shared meshes."""

from __future__ import annotations

from pathlib import Path


def bunny_mesh() -> Path:
    """The Stanford bunny that pymeshlab brings along: 28 thousand vertices."""
    import pymeshlab

    return Path(pymeshlab.__file__).parent / "tests" / "sample_meshes" / "bunny.obj"
