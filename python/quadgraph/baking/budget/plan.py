"""A bake for an error: the fewest vertices, cycles and unknowns that keep it, found by measuring.

The whole mesh's own chain of levels is baked, and its finest level cut in eight: the truth, solved with SP3 and
corrected by sweeps of the transport equation. Levels of the chain, and then surfaces of sizes between them, are solved
with every model and number of cycles, where that does not do with sweeps, and held against it on the displayed
triangles, which counts relief that a simplified surface lacks as well as the error of the elements and of the model.
The error falls with the number of vertices, smoothly enough that three surfaces of chosen sizes are enough. What would
be cheaper and is so near to the error that this truth leaves it in doubt is held against a finer one.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from quadgraph.baking import pipeline
from quadgraph.baking.budget.displayed import DisplayedFile, DisplayedTruth, Reference
from quadgraph.baking.budget.trials import (
    MODELS,
    SWEEPS,
    BudgetScene,
    Forecast,
    Setting,
    Trial,
    assemble,
    forecast,
    known_share,
    measure,
    trial,
)
from quadgraph.baking.budget.usual_lights import lights as lights_around
from quadgraph.baking.pipeline import BakeOptions, Level, Prepared
from quadgraph.baking.report import BakeReport
from quadgraph.base.errors import InputError, ToolError
from quadgraph.base.progress import ProgressCallback
from quadgraph.core import load_core
from quadgraph.mesh import lod

MOST_VERTICES = 30000  # of the surface that stands for the whole mesh
LEAST_VERTICES = 150  # on a surface that a bake chooses
_LEAST_COARSEST = 6  # vertices on the last level of a chain that goes as deep as it can
_SHALLOW = 300  # vertices on the surface that one which does not ends below, if it has two levels then
AIM = 0.93  # share of the error that surfaces are chosen for
_ROUNDS = 3
_CLOSE = 1.1  # of the expected cost: what costs no more than this is not tried to be bettered
_STEPS, _STEP = 3, 0.8  # at most so many surfaces, each with this share of the vertices of the cheapest so far
_SAME = 0.03  # of the number of vertices: two surfaces nearer than this are one
_DOUBT = 1.03  # times the error: what was measured to have no more may keep it
_DOUBTS = 3  # so many are settled, the cheapest first
_SURE = 0.98  # core.MEASURED_SHARE by a truth that was cut twice
_MOST_CUT_TWICE = 1000  # vertices of a mesh that is
_NOISE = 0.2  # of the error, in the truth
DEEP = 2.0  # diffusion lengths: what lies deeper decides .1% of the whole exitance and .35% of the unlit one


class Bench:
    """The files of one bake, and what was measured on them."""

    def __init__(self, whole: Prepared, options: BakeOptions, scene: BudgetScene, folder: Path, device: str) -> None:
        self._whole, self._options, self.scene = whole, options, scene
        self._folder, self._device = folder, device
        self.candidates: dict[tuple[int, int], list[Level]] = {}  # by vertices on the surface and number of levels
        self.trials: list[Trial] = []
        self.models: Sequence[str] = MODELS
        self.sweeps = 0
        self._truths: dict[str, DisplayedTruth] = {}

    def find_truth(self, levels: list[Level], error: float, cuts: int = 1) -> None:
        """Find what settles an error: the truth of the levels of the whole mesh, refined `cuts` times."""
        path = self._written(levels, "whole.qgraph")
        reference = Reference(path, cuts, self._folder, self._device, self.rays)
        self.truth_vertices, self.swept_vertices = reference.surface_vertices, reference.swept_vertices
        for name, lights in self.scene.lights.items():
            self._truths[name] = reference.truth(self.scene.material, lights, _NOISE * error)

    def add(self, levels: list[Level]) -> list[Trial]:
        """Measure a candidate with all of its levels, and with as few as bring it down to a small one.

        Cycles that go down to a handful of vertices reduce the error of a thin body much faster; on others they do not.
        With sweeps, which cost far more than cycles, only the former.
        """
        found = []
        for depth in sorted({len(levels), len(levels) if self.sweeps else _shallow(levels)}):
            path = self._written(levels[:depth], "trial.qgraph")
            deep = depth == len(levels)
            how = (self.truth_vertices, self._device, self.models, deep, self.sweeps)
            found += measure(path, self.scene, self._truths, *how)
            self.candidates[found[-1].surface_vertices, depth] = levels[:depth]
        self.trials += found
        return found

    def judge(self, path: Path, setting: Setting) -> Trial:
        """Measure one setting on a file."""
        subject = DisplayedFile(path, self.scene.material, self._device)
        assemble(subject, self.scene, setting.model)
        known = known_share(subject, self.truth_vertices)
        return trial(subject, self.scene, self._truths, known, setting)

    def settle(self, doubtful: Sequence[Trial], error: float, finer: Bench) -> None:
        """Measure trials again, by the truth of another bench, until one keeps the error."""
        for old in doubtful:
            path = self._written(self.candidates[old.surface_vertices, old.levels], "trial.qgraph")
            new = replace(finer.judge(path, old.setting), share=_SURE)
            self.trials[self.trials.index(old)] = new
            if new.keeps(error):
                return

    @property
    def rays(self) -> int:
        """Per face, that find what faces see of each other."""
        return self._options.visibility_rays

    @property
    def truth_noise(self) -> float:
        """Of the truth under the light where it is largest."""
        return max(truth.noise for truth in self._truths.values())

    def _written(self, levels: list[Level], name: str) -> Path:
        report = BakeReport(str(self._folder / name))
        pipeline.write(self._whole, levels, self._options, report)
        return Path(report.output)

    def narrow(self, error: float) -> None:
        """Leave out of further candidates the models that keep the error on none."""
        kept = [model for model in MODELS if forecast([t for t in self.trials if t.model == model], error)]
        self.models = kept or MODELS

    def best(self, error: float) -> Trial | None:
        """The cheapest that was measured to have no more."""
        return min((t for t in self.trials if t.error <= error), key=lambda t: t.cost, default=None)

    def kept(self, error: float) -> Trial | None:
        """The cheapest that keeps it with certainty."""
        return min((t for t in self.trials if t.keeps(error)), key=lambda t: t.cost, default=None)

    def doubtful(self, error: float) -> list[Trial]:
        """What would be cheaper than that and may keep it, the cheapest first."""
        kept = self.kept(error)
        most = kept.cost if kept else np.inf
        found = [t for t in self.trials if not t.keeps(error) and t.error <= _DOUBT * error and t.cost < most]
        return sorted(found, key=lambda t: t.cost)[:_DOUBTS]


def bake_for(
    mesh: Path,
    output: Path,
    options: BakeOptions,
    error: float,
    material: str,
    lights: Sequence[str] = (),
    device: str = "",
    progress: ProgressCallback | None = None,
) -> BakeReport:
    """Bake `mesh` into `output` with no more than `error` needs, and report; `report.budget` tells what was measured.

    error: relative RMS of the exitance against transport in the whole mesh cut finer, the larger of the whole and the
    unlit surface, above 0 and below 1; material, lights: as the engine reads them, without lights some usual ones.
    Where no setting keeps the error the whole mesh is baked, and `report.budget["reached"]` is false. Raises
    InputError as quadgraph.baking.pipeline.bake does, and where `options` say what the error is to choose.
    """
    tell = progress or (lambda text: None)
    pipeline.check_options(output, options)
    _check(options, error)
    load_core().Material(material)
    report, start = BakeReport(str(output)), time.perf_counter()
    with pipeline.naming(mesh), tempfile.TemporaryDirectory(prefix="quadgraph-budget-") as folder:
        prepared = pipeline.prepare(mesh, options, report, tell)
        scene = _scene(prepared, material, lights)
        levels, budget = _planned(prepared, options, scene, error, Path(folder), device, report, tell)
        chosen = replace(options, surface_vertices=budget["surface_vertices"])
        pipeline.write(prepared, levels, chosen, report, budget)
    report.budget = budget
    report.seconds["total"] = time.perf_counter() - start
    return report


def _check(options: BakeOptions, error: float) -> None:
    if not 0 < error < 1:
        raise InputError(f"error: {error} found, allowed is above 0 and below 1")
    for name in ("surface_vertices", "levels", "refine"):
        if getattr(options, name):
            raise InputError(f"{name}: {getattr(options, name)} found, but an error is asked for, which chooses it")


def _scene(prepared: Prepared, material: str, lights: Sequence[str]) -> BudgetScene:
    if lights:
        return BudgetScene(material, {"given": list(lights)}, True)
    usual = {"usual": load_core().default_lights(front=prepared.front)}
    return BudgetScene(
        material, usual | {name: lights_around(name, prepared.surface.vertices) for name in ("sun", "lamp")}, False
    )


def _planned(
    prepared: Prepared,
    options: BakeOptions,
    scene: BudgetScene,
    error: float,
    folder: Path,
    device: str,
    report: BakeReport,
    tell: ProgressCallback,
) -> tuple[list[Level], dict[str, Any]]:
    whole = prepared
    if len(prepared.surface.vertices) > MOST_VERTICES:
        with report.timed("simplify"):
            whole = replace(prepared, surface=lod.simplify(prepared.surface, MOST_VERTICES))
    count = len(whole.surface.vertices)
    bench = Bench(whole, options, scene, folder, device)
    levels = _levels(whole, replace(options, levels=depth_of(count)), report)
    tell(f"error: solving the whole mesh, {count:,} vertices")
    with report.timed("error"):
        bench.find_truth(levels, error)
        for sweeps in SWEEPS:
            bench.sweeps = sweeps
            measure_chain(bench, levels, AIM * error, tell)
            if bench.best(AIM * error):
                break
        bench.narrow(AIM * error)
    predicted = _refine(bench, whole, options, error, report, tell)
    _descend(bench, whole, options, error, report, tell)
    if count <= _MOST_CUT_TWICE and (doubtful := bench.doubtful(error)):
        tell(f"error: {len(doubtful)} cheaper settings are in doubt, the truth is made finer")
        with report.timed("error"):
            finer = Bench(whole, options, scene, folder, device)
            finer.find_truth(levels, error, 2)
            bench.settle(doubtful, error, finer)
    chosen = bench.kept(error) or min(bench.trials, key=lambda t: (-t.surface_vertices, t.error))
    budget = _record(bench, chosen, predicted, len(prepared.surface.vertices), count, error)
    return bench.candidates[chosen.surface_vertices, chosen.levels], budget


def depth_of(vertices: int) -> int:
    """Levels of a chain that goes as deep as it can, below a surface of so many vertices."""
    return max(2, 1 + int(np.log(max(vertices / _LEAST_COARSEST, 1)) / np.log(4)))


def _shallow(levels: list[Level]) -> int:
    """The least number of levels that end below a small number of vertices, two where there are as many."""
    small = [number for number, level in enumerate(levels) if level.graph.surface_vertex_count < _SHALLOW]
    return min(max(2, 1 + small[0]) if small else len(levels), len(levels))


def _levels(whole: Prepared, options: BakeOptions, report: BakeReport) -> list[Level]:
    """Levels that may come to nothing: only their times are reported."""
    scratch = BakeReport(report.output)
    levels = pipeline.make_levels(whole.surface, options, scratch, lambda text: None)
    for stage, seconds in scratch.seconds.items():
        report.seconds[stage] = report.seconds.get(stage, 0) + seconds
    return levels


def measure_chain(bench: Bench, levels: list[Level], error: float, tell: ProgressCallback) -> None:
    """The levels of the whole mesh that have a coarser one; the finest only if it is needed."""
    for number in range(max(len(levels) - 2, 0), -1, -1):
        if number == 0 and bench.best(error):
            return
        _tell(bench.add(levels[number:]), tell)


def _tell(found: list[Trial], tell: ProgressCallback) -> None:
    for model in dict.fromkeys(t.model for t in found):
        least = min(t.error for t in found if t.model == model)
        tell(f"error: {found[0].surface_vertices:,} vertices, {model}: {least:.2%}")


def _refine(
    bench: Bench, whole: Prepared, options: BakeOptions, error: float, report: BakeReport, tell: ProgressCallback
) -> Forecast | None:
    """Bake and measure surfaces that are expected to keep the error; the first expectation, None if none is."""
    first = None
    for _ in range(_ROUNDS):
        expected = forecast(bench.trials, AIM * error)
        first = first or expected
        best = bench.kept(error)
        if expected is None or (best and best.cost <= _CLOSE * expected.cost):
            return first
        count = _apart(bench, max(round(expected.surface_vertices), LEAST_VERTICES))
        if count >= len(whole.surface.vertices) or not _sized(bench, whole, options, count, report, tell):
            return first
    return first


def _descend(
    bench: Bench, whole: Prepared, options: BakeOptions, error: float, report: BakeReport, tell: ProgressCallback
) -> None:
    """Bake and measure smaller surfaces than the cheapest's for as long as they keep the error at less cost.

    What a surface loses besides its number of vertices is of its own: expectations are a tenth off in the error.
    """
    for _ in range(_STEPS):
        best = bench.kept(error)
        if best is None:
            return
        count = round(_STEP * best.surface_vertices)
        if count < LEAST_VERTICES or count != _apart(bench, count):
            return
        if not _sized(bench, whole, options, count, report, tell) or bench.kept(error) is best:
            return


def _sized(
    bench: Bench, whole: Prepared, options: BakeOptions, count: int, report: BakeReport, tell: ProgressCallback
) -> bool:
    """Bake and measure a surface of so many vertices; false if it cannot be baked."""
    try:
        levels = _levels(whole, replace(options, surface_vertices=count, levels=depth_of(count)), report)
    except (InputError, ToolError) as refused:
        tell(f"error: {refused}")
        return False
    with report.timed("error"):
        _tell(bench.add(levels), tell)
    return True


def _apart(bench: Bench, count: int) -> int:
    """A number of vertices that has not been tried: more, if one that is as good as this one has been."""
    while any(abs(count / other - 1) < _SAME for other, _ in bench.candidates):
        count = round(count * (1 + 2 * _SAME))
    return count


def _record(
    bench: Bench, chosen: Trial, predicted: Forecast | None, vertices: int, judged: int, error: float
) -> dict[str, Any]:
    levels = bench.candidates[chosen.surface_vertices, chosen.levels]
    diffusion = [t for t in bench.trials if (t.model, t.sweeps) == ("diffusion", chosen.sweeps)]
    finest = max(t.surface_vertices for t in diffusion)
    return {
        "error": error,
        "reached": bool(chosen.keeps(error)),
        "measured": chosen.error,
        "errors": chosen.errors,
        "material": bench.scene.material,
        "lights": {name: list(texts) for name, texts in bench.scene.lights.items()},
        "lights_given": bench.scene.given,
        "model": chosen.model,
        "cycles": chosen.cycles,
        "sweeps": chosen.sweeps,
        "inter_reflection": bench.rays > 0,
        "cost_bytes": chosen.cost,
        "surface_vertices": chosen.surface_vertices,
        "levels": [level.graph.surface_vertex_count for level in levels],
        "mesh_vertices": vertices,
        "judged_vertices": judged,
        "truth_vertices": bench.truth_vertices,
        "swept_vertices": bench.swept_vertices,
        "truth_noise": bench.truth_noise,
        "predicted_vertices": None if predicted is None else predicted.surface_vertices,
        "diffusion_error": min(t.error for t in diffusion if t.surface_vertices == finest),
        "deep_share": _deep_share(levels[0], bench.scene.material),
        "trials": [trial.as_dict() for trial in bench.trials],
    }


def _deep_share(level: Level, material: str) -> float:
    """Share of a level's vertices deeper than DEEP diffusion lengths, where the light goes deepest."""
    coefficients = load_core().Material(material)
    sigma_tr = [np.sqrt(3 * a * (a + s)) for s, a in zip(coefficients.sigma_s_prime, coefficients.sigma_a, strict=True)]
    graph = level.graph
    surface, inner = np.split(graph.vertices, [graph.surface_vertex_count])
    if min(sigma_tr) == 0 or len(inner) == 0:
        return 0.0
    depth, _ = cKDTree(surface).query(inner)
    return float((depth > DEEP / min(sigma_tr)).sum() / len(graph.vertices))
