"""Where the rays of a picture meet the body, and what a surface that is given there looks like, without the engine."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import trimesh

from quadgraph.mesh.surface import Surface
from quadgraph_validation.bodies.scenes import FOV, PIXELS, View, bounding_sphere, camera_axes
from quadgraph_validation.truth import fresnel

_SAMPLES = 2  # along either side of a pixel, as the engine has it


@dataclass(frozen=True)
class Hits:
    """First hits of a view's rays: triangle (PIXELS, PIXELS, 4) of the surface or -1, barycentric (.., 4, 3), and the
    cosine (.., 4) between its normal and the ray.
    """

    triangle: np.ndarray
    barycentric: np.ndarray
    cosine: np.ndarray

    def shown(self, triangles: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Pixel means (PIXELS, PIXELS, c) of values (n, c) at the vertices of triangles (n_t, 3), 0 beside the body."""
        corners = values[triangles[np.maximum(self.triangle, 0)]]
        at = np.einsum("hwsk,hwskc->hwsc", self.barycentric, corners)
        return np.where((self.triangle >= 0)[..., None], at, 0).mean(axis=2)

    def lambertian(self, triangles: np.ndarray, exitance: np.ndarray, eta: float) -> np.ndarray:
        """Radiance (PIXELS, PIXELS, c) W/(mm^2 sr) of an exitance (n, c) W/mm^2 that leaves as from a diffuser below a
        smooth surface: M F_t(mu) over the integral of F_t mu over the hemisphere.
        """
        leaving = fresnel.transmittance_from_outside(np.clip(self.cosine, 0, 1), eta)
        share = leaving / (np.pi * fresnel.entering_share(True, eta))
        corners = exitance[triangles[np.maximum(self.triangle, 0)]]
        at = np.einsum("hwsk,hwskc->hwsc", self.barycentric, corners) * share[..., None]
        return np.where((self.triangle >= 0)[..., None], at, 0).mean(axis=2)


def hits(surface: Surface, normals: np.ndarray, view: View) -> Hits:
    """Follow four rays a pixel to a surface with normals (n, 3) at its vertices."""
    right, up, backward = camera_axes(view)
    centre, _ = bounding_sphere(surface)
    count = _SAMPLES * PIXELS
    across = ((np.arange(count) + 0.5) / count * 2 - 1) * np.tan(np.radians(FOV) / 2)
    y, x = np.meshgrid(-across, across, indexing="ij")
    ways = x[..., None] * right + y[..., None] * up - backward
    ways = (ways / np.linalg.norm(ways, axis=-1, keepdims=True)).reshape(-1, 3)
    eye = centre + view.distance * backward
    mesh = trimesh.Trimesh(surface.vertices, surface.triangles, process=False)
    triangle = mesh.ray.intersects_first(np.broadcast_to(eye, ways.shape), ways)
    barycentric, cosine = np.zeros((len(ways), 3)), np.zeros(len(ways))
    met = triangle >= 0
    barycentric[met] = _where(eye, ways[met], surface.vertices[surface.triangles[triangle[met]]])
    normal = np.einsum("nk,nkx->nx", barycentric[met], normals[surface.triangles[triangle[met]]])
    cosine[met] = -(normal * ways[met]).sum(axis=1) / np.linalg.norm(normal, axis=1)
    return Hits(*(_by_pixel(values) for values in (triangle, barycentric, cosine)))


def _where(eye: np.ndarray, way: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Barycentric coordinates (n, 3) of where rays (n, 3) from the eye meet their triangles (n, 3, 3)."""
    u, v, offset = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], eye - corners[:, 0]
    p, q = np.cross(way, v), np.cross(offset, u)
    scale = (u * p).sum(axis=1)
    second, third = (offset * p).sum(axis=1) / scale, (way * q).sum(axis=1) / scale
    return np.stack([1 - second - third, second, third], axis=1)


def _by_pixel(values: np.ndarray) -> np.ndarray:
    rest = values.shape[1:]
    split = values.reshape(PIXELS, _SAMPLES, PIXELS, _SAMPLES, *rest)
    return np.moveaxis(split, 2, 1).reshape(PIXELS, PIXELS, _SAMPLES**2, *rest)
