"""Bodies that stand in for those of the polygrid paper, none of which could be had but the bunny."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import trimesh

from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph.base.errors import InputError
from quadgraph.base.version import __version__
from quadgraph.mesh import mesh_io
from quadgraph.mesh.surface import Surface
from quadgraph_validation.base import store
from quadgraph_validation.bodies import generated_shapes
from quadgraph_validation.bodies.bunny import bunny_mesh
from quadgraph_validation.tables.table_bodies import scaled

_FACES = 20_000  # of a generated body


@dataclass(frozen=True)
class PolygridBody:
    """paper: its row of Table III; mesh: a file of the folder of meshes, "bunny" or a name in shapes.GENERATED; cubes
    along its longest side and cells along a cube's.
    """

    paper: str
    name: str
    mesh: str
    cubes: int
    cells: int


# The paper's number of cubes where the cells are then few enough for a processor.
ALL = (
    PolygridBody("Bunny", "bunny", "bunny", 10, 4),
    PolygridBody("Bust", "igea", "igea.ply", 4, 8),
    PolygridBody("Bird", "spot", "spot.ply", 9, 4),
    PolygridBody("Hole", "donut", "donut", 8, 4),
    PolygridBody("Snail", "gargoyle", "gargoyle.ply", 8, 4),
)


def chosen(names: Sequence[str], meshes: Path) -> list[PolygridBody]:
    """Those of that row or name, all without any, whose mesh files are there. Raises InputError for an unknown name."""
    for name in names:
        if not any(name in (body.paper, body.name) for body in ALL):
            raise InputError(f"body {name}: not known; they are {', '.join(body.name for body in ALL)}")
    wanted = [body for body in ALL if not names or {body.paper, body.name} & set(names)]
    present = [body for body in wanted if not body.mesh.endswith(".ply") or (meshes / body.mesh).is_file()]
    if not present:
        raise InputError(f"--meshes {meshes}: has none of {', '.join(body.mesh for body in wanted)}")
    return present


def baked(body: PolygridBody, meshes: Path, folder: Path) -> Path:
    """Its file in `folder`, made if it is not there. Raises as quadgraph.baking.pipeline.bake does."""
    surface = _surface(body, meshes)
    digest = hashlib.sha256(surface.vertices.tobytes() + f"{body}{__version__}".encode()).hexdigest()

    def make(working: Path) -> None:
        mesh = working.with_suffix(".ply")
        try:
            trimesh.Trimesh(surface.vertices, surface.triangles, process=False).export(mesh)
            bake(mesh, working, BakeOptions(unit="mm", mesher="polygrid", cubes=body.cubes, cells=body.cells))
        finally:
            mesh.unlink(missing_ok=True)

    return store.kept(folder / f"{body.name}-{digest[:12]}.qgraph", make)


def _surface(body: PolygridBody, meshes: Path) -> Surface:
    if body.mesh in generated_shapes.GENERATED:
        return scaled(generated_shapes.smooth(body.mesh, _FACES))
    path = bunny_mesh() if body.mesh == "bunny" else meshes / body.mesh
    return scaled(mesh_io.read_surface(path, unit="mm").surface)
