"""A scene of the chart, from its truths to its part of the record; scenes as tasks."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from quadgraph.base.progress import ProgressCallback
from quadgraph.core import load_core
from quadgraph.work.finished_tasks import LEDGER
from quadgraph.work.schedulers import Scheduler
from quadgraph.work.task import Task
from quadgraph.work.task_run import run_tasks
from quadgraph_validation.base.machine import machine
from quadgraph_validation.bodies import scenes
from quadgraph_validation.chart import chart_measure, chart_pictures, chart_truths
from quadgraph_validation.chart.chart_body import ChartBody
from quadgraph_validation.chart.chart_judge import ChartJudge
from quadgraph_validation.chart.chart_method import ChartMethod

_Subject = tuple[ChartBody, ChartJudge, list[ChartMethod]]


@dataclass(frozen=True)
class ChartRun:
    """What is measured. meshes: folder; truth: the same, None for the usual ones; against: truths; methods: texts in
    their names; device: as Engine takes it; pixels: edge of a frame's picture; repeats: rounds; output: folder of
    pictures, None for none.
    """

    meshes: str
    truth: str | None
    against: Sequence[str]
    methods: Sequence[str]
    device: str
    pixels: int
    repeats: int
    output: str | None


def measured(names: Sequence[str], wanted: ChartRun, tell: ProgressCallback) -> list[dict[str, Any]]:
    """Scenes of the record, one after the other. Raises InputError before anything is measured if a truth is absent."""
    with tempfile.TemporaryDirectory(prefix="quadgraph-chart-") as working:
        subjects = [_subject(name, wanted, Path(working), tell) for name in names]
        copied = load_core().copy_bandwidth(wanted.device)
        # Popped, and measured in a function: each with its engines is let go before the next.
        return [_measured(subjects.pop(0), wanted, copied, tell) for _ in range(len(subjects))]


def spread(names: Sequence[str], wanted: ChartRun, scheduler: Scheduler) -> list[dict[str, Any]]:
    """The same, spread over workers. Raises ToolError for scenes that failed."""
    given = {"wanted": asdict(wanted)}
    tasks = [Task(f"chart {name}", f"{__name__}:scene_task", given | {"name": name}) for name in names]
    where = chart_truths.folders(Path(wanted.meshes), Path(wanted.truth) if wanted.truth else None)
    return run_tasks(tasks, scheduler, where.pde.absolute() / LEDGER)


def scene_task(name: str, wanted: Mapping[str, Any]) -> dict[str, Any]:
    """One scene of the record. wanted: members of ChartRun."""
    return measured([name], ChartRun(**wanted), lambda text: None)[0]


def _subject(name: str, wanted: ChartRun, working: Path, tell: ProgressCallback) -> _Subject:
    (scene,) = scenes.chosen([name])
    where = chart_truths.folders(Path(wanted.meshes), Path(wanted.truth) if wanted.truth else None)
    how = (wanted.device, wanted.pixels, tell)
    return chart_truths.subject(scene, where, wanted.against, wanted.methods, working, *how)


def _measured(subject: _Subject, wanted: ChartRun, copied: Mapping[str, Any], tell: ProgressCallback) -> dict[str, Any]:
    body, judge, methods = subject
    run = machine(dict(copied)) | chart_measure.conditions(wanted.repeats, wanted.pixels)
    points = chart_measure.measure(body, judge, methods, wanted.repeats, tell)
    if wanted.output:
        chart_pictures.write(Path(wanted.output), judge, points)
    return {"run": run} | chart_measure.scene_record(body, judge, points)
