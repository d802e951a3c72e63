"""How bakes and acquisitions grow: processor time and memory against size and lights, each run in a process of its own.

Processor time and not time on the clock, so that other programs of the machine change little. What workers win is
measured by the clock, in turn.
"""

from __future__ import annotations

import json
import os
import resource
import shutil
import time
from collections.abc import Mapping, Sequence
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph.acquisition.capture import capture
from quadgraph.acquisition.recovery import recover
from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph.file import qgraph_file
from quadgraph.work.schedulers import Scheduler
from quadgraph.work.task import Task
from quadgraph.work.task_run import run_tasks
from quadgraph_validation.bodies.bunny import bunny_mesh
from quadgraph_validation.truth import photographed

HEIGHT_MM = 100.0
SURFACE_VERTICES = (1000, 3000, 9000, 28_000)
ACQUIRED = (500, 1000, 2000)  # surface vertices of bodies that are acquired
LIGHTS = (1, 2, 4)
WORKERS = (1, 2)
BODIES = 6  # that workers bake, of WORKERS_VERTICES
WORKERS_VERTICES = 1000
_MATERIAL = "sigma_s_prime=1.1/0.7/0.9,sigma_a=0.006/0.02/0.05,eta=1.3"
_SIDE = 32  # pixels of a photograph
_FAR, _WIDE = 130.0, 80.0  # mm, of lamps
_PEAK_UNIT = 1024  # bytes, in which Linux tells the most memory


def run(folder: Path) -> dict[str, Any]:
    """Measure all in `folder`, telling the progress on standard error. Raises InputError, ToolError."""
    alone = Scheduler("processes", 1)
    bakes = [Task(f"bake {n:,}", f"{__name__}:bake_cost", _of(folder, n)) for n in SURFACE_VERTICES]
    asked = [(n, 2) for n in ACQUIRED] + [(ACQUIRED[0], lights) for lights in LIGHTS if lights != 2]
    acquired = [
        Task(f"acquire {n:,}, {lights} lights", f"{__name__}:acquire_cost", _of(folder, n) | {"lights": lights})
        for n, lights in asked
    ]
    ledger = folder / "growth"
    found = {"bakes": run_tasks(bakes, alone, ledger), "acquisitions": run_tasks(acquired, alone, ledger)}
    return found | {"workers": _workers(folder), "exponents": exponents(found)}


def _of(folder: Path, surface_vertices: int) -> dict[str, Any]:
    return {"folder": str(folder.absolute()), "surface_vertices": surface_vertices}


def exponents(found: Mapping[str, Sequence[Mapping[str, Any]]]) -> dict[str, float]:
    """Powers of the number of tets: of time and memory of bakes, and of the time of a step of acquisitions."""
    bakes, acquired = found["bakes"], [each for each in found["acquisitions"] if each["lights"] == 2]
    return {
        "bake_s": _power([(each["tets"], each["cpu_s"]) for each in bakes]),
        "bake_bytes": _power([(each["tets"], each["peak_bytes"]) for each in bakes]),
        "acquire_step_s": _power([(each["tets"], each["cpu_s"] / each["steps"]) for each in acquired]),
    }


def _power(costs: Sequence[tuple[float, float]]) -> float:
    """The median of the slopes between any two, so that one body that is odd decides nothing."""
    logs = np.log(costs)
    return float(np.median([(b[1] - a[1]) / (b[0] - a[0]) for a, b in combinations(logs, 2)]))


def bake_cost(folder: str, surface_vertices: int) -> dict[str, Any]:
    """What the bake of a bunny takes: seconds of all processors, child programs included, and the most memory."""
    path = Path(folder) / f"growth-{surface_vertices}.qgraph"
    options = BakeOptions(height_mm=HEIGHT_MM, surface_vertices=surface_vertices)
    before = _processor_s()
    bake(bunny_mesh(), path, options, lambda text: None)
    own, child = (resource.getrusage(who).ru_maxrss for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return {
        "surface_vertices": surface_vertices,
        "tets": _tets(path),
        "cpu_s": _processor_s() - before,
        "peak_bytes": max(own, child) * _PEAK_UNIT,
        "file_bytes": path.stat().st_size,
    }


def acquire_cost(folder: str, surface_vertices: int, lights: int) -> dict[str, Any]:
    """What it takes to recover a bunny from two views under each of so many lamps."""
    place = Path(folder) / f"growth-{surface_vertices}-{lights}"
    place.mkdir(parents=True, exist_ok=True)
    options = BakeOptions(height_mm=HEIGHT_MM / 2, surface_vertices=surface_vertices)
    bake(bunny_mesh(), place / "body.qgraph", options, lambda text: None)
    (place / "scene.json").write_text(json.dumps(_scene(lights)))
    found, asked = photographed.subject(place / "scene.json"), photographed.PhotographOptions(seed=lights)
    cameras = photographed.views(found, asked)
    radiances = photographed.by_engine(found, cameras, place / "body.qgraph", "cpu", lambda share: None)
    photographed.write(place / "capture.json", found, cameras, photographed.taken(radiances, asked), {})
    read = capture.read(place / "capture.json")
    before = _processor_s()
    recovered = recover(read, True, None, lambda text: None, lambda share: None, "cpu")
    taken = _processor_s() - before
    tets = _tets(place / "body.qgraph")
    shutil.rmtree(place)
    steps = len(recovered.report()["steps"])
    return {"surface_vertices": surface_vertices, "lights": lights, "tets": tets, "cpu_s": taken, "steps": steps}


def _scene(lights: int) -> dict[str, Any]:
    lamps = []
    for angle in np.arange(lights) * 2 * np.pi / lights + 0.4:
        centre = _FAR * np.array([np.sin(angle), 0.5, np.cos(angle)])
        u = _WIDE * np.array([np.cos(angle), 0.0, -np.sin(angle)])
        v = np.cross(-centre, u)
        v *= _WIDE / np.linalg.norm(v)
        places = {name: np.round(each, 3).tolist() for name, each in (("centre", centre), ("u", u), ("v", v))}
        lamps.append({"type": "rectangle", "power": 100} | places)
    return {
        "quadgraph_scene": 1,
        "body": "body.qgraph",
        "material": _MATERIAL,
        "lights": lamps,
        "camera": {"azimuth": 20, "elevation": 15, "fov": 24},
        "picture": {"width": _SIDE, "height": _SIDE},
    }


def _tets(path: Path) -> int:
    return int(qgraph_file.read(path).metadata["levels"][0]["tets"])


def _processor_s() -> float:
    return sum(os.times()[:4])


def _workers(folder: Path) -> list[dict[str, Any]]:
    """Bodies an hour by the number of processes, in turn, the better of two."""
    seconds: dict[int, list[float]] = {count: [] for count in WORKERS}
    for number in range(2):
        for count, spent in seconds.items():
            place = folder / f"workers-{count}-{number}"
            place.mkdir()
            bodies = [place / str(body) for body in range(BODIES)]
            for each in bodies:
                each.mkdir()
            asked = [_of(each, WORKERS_VERTICES) for each in bodies]
            tasks = [Task(f"bake {k}", f"{__name__}:bake_cost", given) for k, given in enumerate(asked)]
            start = time.perf_counter()
            run_tasks(tasks, Scheduler("processes", count), place)
            spent.append(time.perf_counter() - start)
            shutil.rmtree(place)
    return [{"workers": count, "bodies_an_hour": 3600 * BODIES / min(spent)} for count, spent in seconds.items()]
