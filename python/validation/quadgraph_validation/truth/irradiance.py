"""Irradiance that a body's surface lets in, by casting rays at its own shadow: independent of the engine's maps."""

from __future__ import annotations

import numpy as np
import trimesh

from quadgraph.mesh.surface import Surface
from quadgraph.tets import exchange
from quadgraph.tets.graph import Graph
from quadgraph_validation.bodies.meshes import face_frames
from quadgraph_validation.bodies.scenes import StudyScene
from quadgraph_validation.truth.fresnel import entering_share, transmittance_from_outside

_LIFT = 1e-6  # of the body's size, by which rays start above their face
_RAYS_AT_ONCE = 1 << 20


class Occluder:
    """A closed surface that hides light from itself."""

    def __init__(self, surface: Surface) -> None:
        low, high = surface.vertices.min(axis=0), surface.vertices.max(axis=0)
        self._middle, self._lift = (low + high) / 2, _LIFT * float(np.linalg.norm(high - low))
        # Rays are cast in single precision: coordinates are kept small.
        self._mesh = trimesh.Trimesh(surface.vertices - self._middle, surface.triangles, process=False)

    def passes(self, points: np.ndarray, normals: np.ndarray, ways: np.ndarray) -> np.ndarray:
        """(n,) whether rays from (n, 3) points of the surface, with its outward normals, get away along (n, 3) ways.

        A ray whose first hit is from behind has slipped through the face that it began on.
        """
        origins = points - self._middle + self._lift * normals
        free = np.empty(len(points), bool)
        for begin in range(0, len(points), _RAYS_AT_ONCE):
            part = slice(begin, begin + _RAYS_AT_ONCE)
            hit = self._mesh.ray.intersects_first(origins[part], ways[part])
            behind = np.einsum("ij,ij->i", self._mesh.face_normals[hit], ways[part]) > 0
            free[part] = (hit < 0) | behind
        return free


def entering(scene: StudyScene, mesh: Graph, occluder: Occluder, parts: int, rays: int) -> np.ndarray:
    """q (n_f, 3) W/mm^2 that the outside faces of a mesh on the occluder's surface let in, a mean over each face.

    A beam's shadow is sampled at the middles of parts^2 similar triangles of every face; uniform light enters as it
    comes along `rays` cosine-weighted directions that do not meet the body.
    """
    if scene.direction is None:
        share = _sky(scene, mesh, occluder, rays)
    else:
        share = _beam(scene, scene.direction, mesh, occluder, parts)
    return np.repeat(share[:, None], 3, axis=1)


def _beam(
    scene: StudyScene, direction: tuple[float, float, float], mesh: Graph, occluder: Occluder, parts: int
) -> np.ndarray:
    normal = face_frames(mesh)[1]
    way = np.array(direction) / np.linalg.norm(direction)
    cosine = np.clip(-normal @ way, 0, 1)
    lit = np.flatnonzero(cosine > 0)
    weights = _middles(parts)
    points = np.einsum("pk,fki->fpi", weights, mesh.vertices[mesh.faces[lit]]).reshape(-1, 3)
    to_light = np.broadcast_to(-way, points.shape)
    free = occluder.passes(points, np.repeat(normal[lit], len(weights), axis=0), to_light)
    share = cosine * transmittance_from_outside(cosine, scene.eta)
    share[lit] *= free.reshape(-1, len(weights)).mean(axis=1)
    return share


def _sky(scene: StudyScene, mesh: Graph, occluder: Occluder, rays: int) -> np.ndarray:
    centre, normal, _ = face_frames(mesh)
    frames = exchange.frames(mesh.vertices, mesh.faces)
    share = np.empty(len(centre))
    step = max(1, _RAYS_AT_ONCE // rays)
    for begin in range(0, len(centre), step):
        faces = np.arange(begin, min(begin + step, len(centre)))
        ways = exchange.directions(frames[faces], faces, rays).reshape(-1, 3)
        points, normals = (np.repeat(values[faces], rays, axis=0) for values in (centre, normal))
        share[faces] = occluder.passes(points, normals, ways).reshape(-1, rays).mean(axis=1)
    return entering_share(True, scene.eta) * share


def _middles(parts: int) -> np.ndarray:
    """Barycentric coordinates (parts^2, 3) of the middles of the similar triangles that edges cut in `parts` make."""
    i, j = (index.ravel() for index in np.mgrid[:parts, :parts])
    upright, inverted = i + j < parts, i + j < parts - 1
    u = np.concatenate([i[upright] + 1 / 3, i[inverted] + 2 / 3]) / parts
    v = np.concatenate([j[upright] + 1 / 3, j[inverted] + 2 / 3]) / parts
    return np.column_stack([1 - u - v, u, v])
