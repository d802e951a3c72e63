"""Which files are meshes, by their names alone: commands ask this of every file, most of which are baked bodies."""

from __future__ import annotations

from pathlib import Path

SUFFIXES = (".obj", ".off", ".ply", ".stl", ".gltf", ".glb")  # mesh_io has a reader for each


def is_mesh(path: Path) -> bool:
    """Whether a file is a mesh, by its name."""
    return path.suffix.lower() in SUFFIXES
