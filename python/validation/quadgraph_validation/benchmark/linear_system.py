"""The linear system that the engine solves, as SciPy's matrices, and the exitance of its solutions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import csr_matrix, diags
from scipy.spatial import KDTree

from quadgraph.core import load_core
from quadgraph_validation.bodies.meshes import face_frames

if TYPE_CHECKING:
    from quadgraph.core import Engine, QuadGraph


@dataclass(frozen=True)
class System:
    """A x = b per channel: three matrices (n, n), b (n, 3) in W; faces (m, 3) and area (m,) mm^2 of the surface.

    Of linear elements with diffusion and the buried source: x is the fluence at the vertices, W/mm^2, k11 x the
    exitance.
    """

    matrices: list[csr_matrix]
    b: np.ndarray
    faces: np.ndarray
    area: np.ndarray
    k11: float

    def exitance(self, x: np.ndarray) -> np.ndarray:
        """At the faces, (m, k) W/mm^2, of x (n, k), k channels.

        What is below zero at a vertex counts as zero, and the rest pays for it, as in the engine.
        """
        raw = self.area @ x[self.faces].mean(axis=1)
        faces = np.maximum(x, 0)[self.faces].mean(axis=1)
        return self.k11 * faces * (raw / (self.area @ faces))

    def residual(self, x: np.ndarray, channel: int) -> float:
        """sqrt(r^T D^-1 r / b^T D^-1 b) of x (n,), D the diagonal: the norm of the engine's reports."""
        b, matrix = self.b[:, channel], self.matrices[channel]
        inverse = 1 / matrix.diagonal()
        r = b - matrix @ x
        return float(np.sqrt((r * inverse) @ r / ((b * inverse) @ b)))


def assemble(graph: QuadGraph, material: str, q: np.ndarray, direction: tuple[float, float, float]) -> System:
    """The system of level 0, in double precision, for irradiance q (m, 3) W/mm^2 along `direction` outside."""
    core = load_core()
    optical = core.Material(material)
    coefficients = (*core.evaluate_material(graph, 0, optical), optical.eta)
    rows = core.assemble(graph, 0, "fem", *coefficients, model="diffusion")
    b = core.buried_load(graph, 0, "fem", *coefficients, q, model="diffusion", direction=direction)
    n = len(rows["diagonal"])
    matrices = [
        csr_matrix((rows["weight"][:, c], rows["column"].astype(np.int32), rows["offset"].astype(np.int32)), (n, n))
        + diags(rows["diagonal"][:, c], format="csr")
        for c in range(3)
    ]
    k11 = core.boundary("fem", "buried", "diffusion", optical.eta)["k11"]
    level = graph.levels[0]
    return System(matrices, b, np.asarray(level.faces), face_frames(level)[2], k11)


def give_irradiance(engine: Engine, direction: tuple[float, float, float]) -> np.ndarray:
    """Replace the engine's light by what it lets in through each face of level 0, even over the face; that q (m, 3).

    The coarser levels get the mean of what lies nearest. So engine and `assemble` have the same right-hand side.
    """
    engine.solve(solver="dpcg", model="diffusion", inter_reflection=False)
    field = engine.surface_field()
    q = np.array(field["q"], np.float64)
    centre, power = field["position"], field["area"][:, None] * q
    for number, level in enumerate(engine.graph.levels):
        if number == 0:
            engine.set_irradiance(0, q, direction)
            continue
        middles, _, area = face_frames(level)
        nearest = KDTree(middles).query(centre)[1]
        collected = np.column_stack([np.bincount(nearest, column, len(middles)) for column in power.T])
        engine.set_irradiance(number, collected / area[:, None], direction)
    return q.astype(np.float32)
