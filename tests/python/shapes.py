"""Surfaces made from formulae, and reading of trusted test meshes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pymeshlab
import trimesh

from quadgraph.mesh.surface import Surface


def pymeshlab_samples() -> Path:
    """The folder of sample meshes inside the pymeshlab package."""
    return Path(pymeshlab.__file__).parent / "tests" / "sample_meshes"


def from_trimesh(mesh: trimesh.Trimesh) -> Surface:
    """A trimesh as a Surface with float32 coordinates."""
    return Surface(np.array(mesh.vertices, np.float64), np.array(mesh.faces, np.int64)).rounded()


def read_ply(path: Path) -> Surface:
    """A mesh file as it is, taken as millimetres."""
    return from_trimesh(trimesh.load(path, process=False, force="mesh"))


def icosphere(subdivisions: int, radius: float = 1.0) -> Surface:
    """A sphere of 20 * 4**subdivisions triangles, mm."""
    return from_trimesh(trimesh.creation.icosphere(subdivisions=subdivisions, radius=radius))


def cube(edge: float = 1.0) -> Surface:
    """A cube of 12 triangles about the origin, mm."""
    return from_trimesh(trimesh.creation.box(extents=(edge, edge, edge)))


def torus(major: float = 10.0, minor: float = 3.0, around: int = 48, across: int = 24) -> Surface:
    """A torus about z, genus 1, mm."""
    return from_trimesh(
        trimesh.creation.torus(major_radius=major, minor_radius=minor, major_sections=around, minor_sections=across)
    )


def join(*surfaces: Surface) -> Surface:
    """Several surfaces as one, vertices kept apart."""
    offsets = np.cumsum([0] + [len(s.vertices) for s in surfaces])
    triangles = [s.triangles + offset for s, offset in zip(surfaces, offsets, strict=False)]
    return Surface(np.concatenate([s.vertices for s in surfaces]), np.concatenate(triangles))


def moved(surface: Surface, *offset: float) -> Surface:
    """The surface displaced by (x, y, z) mm."""
    return Surface(surface.vertices + np.array(offset), surface.triangles)


def write_obj(surface: Surface, path: Path) -> Path:
    """Write a surface, mm, with nine digits."""
    trimesh.Trimesh(surface.vertices, surface.triangles, process=False).export(path, digits=9)
    return path
