"""Bodies that are given by a function which is negative inside, blended and meshed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import trimesh
from scipy import ndimage

from quadgraph.base.errors import InputError
from quadgraph.mesh import lod, repair
from quadgraph.mesh.surface import Surface
from quadgraph_validation.base import extra_module

# Signed distance, or what is like it near the surface, at points (..., 3).
Field = Callable[[np.ndarray], np.ndarray]


def least(a: np.ndarray, b: np.ndarray, blend: float) -> np.ndarray:
    """The smaller of both, rounded where they are within `blend` of each other."""
    near = np.maximum(blend - np.abs(a - b), 0) / blend
    return np.minimum(a, b) - near**2 * blend / 4


def capsule(start: np.ndarray, way: np.ndarray, length: float, thick: float, thin: float) -> Field:
    """A capsule along a unit vector, of one thickness where it starts and another at its end."""

    def field(p: np.ndarray) -> np.ndarray:
        along = np.clip((p - start) @ way / length, 0, 1)
        return np.linalg.norm(p - start - along[..., None] * length * way, axis=-1) - (thick + (thin - thick) * along)

    return field


def box(half: np.ndarray, edge: float, turn: np.ndarray) -> Field:
    """A turned box, `edge` larger than `half` says on all sides, by which it is rounded."""

    def field(p: np.ndarray) -> np.ndarray:
        beyond = np.abs(p @ turn) - half
        return np.linalg.norm(np.maximum(beyond, 0), axis=-1) + np.minimum(beyond.max(axis=-1), 0) - edge

    return field


def meshed(field: Field, half: float, cells: int) -> Any:
    """The largest piece without its cavities, in units of cells, by marching cubes, its steps smoothed away.

    half: of the box about the origin that the piece lies in; cells: along it. Raises InputError without scikit-image.
    """
    measure: Any = extra_module.load("skimage.measure", "walks")
    axis = np.linspace(-half, half, cells)
    value = field(np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1))
    label, count = ndimage.label(value < 0)
    sizes = ndimage.sum_labels(np.ones_like(value), label, np.arange(1, count + 1))
    solid = ndimage.binary_fill_holes(label == 1 + int(np.argmax(sizes)))
    value = np.where(solid, -np.abs(value), np.abs(value))
    value[:, :, [0, -1]] = value[:, [0, -1]] = value[[0, -1]] = 1
    corners, triangles, _, _ = measure.marching_cubes(value, 0.0, gradient_direction="ascent")
    mesh = trimesh.Trimesh(corners, triangles, process=True)
    return trimesh.smoothing.filter_taubin(mesh, iterations=10)


def valid(mesh: Any, triangles: int) -> Surface | None:
    """A surface of about so many triangles that a bake has nothing to repair in; None if there is none."""
    fine = Surface(np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces, np.int64))
    if fine.volume < 0:
        fine = Surface(fine.vertices, fine.triangles[:, ::-1])
    if not fine.is_closed_manifold or fine.components != 1:
        return None
    try:
        count = triangles // 2
        coarse = lod.simplify(fine, count) if count < 0.9 * len(fine.vertices) else fine
        repaired, done = repair.repair(coarse, "body")
    except InputError:
        return None
    return None if done else repaired
