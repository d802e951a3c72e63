"""Truths as tasks: of a scene one of its images, or one of its equations."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Console

from quadgraph.work.finished_tasks import LEDGER
from quadgraph.work.schedulers import Scheduler
from quadgraph.work.task import Task
from quadgraph.work.task_run import run_tasks
from quadgraph_validation.bodies import scene_meshes, scenes
from quadgraph_validation.bodies.scenes import StudyScene
from quadgraph_validation.truth import pde_truth, truth_run
from quadgraph_validation.truth.truth_run import TracedSubject


def path_traced(subjects: Sequence[TracedSubject], folder: Path, samples: int, scheduler: Scheduler) -> None:
    """What `truth_run.render` does, its images spread over workers. Raises ToolError for images that failed."""
    folder = folder.absolute()
    tasks = []
    for found in subjects:
        given = {"scene": found.scene.name, "mesh": str(found.mesh), "folder": str(folder), "samples": samples}
        for image in found.scene.images:
            name, function = f"truth {found.scene.name} {image}", f"{__name__}:traced_image"
            written = (found.path(folder, image),)
            tasks.append(Task(name, function, given | {"image": image}, (found.mesh,), written))
    run_tasks(tasks, scheduler, folder / LEDGER)


def traced_image(scene: str, image: str, mesh: str, folder: str, samples: int) -> None:
    """Bring one image of a scene to so many samples a pixel."""
    (one,) = scenes.chosen([scene])
    found = truth_run.subject(one, Path(mesh))
    truth_run.render([found], Path(folder), samples, Console(stderr=True), [image])


def of_equations(
    wanted: Sequence[tuple[StudyScene, str, str]], meshes: Path, folder: Path, scheduler: Scheduler
) -> list[dict[str, Any]]:
    """What `equations` says of each scene, model and source. Raises ToolError for those that failed."""
    folder = folder.absolute()
    tasks = []
    for scene, model, source in wanted:
        given = {"scene": scene.name, "model": model, "source": source, "meshes": str(meshes), "folder": str(folder)}
        name, mesh = f"truth {scene.name} {model} {source}", scene_meshes.file(scene, meshes)
        written = (pde_truth.path_of(folder, scene, model, source),)
        tasks.append(Task(name, f"{__name__}:equations", given, (mesh,), written))
    return run_tasks(tasks, scheduler, folder / LEDGER)


def equations(scene: str, model: str, source: str, meshes: str, folder: str) -> dict[str, Any]:
    """Make the truth of a scene's equations; its steps and noise by part."""
    (one,) = scenes.chosen([scene])
    found = pde_truth.make(one, model, Path(meshes), Path(folder), Console(stderr=True), source)
    return {"steps": found.steps, "noise": found.noise}
