"""Answers of linear elements on a chain's finest mesh and on the meshes that cutting it uniformly makes."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from quadgraph.baking.budget import finer_levels
from quadgraph.file import qgraph_file
from quadgraph.mesh.surface import TetMesh
from quadgraph.tets import graph, refine
from quadgraph.tets.graph import Graph
from quadgraph_validation.bodies import meshes
from quadgraph_validation.bodies.scenes import StudyScene
from quadgraph_validation.truth import schemes
from quadgraph_validation.truth.interruptible import interruptible
from quadgraph_validation.truth.irradiance import Occluder, entering
from quadgraph_validation.truth.nested import nested
from quadgraph_validation.truth.schemes import Scheme, StudyLight

REFINEMENTS = 2
SKY_RAYS = 256  # from every face of the mesh that was cut once


class Ladder:
    """The meshes of a chain's body: number 0 is its finest, each further one has every tet of the last cut in eight.

    first: number 0. All answers are told on the outside faces of number 1: area (n,) mm^2; q (n, 3) W/mm^2 that they
    let in; corner (n, 3) vertices of the chain's finest surface around their middles, with barycentric coordinates
    weight (n, 3).
    """

    def __init__(self, scene: StudyScene, chain: Path) -> None:
        sections = qgraph_file.read(chain).sections
        vertices, faces = (sections[f"level0/{name}"] for name in ("vertices", "faces"))
        vertices, faces = vertices.astype(np.float64), faces.astype(np.int64)
        self._scene = scene
        self.first = graph.build(TetMesh(vertices, sections["level0/tets"].astype(np.int64)))
        self._occluder = Occluder(self.first.boundary)
        self._cut = refine.refined(self.first)
        place = nested(vertices, faces, self._cut.vertices, self._cut.faces)
        self.corner, self.weight = faces[place.parent], place.weight
        self.area = meshes.face_frames(self._cut)[2]
        self.q = self._entering(1)

    def exitance(self, number: int, scheme: Scheme) -> np.ndarray:
        """(n, 3) W/mm^2 from mesh `number`, 0 to REFINEMENTS. KeyboardInterrupt is heard at once.

        Raises SolverError.
        """
        first, cut = self.first, self._cut
        if number == 0:
            corners = finer_levels.at_corners(first.faces, self._solve(0, first, scheme))
            place = nested(first.vertices, first.faces, cut.vertices, cut.faces)
            return place.at_middles(first.faces, corners)
        if number == 1:
            return self._solve(1, cut, scheme)
        fine = interruptible(lambda: refine.refined(cut))
        place = nested(cut.vertices, cut.faces, fine.vertices, fine.faces)
        return place.means(meshes.face_frames(fine)[2], self._solve(2, fine, scheme), len(cut.faces))

    def _solve(self, number: int, mesh: Graph, scheme: Scheme) -> np.ndarray:
        coefficients = self._scene.in_channels(mesh.nodes)
        light = StudyLight(self.q if number == 1 else self._entering(number, mesh), self._scene.direction)
        body = schemes.on_reference(mesh)
        return interruptible(lambda: body.solve(*coefficients, self._scene.eta, light, scheme)).exitance

    def _entering(self, number: int, mesh: Graph | None = None) -> np.ndarray:
        # Every mesh gets the same points of the surface and as many rays of the sky.
        mesh = self._cut if mesh is None else mesh
        rays = int(SKY_RAYS * 4.0 ** (1 - number))
        return entering(self._scene, mesh, self._occluder, 2 ** (REFINEMENTS + 1 - number), rays)
