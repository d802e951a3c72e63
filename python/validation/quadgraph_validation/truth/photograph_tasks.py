"""Photographs by random walks as tasks: of each camera each channel."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph.base import atomic_file
from quadgraph.work.finished_tasks import LEDGER
from quadgraph.work.named_files import named_files, texts_in
from quadgraph.work.schedulers import Scheduler
from quadgraph.work.task import Task
from quadgraph.work.task_run import run_tasks
from quadgraph_validation.truth import photographed
from quadgraph_validation.truth.camera_walks import CameraPicture
from quadgraph_validation.truth.photographed import PhotographOptions, Radiances, Subject

_COLOURS = ("red", "green", "blue")


def by_walks(
    found: Subject, cameras: dict[str, dict[str, Any]], options: PhotographOptions, capture: Path, scheduler: Scheduler
) -> Radiances:
    """What `photographed.by_walks` finds, bit for bit, its pictures spread over workers. capture: will be written, and
    what is finished kept beside it. Raises InputError, and ToolError for pictures that failed.
    """
    photographed.walker_of(found)
    ledger = capture.absolute().parent / LEDGER
    files = sorted({found.path, found.body, *named_files(texts_in(found.document))})
    tasks, written = [], []
    for number, (name, camera) in enumerate(cameras.items()):
        for channel, colour in enumerate(_COLOURS):
            output = ledger / f"{capture.stem}-{name}-{colour}.npz"
            given = {
                "scene": str(found.path),
                "camera": camera,
                "channel": channel,
                "walks": options.walks,
                "seed": options.seed + number,
                "output": str(output),
            }
            tasks.append(Task(f"photograph {name} {colour}", f"{__name__}:seen", given, tuple(files), (output,)))
            written.append(output)
    run_tasks(tasks, scheduler, ledger)
    return photographed.radiances_of(found, cameras, [_read(path) for path in written])


def seen(scene: str, camera: Mapping[str, Any], channel: int, walks: int, seed: int, output: str) -> None:
    """Write what a camera sees in one channel."""
    found = photographed.subject(Path(scene))
    walker = photographed.walker_of(found)
    picture = photographed.seen_by(walker, dict(camera), channel, found.material, walks, seed, lambda share: None)
    Path(output).parent.mkdir(parents=True, exist_ok=True)
    with atomic_file.replacing(Path(output)) as file:
        np.savez(file, radiance=picture.radiance, noise=picture.noise)


def _read(path: Path) -> CameraPicture:
    with np.load(path) as arrays:
        return CameraPicture(arrays["radiance"], arrays["noise"])
