"""The engine on a baked chain of levels, against the truth that a finer level of the same chain stands for."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from quadgraph.baking.budget import finer_levels, surface_errors, usual_lights
from quadgraph.base.errors import InputError
from quadgraph.base.relative_error import relative_rms
from quadgraph.core import load_core
from quadgraph_validation.bodies import level_chains
from quadgraph_validation.bodies.level_chains import ChainSubject

if TYPE_CHECKING:
    from quadgraph.core import Engine, QuadGraph

TRUTH_TOLERANCE = 1e-4  # of errors of .1% and more


@dataclass(frozen=True)
class LevelCase:
    """A subject's name, a material and a model as the engine reads them, and a name in LIGHTS."""

    subject: str
    material: str
    light: str
    model: str = "auto"


class Judged:
    """A baked chain on the device: whole, with its finest level as the truth, and from each level that is judged.

    finer: of each judged level, the number of finer ones, each of which has four times the vertices of the next. None
    computes inter-reflection. Raises InputError if the chain is too short for a judged level to have a coarser
    one.
    """

    def __init__(self, path: Path, device: str, *finer: int) -> None:
        core = load_core()
        self.graph: QuadGraph = core.load(path)
        if len(self.graph.levels) < max(finer) + 2:
            raise InputError(f"{path}: {len(self.graph.levels)} levels found, at least {max(finer) + 2} needed")
        self._case: LevelCase | None = None
        self._fine: Engine = core.Engine(path, device=device)
        self._coarse: dict[int, Engine] = {}
        for count in finer:
            rest = level_chains.without_finest(path, count, path.with_name(f"{path.stem}-{count}.qgraph"))
            self._coarse[count] = core.Engine(rest, device=device)

    def vertices_of(self, level: int) -> int:
        """Vertices on the surface of a level of the whole chain."""
        return self.graph.levels[level].surface_vertex_count

    def light(self, case: LevelCase) -> None:
        """Set the case's material and lights on all, and find the truth."""
        for engine in (self._fine, *self._coarse.values()):
            engine.set_material(case.material)
            engine.set_lights(usual_lights.lights(case.light, np.asarray(self.graph.levels[0].vertices)))
        self._fine.solve(model=case.model, tolerance=TRUTH_TOLERANCE, inter_reflection=False)
        self._case = case

    def solve(self, finer: int, **options: Any) -> dict[str, Any]:
        """The engine's report of a solve from the judged level with so many finer ones down."""
        assert self._case is not None, "`light` comes before `solve`"
        return self._coarse[finer].solve(model=self._case.model, inter_reflection=False, **options)

    def true_error(self, finer: int, finest: int = 0) -> dict[str, float]:
        """Relative RMS error of that level's last solve's exitance by part, those of too small a share of the area left
        out.

        finest: the level below the judged one that was solved last. Where errors halve from level to level and are not
        correlated, the truth's own mesh hides a share of 4^-(levels between) of the square, which is put back.
        """
        levels, truth = self.graph.levels, self._fine.surface_field()
        found = np.asarray(self._coarse[finer].surface_field()["exitance"], np.float64)
        corners = finer_levels.at_corners(np.asarray(levels[finer].faces), found)
        difference = truth["exitance"] - level_chains.carried(levels, corners, finer)
        hidden = 4.0 ** -(finer + finest)
        parts = surface_errors.weights(np.asarray(truth["area"], np.float64), truth["q"])
        return {
            part: relative_rms(weight, difference, truth["exitance"]) / np.sqrt(1 - hidden)
            for part, weight in parts.items()
        }


Body = TypeVar("Body")


def judged(
    subjects: Sequence[ChainSubject],
    cases: Sequence[LevelCase],
    meshes: Path,
    body_of: Callable[[Path], Body],
    rows_of: Callable[[Body, LevelCase], list[dict[str, Any]]],
) -> list[dict[str, Any]]:
    """Bake each subject with mesh files from the folder `meshes`, and collect the rows of its cases.

    body_of: from the baked file, in a folder that does not outlive the subject. Raises InputError for a mesh that
    cannot be read.
    """
    rows = []
    for subject in subjects:
        with tempfile.TemporaryDirectory(prefix="quadgraph-study-") as folder:
            body = body_of(level_chains.baked(subject, meshes, Path(folder)))
            for case in cases:
                if case.subject == subject.name:
                    rows += rows_of(body, case)
    return rows
