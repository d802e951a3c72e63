"""Frames of a scene, each a task of its own that begins anew, and films of them."""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph.commands import converging, frame_output, picture_output, scene_options
from quadgraph.commands import solve_report as text
from quadgraph.core import load_core
from quadgraph.file import film
from quadgraph.work import finished_tasks
from quadgraph.work.named_files import named_files, texts_in
from quadgraph.work.task import Task
from quadgraph.work.task_run import run_tasks

FUNCTION = f"{__name__}:rendered"


def render(args: argparse.Namespace, file: Any, frames: Sequence[int], outputs: list[Path]) -> list[dict[str, Any]]:
    """Render frames of a scene by `args.scheduler` and write all outputs; one report per frame, with its `size` and
    `map` in words.
    """
    ledger = outputs[0].parent / finished_tasks.LEDGER
    films = [path for path in outputs if film.is_film(path)]
    shown = {frame: ledger / f"{films[0].stem}-{frame:06d}.png" for frame in frames} if films else {}
    for folder in {path.parent for path in outputs} | ({ledger} if films else set()):
        _make(folder)
    numbered = [path for path in outputs if path not in films]
    tasks = []
    for frame in frames:
        scene = file.at(frame).json()
        named = named_files(texts_in(json.loads(scene)))
        pictures = [path.with_name(path.name % frame) for path in numbered]
        given = {
            "scene": scene,
            "frame": frame,
            "pictures": [str(path) for path in pictures],
            "shown": str(shown[frame]) if films else None,
            "device": args.device,
            "validation": args.validation,
        }
        writes = (*pictures, shown[frame]) if films else tuple(pictures)
        tasks.append(Task(f"frame {frame}", FUNCTION, given, tuple(named), writes))
    reports = run_tasks(tasks, args.scheduler, ledger)
    with frame_output.Frames(films, file.at(0).size, file.frames_per_second) as written:
        for frame in shown:
            written.add_shown(_read(shown[frame]))
        written.finish()
    return reports


def rendered(
    scene: str, frame: int, pictures: Sequence[str], shown: str | None, device: str, validation: bool
) -> dict[str, Any]:
    """Render one frame into files, and report. scene: its JSON; shown: where it goes as a film shows it."""
    core = load_core()
    start = time.perf_counter()
    stage = core.Stage(device=device, validation=validation)
    stage.show(core.scene_file(scene).at(0))
    report = stage.solve()
    picture = stage.render(told=converging.tell)
    report = converging.report_of(picture, report)
    scene_options.check_validation(stage.engine)
    how = picture_output.Shown(stage.srgb, stage.write_png, stage.write_exr, lambda: stage.engine.metadata)
    for path in pictures:
        picture_output.write(picture, Path(path), how)
    if shown is not None:
        picture_output.write(picture, Path(shown), how)
    report |= {"frame": frame, "seconds": time.perf_counter() - start}
    report |= {"picture_error": picture.error, "passes": stage.engine.passes}
    return report | {"size": text.size_text(stage.engine), "map": stage.map_report}


def _make(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder}: cannot be made ({error.strerror})") from error


def _read(path: Path) -> np.ndarray:
    from PIL import Image

    with Image.open(path) as picture:
        return np.asarray(picture.convert("RGB"))
