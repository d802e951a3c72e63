"""The colours of a mesh file as a volume of coefficients in the body that was baked of it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.ndimage import distance_transform_edt

from quadgraph import core
from quadgraph.api.materials import VolumeMaterial
from quadgraph.baking.colours.cells import AROUND, ColourGrid, grid_for
from quadgraph.baking.colours.colour_options import ColourOptions
from quadgraph.baking.colours.colour_report import ColourReport, report_of
from quadgraph.baking.colours.placed_mesh import PlacedMesh, place
from quadgraph.baking.colours.reflectances import coefficients
from quadgraph.baking.colours.surface_means import SurfaceMeans, surface_means
from quadgraph.base.units import DEFAULT_ETA
from quadgraph.mesh.display_map import closest_point_coordinates
from quadgraph.mesh.looks.parts import ColouredMesh
from quadgraph.mesh.looks.read_looks import read_looks

_PLATEAU = 0.5  # of the depth, down to which the colour is the surface's


def mesh_colours(
    mesh: str | Path, body: str | Path, options: ColourOptions | None = None
) -> tuple[VolumeMaterial, ColourReport]:
    """Return the colours of a mesh file as a material of the body that was baked of it, and what became of them.

    mesh: .glb, .gltf, .obj or .ply with textures, colours at vertices or of parts; body: the .qgraph of that mesh, or
    of another file of the same shape. A thick body of it shows the mesh's colours, by `Material.from_colour`; where
    glTF states a medium (KHR_materials_volume and what goes with it) that is taken: docs/materials.md, From the mesh
    file. Raises InputError naming file, field, what was found and what is allowed, FormatError for a broken body.
    """
    return volume_of(read_looks(Path(mesh)), Path(mesh), Path(body), options or ColourOptions())


def volume_of(looks: ColouredMesh, mesh: Path, body: Path, given: ColourOptions) -> tuple[VolumeMaterial, ColourReport]:
    """Do the same with a mesh file whose looks have been read."""
    placed = place(looks, mesh, body)
    graph = core.load(body)
    eta = _eta(placed, given)
    corners = np.asarray(graph.levels[0].vertices if graph.levels else graph.display["vertices"], np.float64)
    box = corners.min(axis=0), corners.max(axis=0)
    grid = grid_for(placed, *box, given.spacing, given.cells, given.base_depth)
    means = surface_means(placed, grid.spacing)
    scattering, absorption = _filled(placed, means, graph, grid, given, eta)
    shape = (*grid.counts[::-1], 3)
    made = VolumeMaterial(scattering.reshape(shape), absorption.reshape(shape), grid.spacing, grid.origin, eta)
    return made, report_of(placed, grid, means, eta)


def _filled(
    placed: PlacedMesh, means: SurfaceMeans, graph: core.QuadGraph, grid: ColourGrid, given: ColourOptions, eta: float
) -> list[np.ndarray]:
    """sigma_s_prime and sigma_a of all cells, (n, 3) float32 each, 1/mm."""
    points = grid.points()
    below = core.depths(graph, points)
    inside = below > -AROUND * grid.spacing
    share = _share_at(below, given.base_depth)
    found = [np.zeros((len(points), 3), np.float32) for _ in range(2)]
    if given.base is not None:
        rows = np.flatnonzero(inside & (share < 1))
        deep = core.material_at(core.Material(given.base), points[rows], np.maximum(below[rows], 0))
        for cell, value in zip(found, deep, strict=True):
            cell[rows] = value
    # What the file states of the inside goes down to the core, whatever lies below colours.
    stated = any(part.look.medium for part in placed.looks.parts)
    rows = np.flatnonzero(inside & (stated | (share > 0)))
    seen = _at_surface(placed, means, points[rows])
    own, upper = seen[:, 3:4], share[rows, None]
    colours = coefficients(seen[:, :3], given.paths, eta)
    for cell, colour, medium in zip(found, colours, (seen[:, 4:7], seen[:, 7:10]), strict=True):
        mixed = (1 - own) * (upper * colour + (1 - upper) * cell[rows]) + medium
        cell[rows] = np.clip(mixed, 0, core.COEFFICIENT_MAX)
    return [_continued(cell, inside, grid) for cell in found]


def _continued(cells: np.ndarray, inside: np.ndarray, grid: ColourGrid) -> np.ndarray:
    """Give cells (n, 3) that are not inside what the nearest has that is: nothing fades to nothing at the surface."""
    shape = grid.counts[::-1]
    nearest = distance_transform_edt(~inside.reshape(shape), return_distances=False, return_indices=True)
    return cells[np.ravel_multi_index(tuple(nearest.reshape(3, -1)), shape)]


def _share_at(below: np.ndarray, base: float | None) -> np.ndarray:
    """Share of the surface's colour at depths (n,), mm, where the base begins at `base` mm, if there is one."""
    if base is None:
        return np.ones(len(below), np.float32)
    t = np.clip((below / base - _PLATEAU) / (1 - _PLATEAU), 0, 1)
    return (1 - t * t * (3 - 2 * t)).astype(np.float32)


def _at_surface(placed: PlacedMesh, means: SurfaceMeans, points: np.ndarray) -> np.ndarray:
    """Mean values about the places of the surface that are nearest to points (n, 3), mm: (n, 10)."""
    surface = placed.surface
    face, _ = core.nearest_faces(surface.vertices, surface.triangles, points)
    corners = surface.corners[face]
    weights = closest_point_coordinates(points.astype(np.float64), corners)
    normals = surface.doubled_normals[face]
    normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), np.finfo(float).tiny)
    return means.about(np.einsum("nc,ncj->nj", weights, corners), normals)


def _eta(placed: PlacedMesh, given: ColourOptions) -> float:
    """What was asked for, else the file's of most of its surface, else the base's."""
    if given.eta is not None:
        return float(given.eta)
    said: dict[float, float] = {}
    for part, area in zip(placed.looks.parts, placed.part_areas, strict=True):
        if part.look.eta is not None:
            said[part.look.eta] = said.get(part.look.eta, 0.0) + float(area)
    if said:
        return max(said, key=lambda eta: said[eta])
    return DEFAULT_ETA if given.base is None else float(core.Material(given.base).eta)
