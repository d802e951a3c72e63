"""The mesh files of scenes: of the shared folder, of an installed package, or generated."""

from __future__ import annotations

from pathlib import Path

import trimesh

from quadgraph.base import atomic_file
from quadgraph.base.cache_folder import cache_folder
from quadgraph_validation.bodies.scenes import Scene

_SUBDIVISIONS = 5  # 10,242 vertices


def file(scene: Scene, meshes: Path) -> Path:
    """The mesh file of a scene: `icosphere`, which is written to the default folder, `pymeshlab/NAME`, one of that
    package's samples, or a file of the folder `meshes`. It need not exist.
    """
    if scene.mesh == "icosphere":
        return _icosphere()
    package, _, name = scene.mesh.partition("/")
    if package == "pymeshlab":
        import pymeshlab

        return Path(pymeshlab.__file__).parent / "tests" / "sample_meshes" / name
    return meshes / scene.mesh


def _icosphere() -> Path:
    """A sphere of radius 1 as text, six decimals, so that its hash does not depend on the library that made it."""
    path = cache_folder() / f"icosphere-{_SUBDIVISIONS}.obj"
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        ball = trimesh.creation.icosphere(subdivisions=_SUBDIVISIONS)
        # Adding zero makes -0 and +0 one.
        lines = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in ball.vertices.round(6) + 0.0]
        lines += [f"f {a} {b} {c}" for a, b, c in ball.faces + 1]
        with atomic_file.replacing(path) as stream:
            stream.write(("\n".join(lines) + "\n").encode())
    return path
