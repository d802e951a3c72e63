"""Several meshes into `.qgraph` files, each a task of its own."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from quadgraph.base import outputs
from quadgraph.base.errors import InputError
from quadgraph.mesh import mesh_names
from quadgraph.work import finished_tasks
from quadgraph.work.named_files import named_files
from quadgraph.work.schedulers import Scheduler
from quadgraph.work.task import Task

_ONE_BY_ONE = Scheduler("processes", 1)


def is_several(meshes: list[Path]) -> bool:
    """Whether more than one file is named, or a folder of them."""
    return len(meshes) > 1 or meshes[0].is_dir()


def files_in(meshes: Iterable[Path]) -> list[Path]:
    """The meshes that are named, those of folders by their names. Raises InputError for a folder without any."""
    found: list[Path] = []
    for path in meshes:
        inside = sorted(filter(mesh_names.is_mesh, path.iterdir())) if path.is_dir() else [path]
        if not inside:
            raise InputError(f"{path}: no mesh in this folder; allowed are {', '.join(mesh_names.SUFFIXES)}")
        found += inside
    return found


def run(args: argparse.Namespace, options: Any) -> int:
    """Bake all, tell of each; 3 with --strict if an error is not kept, else 0. options: BakeOptions."""
    from quadgraph.work.task_run import run_tasks

    tasks = _tasks(args, options)
    reports = run_tasks(tasks, args.scheduler or _ONE_BY_ONE, args.output / finished_tasks.LEDGER)
    if args.json:
        print(json.dumps(reports, indent=1))
    else:
        Console(highlight=False).print(_table(tasks, reports))
    return 3 if args.strict and any(each["budget"] and not each["budget"]["reached"] for each in reports) else 0


def _tasks(args: argparse.Namespace, options: Any) -> list[Task]:
    from quadgraph.baking.budget.bake_task import FUNCTION, ErrorAsked
    from quadgraph.baking.kept import mesh_files

    asked = None
    if args.error is not None:
        asked = asdict(ErrorAsked(args.error, args.material, args.light or [], args.device))
    named = named_files([*options.for_materials, args.material or "", *(args.light or [])])
    tasks = []
    for mesh, output in _outputs(args).items():
        given = {"mesh": str(mesh), "output": str(output), "options": asdict(options), "asked": asked}
        tasks.append(Task(f"bake {mesh.stem}", FUNCTION, given, (*mesh_files(mesh), *named), (output,)))
    return tasks


def _outputs(args: argparse.Namespace) -> dict[Path, Path]:
    """Where each mesh goes. Raises InputError where that is not said, or two of them would go to one file."""
    if args.output is None:
        raise InputError("--output: found none with several meshes; -o FOLDER says where they go")
    try:
        args.output.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{args.output}: a folder is wanted for several meshes ({error.strerror})") from error
    found: dict[Path, Path] = {}
    for mesh in files_in(args.mesh):
        output = args.output / f"{mesh.stem}.qgraph"
        same = next((other for other, taken in found.items() if taken == output), None)
        if same is not None:
            raise InputError(f"{mesh}: would be baked to {output}, as {same} is; give one of them another name")
        found[mesh] = output
    outputs.check_outputs(found.values(), found)
    return found


def _table(tasks: list[Task], reports: list[dict[str, Any]]) -> Table:
    table = Table("mesh", "tets", "levels", "seconds", "file")
    for task, report in zip(tasks, reports, strict=True):
        finest, seconds = report["levels"][0], report["seconds"]["total"]
        mesh = Path(task.arguments["mesh"]).name
        table.add_row(mesh, f"{finest['tets']:,}", str(len(report["levels"])), f"{seconds:.1f}", report["output"])
    return table
