"""The exitance of baked files on the displayed surface, against transport in the whole mesh cut finer."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.spatial import cKDTree

from quadgraph.baking.budget import finer_levels, surface_errors
from quadgraph.base.errors import InputError
from quadgraph.base.relative_error import relative_rms
from quadgraph.core import load_core
from quadgraph.mesh.patches import patches_of
from quadgraph.mesh.surface import Surface

if TYPE_CHECKING:
    from quadgraph.core import Engine

TRUTH_TOLERANCE = 1e-4  # of errors of .3% and more
_TRUTH_SWEEPS, _MOST_SEEDS = 3, 8
_MOST_SWEPT = 16000  # vertices on a surface that is cut for sweeps
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

    options: of Engine.solve; exitance, plain: (n, 3) per displayed triangle, W/mm^2, with all sweeps and without any;
    cost: bytes that the passes of a frame under new light read and write, shadow maps apart, for these are the same on
    every file; time_ms: of those passes on the device; report: of Engine.solve.
    """

    options: dict[str, Any]
    exitance: np.ndarray
    plain: np.ndarray
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
        faces = np.asarray(graph.levels[0].faces)
        self._values = finer_levels.CornerValues(faces)
        display = graph.display
        self._corners = np.asarray(display["triangles"])
        self._place = faces[np.asarray(display["face"])], np.asarray(display["barycentric"])

    def solve(self, lights: Sequence[str], sweeps: int = 0, **options: Any) -> Solved:
        """Solve from nothing under light that is taken for new, and with sweeps once more without."""
        self._engine.set_lights(list(lights))
        report = self._engine.solve(**options)
        plain = found = self._shown()
        if sweeps:
            self._engine.set_lights(list(lights))
            report = self._engine.solve(correction=True, sweeps=sweeps, **options)
            found = self._shown()
        passes = [entry for entry in self._engine.passes if entry["name"] != "shadow maps"]
        cost, time_ms = (sum(entry[name] for entry in passes) for name in ("bytes", "time_ms"))
        return Solved(options, found, plain, cost, time_ms, report)

    def _shown(self) -> np.ndarray:
        """Values at the corners of the file's own triangles, interpolated where the displayed ones have theirs."""
        found = np.asarray(self._engine.surface_field()["exitance"], np.float64)
        corners = self._values.of(found)
        index, weight = self._place
        return np.einsum("ij,ijc->ic", weight, corners[index])[self._corners].mean(axis=1)


@dataclass(frozen=True)
class DisplayedTruth:
    """What the displayed triangles are held against.

    exitance, plain: (n, 3) W/mm^2 of transport and of SP3 alone; area: (n,) mm^2; unlit: (n,) bool; patch: (n,) of each
    triangle, by which what is sampled is averaged, none across the edge of the unlit part; noise: relative, of what is
    averaged.
    """

    exitance: np.ndarray
    plain: np.ndarray
    area: np.ndarray
    unlit: np.ndarray
    patch: np.ndarray
    noise: float

    def error(self, found: Solved) -> dict[str, float]:
        """Relative RMS error of an exitance by part, without the unlit one where it is small.

        Means over patches are held against transport; what varies within them, before any sweep, against SP3, of which
        nothing is sampled.
        """
        relief = found.plain - self.plain
        difference = self._mean(found.exitance - self.exitance) + relief - self._mean(relief)
        weights = surface_errors.weights_of(self.area, self.unlit)
        return {part: relative_rms(weight, difference, self.exitance) for part, weight in weights.items()}

    def _mean(self, values: np.ndarray) -> np.ndarray:
        sums = np.stack([np.bincount(self.patch, self.area * column) for column in values.T], axis=1)
        return (sums / np.bincount(self.patch, self.area)[:, None])[self.patch]


class _CutMesh:
    """A whole mesh's own chain of levels, its finest `cuts` times cut in eight, seen as the displayed triangles."""

    def __init__(self, path: Path, cuts: int, folder: Path, device: str, rays: int) -> None:
        core = load_core()
        display = core.load(path).display
        self.corners = np.asarray(display["vertices"], np.float64)[np.asarray(display["triangles"])]
        cut = folder / f"cut-{cuts}.qgraph" if cuts else path
        if not cut.exists():
            finer_levels.refined(path, cuts, cut, rays)
        self._engine: Engine = core.Engine(cut, device=device)
        finest = self._engine.graph.levels[0]
        self.surface_vertices = finest.surface_vertex_count
        self._pieces = _pieces(finest, self.corners, cuts)

    def light(self, material: str, lights: Sequence[str]) -> None:
        self._engine.set_material(material)
        self._engine.set_lights(list(lights))

    def solve(self, **options: Any) -> dict[str, Any]:
        """Solve SP3, on the finest level; the report of Engine.solve."""
        return self._engine.solve(model="sp3", tolerance=TRUTH_TOLERANCE, **options)

    @property
    def area(self) -> np.ndarray:
        """(n,) mm^2 of the triangles."""
        return self._of_pieces("area").sum(axis=1)

    def shown(self, field: str) -> np.ndarray:
        """(n, 3) means of a surface field of the last solve over the triangles."""
        area = self._of_pieces("area")
        return np.einsum("ij,ijc->ic", area / area.sum(axis=1)[:, None], self._of_pieces(field))

    def _of_pieces(self, field: str) -> np.ndarray:
        return np.asarray(self._engine.surface_field()[field], np.float64)[self._pieces]


class Reference:
    """The whole mesh cut finer, as the truth on the displayed triangles.

    path: a file that was baked from the whole mesh, so that its triangles are the displayed ones; cuts: how often its
    tets are cut in eight for SP3, and for the sweeps, which mend most of what a mesh leaves, where that has no more
    than some vertices; folder: of this mesh alone, for files that are cut, which are taken if they are there; rays: per
    face, that find what faces see of each other, 0 for none.
    """

    def __init__(self, path: Path, cuts: int, folder: Path, device: str = "", rays: int = 0) -> None:
        self._fine = _CutMesh(path, cuts, folder, device, rays)
        self.surface_vertices = self._fine.surface_vertices
        small = self.surface_vertices <= _MOST_SWEPT
        self._swept = self._fine if small else _CutMesh(path, 0, folder, device, rays)
        self.swept_vertices = self._swept.surface_vertices
        self._patch = patches_of(_surface_of(self._fine.corners))

    def truth(self, material: str, lights: Sequence[str], noise: float) -> DisplayedTruth:
        """Solve SP3 and correct it by sweeps of one seed after the other, until no more than `noise` is left.

        Raises InputError where all is dark.
        """
        self._fine.light(material, lights)
        self._fine.solve()
        area, plain, q = self._fine.area, self._fine.shown("exitance"), self._fine.shown("q")
        if not plain.any():
            raise InputError(f"light {', '.join(lights)}: nothing leaves the body, which has no error then")
        unlit = surface_errors.unlit_part(area, q)
        self._swept.light(material, lights)
        exitance, left = self._transport(surface_errors.weights_of(area, unlit), noise)
        patch = np.unique(2 * self._patch + unlit, return_inverse=True)[1]
        return DisplayedTruth(exitance, plain, area, unlit, patch, left)

    def _transport(self, parts: Iterable[str], wanted: float) -> tuple[np.ndarray, float]:
        """The mean over seeds, none of them that of the solves that are held against it, and its noise."""
        found: list[np.ndarray] = []
        left = np.inf
        while len(found) < _MOST_SEEDS and left > wanted:
            report = self._swept.solve(correction=True, sweeps=_TRUTH_SWEEPS, sweep_seed=1 + len(found))
            found.append(self._swept.shown("exitance"))
            noise = report["correction"]["sweeps"][-1]["noise"]
            left = max(noise[part] for part in parts) / np.sqrt(len(found))
        return np.mean(found, axis=0), float(left)


def _surface_of(corners: np.ndarray) -> Surface:
    """Triangles that have nothing in common, of corners (n, 3, 3)."""
    return Surface(corners.reshape(-1, 3), np.arange(corners.size // 3).reshape(-1, 3))


def _pieces(level: Any, corners: np.ndarray, cuts: int) -> np.ndarray:
    """(n, 4^cuts) the faces of `level` that each triangle with these corners (n, 3, 3), mm, was cut into."""
    triangles = np.eye(3)[None]
    for _ in range(cuts):
        triangles = np.einsum("qkj,tjd->tqkd", _QUARTERS, triangles).reshape(-1, 3, 3)
    places = triangles.mean(axis=1)
    middles = np.asarray(level.vertices, np.float64)[np.asarray(level.faces)].mean(axis=1)
    wanted = np.einsum("pk,nkd->npd", places, corners)
    return cKDTree(middles).query(wanted.reshape(-1, 3))[1].reshape(len(corners), len(places))
