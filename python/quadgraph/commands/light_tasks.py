"""Corrected predictions of an acquisition as tasks: of each set of lights its photographs."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph.acquisition.model.prediction import Predicted, SolvedLights, solved
from quadgraph.base import atomic_file
from quadgraph.base.errors import InputError
from quadgraph.core import load_core
from quadgraph.work.named_files import named_files, texts_in
from quadgraph.work.schedulers import StayingWorkers
from quadgraph.work.task import Task, key_of, sha256_of
from quadgraph.work.task_run import run_tasks

_ARRAYS = ("radiance", "gloss", "alpha", "error", "band")


@dataclass(frozen=True)
class _Told:
    """How tasks come along, for who counts solves."""

    say: Callable[[str], None]
    tell: Callable[[], None]

    def advance(self, text: str) -> None:
        """One more is finished."""
        self.tell()


class LightTasks:
    """Spreads the solves of an acquisition's predictions over workers."""

    def __init__(
        self, workers: StayingWorkers, ledger: Path, device: str, validation: bool, say: Callable[[str], None]
    ) -> None:
        """ledger: folder for what is finished; say: is told what workers do."""
        self._workers, self._ledger = workers, ledger.absolute()
        self._device, self._validation = device, validation
        self._say = say

    def __call__(self, scenes: Sequence[Sequence[str]], tell: Callable[[], None]) -> list[SolvedLights]:
        """As SpreadSolves has it. Raises InputError, ToolError."""
        tasks = [self._task(f"lights {number}", ones) for number, ones in enumerate(scenes, 1)]
        reports = run_tasks(tasks, self._workers, self._ledger, _Told(self._say, tell))
        pictures = [[_read(path) for path in task.writes] for task in tasks]
        return [SolvedLights(seen, report) for seen, report in zip(pictures, reports, strict=True)]

    def _task(self, name: str, scenes: Sequence[str]) -> Task:
        documents = [self._kept(json.loads(scene)) for scene in scenes]
        given: dict[str, Any] = {"scenes": documents, "device": self._device, "validation": self._validation}
        files = named_files(texts_in(documents))
        key = key_of(given)[:32]
        outputs = tuple(self._ledger / f"{key}-{number}.npz" for number in range(len(scenes)))
        given |= {"outputs": [str(path) for path in outputs]}
        return Task(name, f"{__name__}:predicted", given, tuple(files), outputs)

    def _kept(self, scene: dict[str, Any]) -> dict[str, Any]:
        """With the file of a volume in a place that stays, by its content."""
        if not isinstance(scene["material"], str):
            return scene
        file = Path(scene["material"])
        kept = self._ledger / f"{sha256_of(file)[:32]}.npz"
        try:
            self._ledger.mkdir(parents=True, exist_ok=True)
            if not kept.exists():
                with file.open("rb") as source, atomic_file.replacing(kept) as target:
                    shutil.copyfileobj(source, target)
        except OSError as error:
            raise InputError(f"{kept}: cannot be written ({error.strerror})") from error
        return scene | {"material": str(kept)}


def predicted(
    scenes: Sequence[dict[str, Any]], device: str, validation: bool, outputs: Sequence[str]
) -> dict[str, Any]:
    """Write what scenes of one set of lights look like from their cameras; the solve's report."""
    found = solved(load_core().Stage(device, validation), [json.dumps(scene) for scene in scenes])
    for picture, output in zip(found.pictures, outputs, strict=True):
        Path(output).parent.mkdir(parents=True, exist_ok=True)
        with atomic_file.replacing(Path(output)) as file:
            np.savez(file, **{name: getattr(picture, name) for name in _ARRAYS})
    return found.report


def _read(path: Path) -> Predicted:
    with np.load(path) as arrays:
        return Predicted(*(arrays[name] for name in _ARRAYS))
