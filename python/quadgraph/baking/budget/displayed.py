"""The exitance of baked files on the displayed surface, against that of the whole mesh cut finer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.spatial import cKDTree

from quadgraph.baking.budget import finer_levels, surface_errors
from quadgraph.base.relative_error import relative_rms
from quadgraph.core import load_core

if TYPE_CHECKING:
    from quadgraph.core import Engine

TRUTH_TOLERANCE = 1e-4  # of errors of .3% and more
# The four triangles that one is cut into: their corners (4, 3) in its barycentric coordinates (3,).
_QUARTERS = 0.5 * np.array(
    [
        [[2, 0, 0], [1, 1, 0], [1, 0, 1]],
        [[1, 1, 0], [0, 2, 0], [0, 1, 1]],
        [[1, 0, 1], [0, 1, 1], [0, 0, 2]],
        [[1, 1, 0], [0, 1, 1], [1, 0, 1]],
    ]
)


@dataclass(frozen=True)
class Solved:
    """One solve of a file: what it was asked, and what it did.

    options: of Engine.solve; exitance: (n, 3) per displayed triangle, W/mm^2; cost: bytes that the passes of a frame
    under new light read and write, shadow maps apart, for these are the same on every file; time_ms: of those passes on
    the device; report: of Engine.solve.
    """

    options: dict[str, Any]
    exitance: np.ndarray
    cost: int
    time_ms: float
    report: dict[str, Any]


class DisplayedFile:
    """A baked file on the device, seen as its displayed triangles."""

    def __init__(self, path: Path, material: str, device: str = "") -> None:
        self._engine: Engine = load_core().Engine(path, device=device)
        self._engine.set_material(material)
        graph = self._engine.graph
        self.vertices = len(graph.levels[0].vertices)
        self.surface_vertices = graph.levels[0].surface_vertex_count
        self.levels = len(graph.levels)
        self._faces = np.asarray(graph.levels[0].faces)
        display = graph.display
        self._corners = np.asarray(display["triangles"])
        self._place = self._faces[np.asarray(display["face"])], np.asarray(display["barycentric"])

    def solve(self, lights: Sequence[str], **options: Any) -> Solved:
        """Solve from nothing under light that is taken for new."""
        self._engine.set_lights(list(lights))
        report = self._engine.solve(inter_reflection=False, **options)
        passes = [entry for entry in self._engine.passes if entry["name"] != "shadow maps"]
        return Solved(
            options,
            self._shown(),
            sum(entry["bytes"] for entry in passes),
            sum(entry["time_ms"] for entry in passes),
            report,
        )

    def _shown(self) -> np.ndarray:
        """Values at the corners of the file's own triangles, interpolated where the displayed ones have theirs."""
        found = np.asarray(self._engine.surface_field()["exitance"], np.float64)
        corners = finer_levels.at_corners(self._faces, found)
        index, weight = self._place
        return np.einsum("ij,ijc->ic", weight, corners[index])[self._corners].mean(axis=1)


@dataclass(frozen=True)
class DisplayedTruth:
    """Exitance on the displayed triangles, (n, 3) W/mm^2, their areas (n,) mm^2 and which are unlit (n,)."""

    exitance: np.ndarray
    area: np.ndarray
    unlit: np.ndarray

    def error(self, exitance: np.ndarray) -> dict[str, float]:
        """Relative RMS error of exitance (n, 3) by part, without the unlit one where it is small."""
        weights = surface_errors.weights_of(self.area, self.unlit)
        return {part: relative_rms(weight, exitance - self.exitance, self.exitance) for part, weight in weights.items()}


class Reference:
    """A whole mesh's own chain of levels, its finest `cuts` times cut in eight, as the truth on displayed triangles.

    path: a file that was baked from the whole mesh, so that its triangles are the displayed ones; folder: of this mesh
    alone, for the file that is cut, which is taken if it is there.
    """

    def __init__(self, path: Path, cuts: int, folder: Path, device: str = "") -> None:
        core = load_core()
        graph = core.load(path)
        corners = np.asarray(graph.display["vertices"], np.float64)[np.asarray(graph.display["triangles"])]
        cut = folder / f"cut-{cuts}.qgraph" if cuts else path
        if not cut.exists():
            finer_levels.refined(path, cuts, cut)
        self._engine: Engine = core.Engine(cut, device=device)
        finest = self._engine.graph.levels[0]
        self.surface_vertices = finest.surface_vertex_count
        self._pieces = _pieces(finest, corners, cuts)

    def truth(self, material: str, lights: Sequence[str]) -> DisplayedTruth:
        """Solve SP3, which is the nearer one to transport."""
        self._engine.set_material(material)
        self._engine.set_lights(list(lights))
        self._engine.solve(model="sp3", tolerance=TRUTH_TOLERANCE, inter_reflection=False)
        field = self._engine.surface_field()
        pieces = np.asarray(field["area"], np.float64)[self._pieces]
        area = pieces.sum(axis=1)
        exitance, q = (self._mean(pieces / area[:, None], field[name]) for name in ("exitance", "q"))
        return DisplayedTruth(exitance, area, surface_errors.unlit_part(area, q))

    def _mean(self, share: np.ndarray, values: np.ndarray) -> np.ndarray:
        return np.einsum("ij,ijc->ic", share, np.asarray(values, np.float64)[self._pieces])


def _pieces(level: Any, corners: np.ndarray, cuts: int) -> np.ndarray:
    """(n, 4^cuts) the faces of `level` that each triangle with these corners (n, 3, 3), mm, was cut into."""
    triangles = np.eye(3)[None]
    for _ in range(cuts):
        triangles = np.einsum("qkj,tjd->tqkd", _QUARTERS, triangles).reshape(-1, 3, 3)
    places = triangles.mean(axis=1)
    middles = np.asarray(level.vertices, np.float64)[np.asarray(level.faces)].mean(axis=1)
    wanted = np.einsum("pk,nkd->npd", places, corners)
    return cKDTree(middles).query(wanted.reshape(-1, 3))[1].reshape(len(corners), len(places))
