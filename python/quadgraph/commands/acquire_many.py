"""Several captures, each recovered as a task of its own."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from rich.console import Console

from quadgraph.acquisition.capture import capture
from quadgraph.acquisition.volume.volume_options import TOTAL_VARIATION, VolumeOptions
from quadgraph.base import atomic_file, outputs
from quadgraph.base.errors import InputError
from quadgraph.work.finished_tasks import LEDGER
from quadgraph.work.schedulers import Scheduler
from quadgraph.work.task import Task
from quadgraph.work.task_run import run_tasks

_ONE_BY_ONE = Scheduler("processes", 1)
_USUAL = "capture"  # stem of a capture that is named by its folder
_FAILS = 3  # exit code


def run(args: argparse.Namespace) -> int:
    """Recover all and write each into the folder; 3 where one of them contradicts itself or did not settle."""
    for name in ("resume", "report"):
        if getattr(args, name):
            raise InputError(f"--{name}: found with several captures; it is of one")
    found = {path: args.output / f"{_name(path)}.npz" for path in args.file}
    if len(set(found.values())) < len(found):
        raise InputError("CAPTURE: two of them would be written to one file; a capture.json is named by its folder")
    try:
        args.output.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{args.output}: a folder is wanted for several captures ({error.strerror})") from error
    stated = {path: capture.read(path).files() for path in found}
    outputs.check_outputs([*found.values(), args.json], [file for files in stated.values() for file in files])
    tasks = []
    for path, output in found.items():
        given = {
            "file": str(path),
            "output": str(output),
            "correction": args.correction,
            "volume": [args.spacing, args.scheme or TOTAL_VARIATION] if args.volume else None,
            "device": args.device,
            "validation": args.validation,
        }
        name = f"acquire {output.stem}"
        tasks.append(Task(name, f"{__name__}:recovered", given, tuple(stated[path]), (output,)))
    values = run_tasks(tasks, args.scheduler or _ONE_BY_ONE, args.output / LEDGER)
    if args.json:
        atomic_file.write_json(args.json, [value["report"] for value in values])
    console = Console(highlight=False, soft_wrap=True)
    for value, output in zip(values, found.values(), strict=True):
        for line in (f"{output}:", *value["lines"]):
            console.print(line, markup=False)
    return 0 if all(value["settled"] for value in values) else _FAILS


def _name(path: Path) -> str:
    return path.absolute().parent.name if path.stem == _USUAL else path.stem


def recovered(
    file: str, output: str, correction: bool, volume: list[Any] | None, device: str, validation: bool
) -> dict[str, Any]:
    """Recover one capture into a file: the report, its lines, and whether it settled without contradictions."""
    from quadgraph.acquisition.recovery import recover
    from quadgraph.commands.acquire import is_settled, lines

    asked = VolumeOptions(*volume) if volume is not None else None
    found = recover(
        capture.read(Path(file)), correction, asked, lambda text: None, lambda share: None, device, validation, None
    )
    found.material.save(Path(output))
    return {"report": found.report(), "lines": lines(found), "settled": is_settled(found)}
