"""A scene's truths as they are stored, and all that is measured against them, found before anything is measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from quadgraph.base.cache_folder import cache_folder
from quadgraph.base.errors import InputError
from quadgraph.base.progress import ProgressCallback
from quadgraph_validation.base.study_folders import COMMITTED_TRUTH
from quadgraph_validation.bodies import scene_bakes, scene_meshes
from quadgraph_validation.bodies.scenes import StudyScene
from quadgraph_validation.chart import (  # noqa: F401  they register
    converging_method,
    dipole_method,
    engine_methods,
    path_method,
    traced_method,
    walked_method,
)
from quadgraph_validation.chart.chart_body import ChartBody
from quadgraph_validation.chart.chart_judge import ChartJudge, PdeTruths
from quadgraph_validation.chart.chart_method import ChartMethod, methods, pde_of, walks_judge
from quadgraph_validation.truth import pde_truth, scene_walks, truth_run
from quadgraph_validation.truth.stored_truth import StoredTruth
from quadgraph_validation.truth.truth_run import TracedSubject

# Only path tracing can judge them: as `bake` does by default, by the paper's mesher from fine to coarse, on a polygrid.
OTHER_BAKES = (
    scene_bakes.Choice(),
    *(scene_bakes.Choice(pde_truth.VERTICES, grading) for grading in (0.3, 1.0, 3.0)),
    scene_bakes.Choice(cells=4),
)


@dataclass(frozen=True)
class Folders:
    """Folders of mesh files, of path-traced pictures, and of PDE truths with their chains."""

    meshes: Path
    transport: Path
    pde: Path


def folders(meshes: Path, truth: Path | None) -> Folders:
    """The default ones, or one for all truths."""
    return Folders(meshes, truth or COMMITTED_TRUTH, truth or cache_folder())


def subject(
    scene: StudyScene,
    where: Folders,
    against: Sequence[str],
    wanted: Sequence[str],
    working: Path,
    device: str,
    pixels: int,
    tell: ProgressCallback,
) -> tuple[ChartBody, ChartJudge, list[ChartMethod]]:
    """A scene with its judge and its methods, those that `wanted` names.

    Bakes the chain if it is not there, and walks if that is not done; raises InputError if a truth in `against` is
    absent or stale.
    """
    original = truth_run.subject(scene, scene_meshes.file(scene, where.meshes)) if "transport" in against else None
    images = {} if original is None else _images(original, where)
    ways = OTHER_BAKES if {"transport", "walks"} & set(against) else ()
    others = {choice: scene_bakes.of(scene, choice, where.meshes, where.pde) for choice in ways}
    chain = pde_truth.chain(scene, where.meshes, where.pde)
    body = ChartBody(scene, chain, working, device, pixels, others, original)
    chosen = methods(body.chain, wanted)
    pde = _pde(scene, where, chosen) if "pde" in against else {}
    walked = "walks" in against and any(walks_judge(method.settings) for method in chosen)
    walks = scene_walks.made(scene, body.default_surface, where.pde, tell) if walked else None
    return body, ChartJudge(body, pde, images, walks), chosen


def _images(found: TracedSubject, where: Folders) -> dict[str, StoredTruth]:
    scene = found.scene
    images = {name: truth_run.stored(found, where.transport, name) for name in scene.images}
    for name, image in images.items():
        if image.batches < 2:
            command = f"quadgraph reference {scene.name} --kind transport --samples N"
            raise InputError(f"{found.path(where.transport, name)}: not there; '{command}' makes it with Mitsuba")
    return images


def _pde(scene: StudyScene, where: Folders, chosen: Sequence[ChartMethod]) -> PdeTruths:
    """Truths of the equations that methods solve, in their order."""
    judged = dict.fromkeys(equations for method in chosen if (equations := pde_of(method.settings)))
    return {
        (model, source): pde_truth.stored(scene, model, where.meshes, where.pde, source) for model, source in judged
    }
