"""Chains of meshes on the device, and the meshes that truth is found on."""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Callable, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from quadgraph.core import load_core
from quadgraph.file import graph_file
from quadgraph.mesh.surface import TetMesh
from quadgraph.tets import graph, refine
from quadgraph.tets.graph import Graph
from quadgraph_validation.bodies import meshes

if TYPE_CHECKING:
    from quadgraph.core import Engine, QuadGraph

# From points (n, 3) mm to sigma_s' and sigma_a (n,), 1/mm.
Medium = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
CHANNELS = 3
# Moves points (n, 3) mm.
Shape = Callable[[np.ndarray], np.ndarray]
# From centroids (n, 3) mm and outward unit normals (n, 3) of faces to what they let in, (n,) W/mm^2.
Irradiance = Callable[[np.ndarray, np.ndarray], np.ndarray]


def even(sigma_s_prime: float, sigma_a: float) -> Medium:
    """A homogeneous medium."""
    return lambda points: (np.full(len(points), sigma_s_prime), np.full(len(points), sigma_a))


class ScaledChain:
    """Levels of one body, finest first, on the device `device` (docs/devices.md).

    Raises as quadgraph.tets.graph.build and the engine do, at first use.
    """

    def __init__(self, graphs_of: Callable[[], Sequence[Graph]], device: str = "") -> None:
        self._graphs_of, self._device = graphs_of, device
        self._shape: Shape | None = None

    @cached_property
    def rest(self) -> list[Graph]:
        """The levels before anything moves them."""
        return list(self._graphs_of())

    @cached_property
    def graphs(self) -> list[Graph]:
        """The levels in their present shape."""
        return self.rest

    @cached_property
    def engine(self) -> Engine:
        """The levels on the device."""
        with tempfile.TemporaryDirectory(prefix="quadgraph-stability-") as folder:
            path = graph_file.write(Path(folder) / "chain.qgraph", self.rest)
            return load_core().Engine(path, device=self._device)

    def take(self, shape: Shape) -> None:
        """Move the vertices of all levels from rest. Raises InputError if that turns a tet inside out."""
        if shape is self._shape:
            return
        moved = [meshes.moved(level, shape) for level in self.rest]
        for number, level in enumerate(moved):
            self.engine.set_vertices(number, level.vertices)
        self.graphs, self._shape = moved, shape

    @property
    def area(self) -> np.ndarray:
        """(n,) mm^2 of the outside faces of the finest level, 0 where they reflect."""
        finest = self.graphs[0]
        area = meshes.face_frames(finest)[2]
        return area if finest.face_kinds is None else area * (finest.face_kinds == meshes.OPEN)

    def solve(
        self, medium: Medium, q: Irradiance, direction: tuple[float, float, float] | None, eta: float, **options: Any
    ) -> dict[str, Any]:
        """The engine's report. Raises InputError, SolverError."""
        for number, level in enumerate(self.graphs):
            centre, normal, _ = meshes.face_frames(level)
            scattering, absorption = (np.repeat(values[:, None], 3, axis=1) for values in medium(level.nodes))
            self.engine.set_optical(number, scattering, absorption, eta)
            self.engine.set_irradiance(number, np.repeat(q(centre, normal)[:, None], 3, axis=1), direction)
        return self.engine.solve(inter_reflection=False, **options)

    @property
    def exitance(self) -> np.ndarray:
        """(n,) W/mm^2 per outside face of the finest level, of the last solve; channels are all the same."""
        return np.asarray(self.engine.surface_field()["exitance"], np.float64)[:, 0]


class Fine:
    """A mesh with every tet cut in eight, `count` times, on the CPU: whose solution is held to be true.

    key: of the mesh, for what is kept of its solutions.
    """

    def __init__(self, coarse: Graph, count: int) -> None:
        self.coarse, self.count = coarse, count
        digest = hashlib.sha256(np.ascontiguousarray(coarse.vertices).tobytes())
        digest.update(np.ascontiguousarray(coarse.tets).tobytes())
        self.key = f"{digest.hexdigest()}-{count}"

    @cached_property
    def mesh(self) -> Graph:
        """The fine mesh, without walls."""
        mesh = self.coarse
        for _ in range(self.count):
            mesh = refine.refined(mesh)
        return mesh

    @property
    def entries(self) -> str:
        """How a device would store the entries of linear elements: "packed" or "plain"."""
        return load_core().entry_format(self._loaded, 0, "fem")

    @cached_property
    def _loaded(self) -> QuadGraph:
        with tempfile.TemporaryDirectory(prefix="quadgraph-stability-") as folder:
            return load_core().load(graph_file.write(Path(folder) / "fine.qgraph", [self.mesh]))

    def exitance(
        self,
        media: Sequence[Medium],
        q: Irradiance,
        direction: tuple,
        eta: float,
        source: str,
        model: str,
        stored: bool = False,
    ) -> np.ndarray:
        """(n, 3) W/mm^2: means over the coarse mesh's outside faces, with linear elements, a medium per channel; the
        last one of `media` for channels that are left.

        stored: with entries rounded as the device stores them.
        """
        media = [*media, *[media[-1]] * (CHANNELS - len(media))]
        optical = zip(*(medium(self.mesh.nodes) for medium in media), strict=True)
        sigma_s_prime, sigma_a = (np.column_stack(values) for values in optical)
        centre, normal, area = meshes.face_frames(self.mesh)
        light = np.repeat(q(centre, normal)[:, None], 3, axis=1)
        names = {"direction": direction, "source": source, "model": model, "stored": stored}
        result = load_core().solve_reference(self._loaded, 0, sigma_s_prime, sigma_a, eta, light, **names)
        return self._means(np.asarray(result["exitance"], np.float64), area)

    def _means(self, values: np.ndarray, area: np.ndarray) -> np.ndarray:
        """Over the faces that a face of the coarse mesh was cut into: they lie in children of its one tet."""
        tets = len(self.coarse.tets)
        face_of = np.full(tets, -1, np.int64)
        face_of[self.coarse.face_tets] = np.arange(len(self.coarse.faces))
        parent = face_of[self.mesh.face_tets % tets]
        whole = np.bincount(parent, area, len(self.coarse.faces))
        return np.column_stack([np.bincount(parent, area * column) / whole for column in values.T])


def graph_of(vertices: np.ndarray, tets: np.ndarray) -> Graph:
    """The graph of a level of a file; its tets keep their order."""
    return graph.build(TetMesh(np.asarray(vertices, np.float64), np.asarray(tets, np.int64)))
