"""A cluster whose workers are killed at random times loses nothing, and gives what one process gives."""

from __future__ import annotations

import json
import os
import random
import shutil
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

import twin_capture
from quadgraph import cli
from quadgraph.base.cache_folder import cache_folder
from quadgraph.work import dask_workers
from quadgraph.work.machine_memory import memory_bytes
from shapes import icosphere, write_obj

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
pytest.importorskip("distributed", reason="no dask.distributed: pip install 'quadgraph[cluster]'")

BODIES, CAPTURES, SCENES = 12, 2, ("sphere", "bunny")
KILLED, BETWEEN = 20, (0.5, 3.0)  # workers, and s from one to the next


class Reaper(threading.Thread):
    """Kills workers of a cluster, a random one each time, until it has killed enough."""

    def __init__(self, cluster) -> None:
        super().__init__(daemon=True)
        self.killed = 0
        self._cluster = cluster

    def run(self) -> None:
        """Kill those that live: one that has just died is being started again."""
        dice = random.Random(7)
        while self.killed < KILLED:
            time.sleep(dice.uniform(*BETWEEN))
            process = dice.choice([worker.pid for worker in self._cluster.workers.values()])
            if process is not None:
                with suppress(ProcessLookupError):
                    os.kill(process, signal.SIGKILL)
                    self.killed += 1


@contextmanager
def workers(count: int) -> Iterator[tuple[str, Reaper]]:
    """The address of a cluster on this machine, and what kills its workers."""
    with dask_workers.on_this_machine(count, memory_bytes() // count, 1, lambda text: None) as found:
        yield found._client.scheduler.address, Reaper(found._client.cluster)


@pytest.fixture(scope="module")
def inputs(tmp_path_factory) -> Path:
    """Meshes, captures, and truths of the chart."""
    folder = tmp_path_factory.mktemp("inputs")
    (folder / "meshes").mkdir()
    for number in range(BODIES):
        write_obj(icosphere(3, 8.0 + number), folder / "meshes" / f"ball {number:02d}.obj")
    for number in range(CAPTURES):
        place = folder / f"capture {number}"
        place.mkdir()
        twin_capture.bodies(place)
        twin_capture.write(place, twin_capture.TRUTH, 5 + number)
    (folder / "truths").mkdir()
    for scene in SCENES:
        truths = [*cache_folder().glob(f"{scene}-*"), *cache_folder().glob("icosphere-*")]
        if not any(path.name == f"{scene}-sp3-buried.npz" for path in truths):
            pytest.skip(f"no truth of {scene}: `quadgraph reference {scene} --kind pde` makes it")
        for path in truths:
            shutil.copy(path, folder / "truths")
    return folder


def bake(inputs: Path, out: Path, scheduler: str) -> dict[str, bytes]:
    """All bodies, by their names."""
    assert cli.main(["bake", str(inputs / "meshes"), "-o", str(out), "--unit", "mm", "--scheduler", scheduler]) == 0
    return {path.name: path.read_bytes() for path in out.glob("*.qgraph")}


def acquire(inputs: Path, out: Path, scheduler: str) -> list:
    """All coefficients with their deviations."""
    captures = [str(inputs / f"capture {number}" / "capture.json") for number in range(CAPTURES)]
    options = ["-o", str(out), "--json", str(out / "report.json"), "--device", "cpu", "--scheduler", scheduler]
    out.mkdir()
    assert cli.main(["acquire", *captures, *options]) in (0, 3)
    return json.loads((out / "report.json").read_text())


def chart(inputs: Path, out: Path, scheduler: str) -> list:
    """Errors by scene and method; times differ from one measurement to the next."""
    shutil.copytree(inputs / "truths", out)
    named = [option for scene in SCENES for option in ("--scene", scene)]
    options = ["--against", "pde", "--method", "level 1", "--repeats", "1", "--pixels", "32", "--device", "cpu"]
    record = ["--truth", str(out), "--json", str(out / "record.json"), "--scheduler", scheduler]
    assert cli.main(["chart", *named, *options, *record]) == 0
    scenes = json.loads((out / "record.json").read_text())["scenes"]
    return [(scene["name"], point["name"], point.get("errors")) for scene in scenes for point in scene["points"]]


@pytest.mark.long
def test_workers_that_are_killed_change_no_result(inputs, tmp_path):
    jobs = {"bake": bake, "acquire": acquire, "chart": chart}
    alone = {name: job(inputs, tmp_path / f"{name} alone", "processes:1") for name, job in jobs.items()}
    assert len(alone["bake"]) == BODIES
    round_ = 0
    with workers(4) as (address, reaper):
        reaper.start()
        while reaper.killed < KILLED:
            for name, job in jobs.items():
                assert job(inputs, tmp_path / f"{name} {round_}", address) == alone[name]
            round_ += 1
        reaper.join()
    print(f"{reaper.killed} workers killed in {round_} rounds")


@pytest.mark.long
def test_how_much_sooner_two_workers_are_done_is_recorded(inputs, tmp_path, record_property):
    """In turn, so that a slower minute slows both; it is said, and decides nothing."""
    seconds: dict[int, list[float]] = {1: [], 2: []}
    for round_ in range(2):
        for count, spent in seconds.items():
            with workers(count) as (address, _):
                start = time.perf_counter()
                bake(inputs, tmp_path / f"{count} {round_}", address)
                spent.append(time.perf_counter() - start)
    ratio = min(seconds[1]) / min(seconds[2])
    record_property("throughput of 2 workers over 1", ratio)
    print(f"{BODIES} bodies: {seconds[1]} s with one worker, {seconds[2]} s with two: {ratio:.2f} times")
