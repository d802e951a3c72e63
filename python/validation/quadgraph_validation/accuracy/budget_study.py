"""Whether a bake for an error keeps it, and what it costs against the cheapest setting that a search finds."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pymeshlab
import trimesh
from rich.table import Table

from quadgraph.baking import pipeline
from quadgraph.baking.budget import plan
from quadgraph.baking.budget.displayed import DisplayedFile as File
from quadgraph.baking.budget.plan import Bench
from quadgraph.baking.budget.trials import BudgetScene, Setting, Trial, forecast
from quadgraph.baking.budget.usual_lights import lights
from quadgraph.baking.pipeline import BakeOptions, Level, Prepared
from quadgraph.baking.report import BakeReport
from quadgraph.mesh import lod, mesh_io, repair
from quadgraph_validation.bodies import level_chains
from quadgraph_validation.bodies.level_chains import ChainSubject

BUNNY = "pymeshlab/bunny.obj"  # bundled there
MOST_CUT_TWICE = 8000  # vertices of a body; the truth of larger ones is cut once
SPREAD = 2.0 ** np.array([-0.5, -0.25, 0.0, 0.25])  # numbers of vertices that are searched, around what is expected
ALTERNATIONS = 4  # of the chosen and the cheapest setting, when they are timed

SUBJECTS = (
    ChainSubject("spot", "spot.ply", 8, 3000),
    ChainSubject("fertility", "fertility.ply", 7, 3000),
    ChainSubject("igea", "igea.ply", 6, 3000),
    ChainSubject("armadillo", "armadillo.ply", 8, 3000),
    ChainSubject("twirl", "twirl.ply", 8, 3000),
    ChainSubject("fandisk", "fandisk.ply", 5, 3000),
    ChainSubject("gargoyle", "gargoyle.ply", 8, 3000),
    ChainSubject("bunny", BUNNY, 8, 3000),
    ChainSubject("sphere", "sphere", 6, detail=4),
    ChainSubject("torus", "torus", 3, detail=5),
    ChainSubject("coarse torus", "torus", 3, detail=4),
    ChainSubject("lobes", "lobes", 5, detail=4),
)


@dataclass(frozen=True)
class BudgetCase:
    """A subject's name, a material as the engine reads it, a name in judged.LIGHTS, and the error asked for."""

    subject: str
    material: str
    light: str
    error: float


CASES = (
    BudgetCase("spot", "skin1", "sun", 0.02),
    BudgetCase("spot", "marble", "sun and sky", 0.05),
    BudgetCase("fertility", "ketchup", "sun", 0.02),
    BudgetCase("fertility", "skin2", "lamp", 0.05),
    BudgetCase("igea", "skin1", "lamp", 0.02),
    BudgetCase("igea", "potato", "sun", 0.05),
    BudgetCase("armadillo", "ketchup", "near lamp and sky", 0.02),
    BudgetCase("armadillo", "skin1", "sun", 0.05),
    BudgetCase("twirl", "ketchup", "sun", 0.02),
    BudgetCase("twirl", "potato", "lamp", 0.05),
    BudgetCase("fandisk", "skin1", "sun", 0.05),
    BudgetCase("fandisk", "ketchup", "three", 0.02),
    BudgetCase("gargoyle", "chicken1", "sun", 0.05),
    BudgetCase("gargoyle", "wholemilk", "lamp", 0.05),
    BudgetCase("bunny", "skin1", "sun and sky", 0.02),
    BudgetCase("bunny", "apple", "lamp", 0.05),
    BudgetCase("sphere", "wholemilk", "sun", 0.02),
    BudgetCase("sphere", "ketchup", "lamp", 0.01),
    BudgetCase("torus", "ketchup", "lamp", 0.01),
    BudgetCase("coarse torus", "ketchup", "lamp", 0.01),  # whose mesh does not have it
    BudgetCase("lobes", "chicken2", "sun", 0.01),
)


def run(
    device: str, meshes: Path, names: list[str], tell: Callable[[dict[str, Any]], None] | None = None
) -> dict[str, Any]:
    """Bake and search for the cases of the named subjects, of all if there are none. meshes: folder of the mesh files.

    tell: called with every row as it is found. Raises InputError for an unknown name or a mesh that cannot be read.
    """
    rows = []
    for subject in level_chains.chosen(SUBJECTS, names):
        cases = [case for case in CASES if case.subject == subject.name]
        with tempfile.TemporaryDirectory(prefix="quadgraph-budget-study-") as folder:
            mesh = original(subject, meshes, Path(folder))
            for case in cases:
                rows.append(judge(mesh, subject.height, case, Path(folder), device))
                if tell:
                    tell(rows[-1])
    return record_of(rows)


def record_of(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """The record of a run with these rows."""
    return {"rows": rows}


def original(subject: ChainSubject, meshes: Path, folder: Path) -> Path:
    """Write the mesh that is taken for the whole one: with the subject's number of vertices."""
    path = folder / f"{subject.name}.ply"
    if subject.mesh in level_chains.SHAPES:
        level_chains.SHAPES[subject.mesh](subject.detail).export(path)
        return path
    source = meshes / subject.mesh
    if subject.mesh == BUNNY:
        source = Path(pymeshlab.__file__).parent / "tests/sample_meshes/bunny.obj"
    surface, _ = repair.repair(mesh_io.read_surface(source, height_mm=subject.height).surface, subject.name)
    if subject.vertices:
        surface = lod.simplify(surface, subject.vertices)
    trimesh.Trimesh(surface.vertices, surface.triangles, process=False).export(path)
    return path


def judge(mesh: Path, height: float, case: BudgetCase, folder: Path, device: str) -> dict[str, Any]:
    """Bake for the case's error, hold the file against a truth of its own, and search for cheaper settings."""
    options = BakeOptions(height_mm=height)
    output = folder / "chosen.qgraph"
    prepared = pipeline.prepare(mesh, options, BakeReport(""), lambda text: None)
    around = lights(case.light, prepared.surface.vertices)
    found = plan.bake_for(mesh, output, options, case.error, case.material, around, device)
    budget = found.budget
    assert budget is not None, "a bake for an error tells what it measured"
    scene = BudgetScene(case.material, {"given": around}, True)
    search = Search(prepared, options, scene, case.error, folder, device)
    search.bench.sweeps = budget["sweeps"]
    chosen = search.bench.judge(output, Setting(False, budget["model"], budget["cycles"], budget["sweeps"]))
    cheapest = search.cheapest(case.error, chosen)
    return asdict(case) | {
        "vertices": len(prepared.surface.vertices),
        "truth_vertices": search.bench.truth_vertices,
        "reached": budget["reached"],
        "measured": budget["measured"],
        "seconds": found.seconds["total"],
        "chosen": _facts(chosen),
        "cheapest": _facts(cheapest) if cheapest else None,
        "ratio": chosen.cost / cheapest.cost if cheapest else None,
        "time_ratio": search.time_ratio(output, chosen, cheapest) if cheapest else None,
        "searched": len(search.bench.trials),
    }


def _facts(trial: Trial) -> dict[str, Any]:
    return trial.as_dict() | {"errors": trial.errors["given"]}


class Search:
    """Settings and surfaces of one case, against the mesh cut once more often than the bake has it."""

    def __init__(
        self, whole: Prepared, options: BakeOptions, scene: BudgetScene, error: float, folder: Path, device: str
    ) -> None:
        self._whole, self._options = whole, options
        self._folder, self._device = folder, device
        count = len(whole.surface.vertices)
        self._chain = self._baked(levels=plan.depth_of(count))
        self.bench = Bench(whole, options, scene, folder, device)
        self.bench.find_truth(self._chain, error, 2 if count <= MOST_CUT_TWICE else 1)

    def cheapest(self, error: float, chosen: Trial) -> Trial | None:
        """The cheapest setting that keeps it: of the levels of the whole mesh's chain, of surfaces around what is to be
        expected of each model and around what was chosen, and of the best of them with every number of levels.
        """
        plan.measure_chain(self.bench, self._chain, error, lambda text: None)
        self.bench.narrow(error)
        for count in self._counts(error, chosen):
            self.bench.add(self._baked(surface_vertices=count, levels=plan.depth_of(count)))
        best = self.bench.best(error)
        if best:
            same = [levels for (count, _), levels in self.bench.candidates.items() if count == best.surface_vertices]
            self._vary_levels(max(same, key=len))
        return self.bench.best(error)

    def _counts(self, error: float, chosen: Trial) -> list[int]:
        """Numbers of vertices to try, no two within a tenth of each other."""
        middles: list[float] = [chosen.surface_vertices]
        for model in plan.MODELS:
            expected = forecast([t for t in self.bench.trials if t.model == model], error)
            middles += [expected.surface_vertices] if expected else []
        wanted = sorted({round(middle * factor) for middle in middles for factor in SPREAD})
        most = 0.8 * len(self._whole.surface.vertices)
        found: list[int] = []
        for count in wanted:
            if plan.LEAST_VERTICES <= count <= most and not (found and count < 1.1 * found[-1]):
                found.append(count)
        return found

    def _vary_levels(self, levels: list[Level]) -> None:
        """Measure the candidate with fewer levels than it has, where that was not done."""
        vertices = levels[0].graph.surface_vertex_count
        for depth in range(2, len(levels)):
            if (vertices, depth) not in self.bench.candidates:
                self.bench.add(levels[:depth])

    def _baked(self, **options: Any) -> list[Level]:
        return pipeline.make_levels(
            self._whole.surface, replace(self._options, **options), BakeReport(""), lambda text: None
        )

    def time_ratio(self, output: Path, chosen: Trial, cheapest: Trial) -> float:
        """Least device time of a frame under new light, of what was chosen over that of the cheapest, taken in turn."""
        rival = self._folder / "cheapest.qgraph"
        pipeline.write(
            self._whole,
            self.bench.candidates[cheapest.surface_vertices, cheapest.levels],
            self._options,
            BakeReport(str(rival)),
        )
        material, lights_given = self.bench.scene.material, self.bench.scene.lights["given"]
        files = [File(path, material, self._device) for path in (output, rival)]
        least = [np.inf, np.inf]
        for _ in range(ALTERNATIONS + 1):  # the first of each assembles
            for k, (file, trial) in enumerate(zip(files, (chosen, cheapest), strict=True)):
                solved = file.solve(lights_given, trial.sweeps, model=trial.model, cycles=trial.cycles)
                least[k] = min(least[k], solved.time_ms)
        return least[0] / least[1]


def tables(record: dict[str, Any]) -> list[Table]:
    """One row per case."""
    columns = (
        "body",
        "material",
        "light",
        "error",
        "kept",
        "setting",
        "true: whole, unlit",
        "cheapest",
        "cost",
        "time",
    )
    table = Table(*columns, title="bake --error")
    for row in record["rows"]:
        true = ", ".join(f"{error:.2%}" for error in row["chosen"]["errors"].values())
        kept = "yes" if max(row["chosen"]["errors"].values()) <= row["error"] else "no"
        ratios = [f"{row[key]:.2f}" if row[key] else "" for key in ("ratio", "time_ratio")]
        names = (row["subject"], row["material"], row["light"], f"{row['error']:.0%}")
        said = kept if row["reached"] else f"{kept}, out of reach"
        cheapest = _setting(row["cheapest"]) if row["cheapest"] else "none"
        table.add_row(*names, said, _setting(row["chosen"]), true, cheapest, *ratios)
    return [table]


def _setting(trial: dict[str, Any]) -> str:
    found = f"{trial['surface_vertices']:,}/{trial['levels']}, {trial['model']}, {trial['cycles']}"
    return found + (f", {trial['sweeps']} sweeps" if trial["sweeps"] else "")
