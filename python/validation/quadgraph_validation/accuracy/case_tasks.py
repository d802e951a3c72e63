"""Studies of bodies and of balls as tasks: of each all that is judged of it."""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

from quadgraph.base.cache_folder import cache_folder
from quadgraph.work.finished_tasks import LEDGER
from quadgraph.work.schedulers import Scheduler
from quadgraph.work.task import Task
from quadgraph.work.task_run import run_tasks
from quadgraph_validation.accuracy import scenes_study
from quadgraph_validation.accuracy.kept_rows import Row
from quadgraph_validation.bodies import level_chains
from quadgraph_validation.truth import schemes


def of_bodies(study: str, device: str, meshes: Path, names: Sequence[str], scheduler: Scheduler) -> dict[str, Any]:
    """The record of a study's `run`, by its module, its SUBJECTS spread over workers. Raises InputError, and ToolError
    for bodies that failed.
    """
    module, tasks = _module(study), []
    for subject in level_chains.chosen(module.SUBJECTS, names):
        given = {"study": study, "device": device, "meshes": str(meshes), "name": subject.name}
        reads = tuple(path for path in (meshes / subject.mesh,) if path.is_file())
        tasks.append(Task(f"{study} {subject.name}", f"{__name__}:body_rows", given, reads))
    return module.record_of(_joined(tasks, scheduler))


def body_rows(study: str, device: str, meshes: str, name: str) -> list[Row]:
    """The rows of a body."""
    return _module(study).run(device, Path(meshes), [name])["rows"]


def of_cases(study: str, scheduler: Scheduler, **options: str) -> dict[str, Any]:
    """The record of a study's `run`, its CASES, tuples of numbers and words, over workers. options: of its `rows_of`.

    Raises ToolError for cases that failed.
    """
    return _of_cases(study, "case_rows", {"options": options}, scheduler)


def of_solved_cases(study: str, device: str, reference: bool, scheduler: Scheduler) -> dict[str, Any]:
    """As `of_cases`, of a study whose rows take bodies that are solved. device, reference: as `schemes.chosen` has
    them.
    """
    return _of_cases(study, "solved_rows", {"device": device, "reference": reference}, scheduler)


def _of_cases(study: str, function: str, given: Mapping[str, Any], scheduler: Scheduler) -> dict[str, Any]:
    module, tasks = _module(study), []
    for case in module.CASES:
        name = " ".join([study, *(part if isinstance(part, str) else f"{part:g}" for part in case)])
        tasks.append(Task(name, f"{__name__}:{function}", {"study": study, "case": list(case), **given}))
    return module.record_of(_joined(tasks, scheduler))


def solved_rows(study: str, case: Sequence[Any], device: str, reference: bool) -> list[Row]:
    """The rows of a case, with bodies that are solved for it."""
    return _module(study).rows_of(tuple(case), schemes.chosen(device, reference))


def case_rows(study: str, case: Sequence[Any], options: Mapping[str, str]) -> list[Row]:
    """The rows of a case."""
    return _module(study).rows_of(tuple(case), **options)


def of_scenes(
    device: str, meshes: Path, truths: Path, names: list[str], images: Path | None, scheduler: Scheduler
) -> dict[str, Any]:
    """What `scenes_study.run` finds, its scenes spread over workers. Raises InputError, and ToolError for scenes that
    failed.
    """
    tasks = []
    drawn = None if images is None else str(images)
    given = {"device": device, "meshes": str(meshes), "truths": str(truths), "images": drawn}
    for found in scenes_study.subjects(meshes, names):
        name = found.scene.name
        reads = (found.mesh, *(found.path(truths, image) for image in scenes_study.stored(found, truths)))
        writes = () if images is None else (scenes_study.figure_of(name, images),)
        tasks.append(Task(f"scenes {name}", f"{__name__}:scene", given | {"name": name}, reads, writes))
    values = run_tasks(tasks, scheduler, cache_folder() / LEDGER)
    return scenes_study.record_of({name: found for value in values for name, found in value.items()})


def scene(device: str, meshes: str, truths: str, name: str, images: str | None) -> dict[str, Any]:
    """What is found of a scene, by its name."""
    figures = None if images is None else Path(images)
    return scenes_study.run(device, Path(meshes), Path(truths), [name], figures)["scenes"]


def _joined(tasks: Sequence[Task], scheduler: Scheduler) -> list[Row]:
    return [row for rows in run_tasks(tasks, scheduler, cache_folder() / LEDGER) for row in rows]


def _module(study: str) -> ModuleType:
    return importlib.import_module(f"quadgraph_validation.accuracy.{study.replace('-', '_')}_study")
