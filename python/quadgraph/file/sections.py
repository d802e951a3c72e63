"""From graphs, transfers and the display surface to the named arrays of a `.qgraph` file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from quadgraph.file.qgraph_file import QGraphFile
from quadgraph.mesh import display_map
from quadgraph.mesh.creases import parted
from quadgraph.mesh.looks.file_normals import COMPUTED, FoundNormals
from quadgraph.mesh.looks.normal_texture import NormalTexture
from quadgraph.mesh.surface import Surface
from quadgraph.tets import transfer
from quadgraph.tets.exchange import Seen
from quadgraph.tets.graph import Graph


def _u32(array: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(array, "<u4")


def _f32(array: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(array, "<f4")


def level(number: int, graph: Graph) -> dict[str, np.ndarray]:
    """Sections of one level, transfers excepted."""
    kinds = {} if graph.face_kinds is None else {f"level{number}/face_kinds": _u32(graph.face_kinds)}
    regions = {} if graph.regions is None else {f"level{number}/tet_bodies": np.ascontiguousarray(graph.regions, "u1")}
    grid = {} if graph.grid_links is None else {f"level{number}/grid_links": _u32(graph.grid_links)}
    always = {
        f"level{number}/vertices": _f32(graph.vertices),
        f"level{number}/tets": _u32(graph.tets),
        f"level{number}/faces": _u32(graph.faces),
        f"level{number}/face_tets": _u32(graph.face_tets),
        f"level{number}/links": _u32(graph.links),
        f"level{number}/nodes": _f32(graph.nodes),
    }
    return always | kinds | regions | grid


def transfers(number: int, fine: Graph, coarse: Graph) -> dict[str, np.ndarray]:
    """Sections that take values on level number + 1 (`coarse`) to level `number` (`fine`)."""
    kinds = {
        "inner": transfer.inverse_distance(fine.inner, coarse.inner, transfer.INNER_NODES),
        "surface": transfer.inverse_distance(fine.surface, coarse.surface, transfer.SURFACE_NODES),
        "barycentric": transfer.barycentric(fine.vertices, coarse),
    }
    sections = {}
    for kind, rows in kinds.items():
        sections[f"level{number}/{kind}_index"] = _u32(rows.index)
        sections[f"level{number}/{kind}_weight"] = _f32(rows.weight)
    return sections


def display(surface: Surface, finest: Graph, normals: FoundNormals = COMPUTED) -> dict[str, np.ndarray]:
    """Sections of the display mesh, tied to the outside faces of the finest level; normals: at its corners."""
    rounded = surface.rounded()
    face, coordinates = display_map.nearest_faces(rounded.vertices, finest.boundary)
    vertex, triangles, found = parted(surface, normals.at_corners, normals.parting)
    face, coordinates = display_map.faces_of_sides(face[vertex], coordinates[vertex], found, finest.boundary)
    return {
        "display/vertices": _f32(rounded.vertices[vertex]),
        "display/normals": _f32(found),
        "display/triangles": _u32(triangles),
        "display/face": _u32(face),
        "display/barycentric": _f32(coordinates),
    } | _texture(normals.texture, triangles, len(vertex))


def _texture(texture: NormalTexture | None, triangles: np.ndarray, count: int) -> dict[str, np.ndarray]:
    """Sections of a normal texture at the corners of triangles (m, 3) of `count` display vertices."""
    if texture is None:
        return {}
    places = np.zeros((count, 3))
    places[triangles] = texture.places
    return {
        "display/texture_places": _f32(places),
        "display/normal_texture": np.ascontiguousarray(texture.pixels.reshape(len(texture.pixels), -1), "u1"),
    }


def display_alone(surface: Surface, normals: np.ndarray, texture: NormalTexture | None = None) -> dict[str, np.ndarray]:
    """Sections of a file without levels; normals (n, 3), unit; texture: at the corners of its triangles."""
    return {
        "display/vertices": _f32(surface.vertices),
        "display/normals": _f32(normals),
        "display/triangles": _u32(surface.triangles),
    } | _texture(texture, surface.triangles, len(surface.vertices))


def exchange(seen: Seen) -> dict[str, np.ndarray]:
    """Sections of what the faces of one level see of each other."""
    prefix = f"level{seen.level}/seen"
    return {f"{prefix}_rays": _u32(np.array([seen.rays])), prefix: _u32(seen.table)}


def whole_file(
    graphs: Sequence[Graph], surface: Surface, seen: Seen | None = None, normals: FoundNormals = COMPUTED
) -> dict[str, np.ndarray]:
    """All sections but the metadata, in file order.

    graphs: finest first; surface: the display mesh; seen: what the faces of one of them see, None to leave it out;
    normals: at the corners of its triangles.
    """
    sections: dict[str, np.ndarray] = {}
    for number, graph in enumerate(graphs):
        sections |= level(number, graph)
        if seen is not None and seen.level == number:
            sections |= exchange(seen)
        if number + 1 < len(graphs):
            sections |= transfers(number, graph, graphs[number + 1])
    return sections | display(surface, graphs[0], normals)


def level_metadata(graph: Graph) -> dict[str, Any]:
    """What the metadata's `levels` tells about one level."""
    return {
        "vertices": len(graph.vertices),
        "surface_vertices": graph.surface_vertex_count,
        "tets": len(graph.tets),
        "faces": len(graph.faces),
        "volume_mm3": graph.volume,
        "area_mm2": graph.boundary.area,
    }


def read_exchange(file: QGraphFile) -> Seen | None:
    """What a file tells; None if it tells nothing."""
    for level in range(file.level_count):
        if f"level{level}/seen" in file.sections:
            rays = int(file.sections[f"level{level}/seen_rays"][0])
            return Seen(level, rays, file.sections[f"level{level}/seen"])
    return None
