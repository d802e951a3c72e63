"""A block's coefficients by `quadgraph acquire` and by Mitsuba's derivatives (`prbvolpath`), of the same photographs.

A homogeneous block of 16 x 16 x 8 mm without reflection, which is what `prbvolpath` can have, under two wide lights
seen from two sides. Mitsuba's path tracing photographs it. Both are judged by how far their coefficients are off, and
by the picture of what they found under a light that no photograph had, over the time that they took.
"""

from __future__ import annotations

import json
import os
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from quadgraph import core
from quadgraph.acquisition.capture import capture, photographs
from quadgraph.acquisition.homogeneous.fitting import Fit
from quadgraph.acquisition.recovery import recover
from quadgraph.api.materials import Material
from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph.base.progress import ProgressCallback
from quadgraph_validation.base.apart import apart
from quadgraph_validation.base.thread_count import limited_threads
from quadgraph_validation.bodies import boxes, unseen_bodies
from quadgraph_validation.truth import path_tracing, photographed
from quadgraph_validation.truth.traced_block import Descent, DescentStep, TracedBlock, WantedPicture

SIDES = np.array([16.0, 16.0, 8.0])  # mm
TRUE = np.array([[0.01, 0.02, 0.03], [1.2, 1.0, 0.8]])  # 1/mm, sigma_a and sigma_s'
START = (0.05, 2.0)  # the same, of all channels, from which Mitsuba goes
SAMPLES = (16, 64)  # of a pixel, in each of Mitsuba's steps
_STEPS, _RATE = 200, 0.05
_PER_MM = 2.0  # faces along an edge
_NOISE = 0.003  # of a white pixel
_PIXELS, _PHOTOGRAPHED, _BATCHES = 24, 2048, 8  # samples of a pixel, in each batch
_KEPT = 0.25  # the share of steps, last ones, whose mean counts: single ones go to and fro
_SHOWN = (5, 10, 20, 40, 80, 120, 160, 200)  # steps
_OTHER_LIGHT = {"type": "rectangle", "centre": [0, 60, 60], "u": [60, 0, 0], "v": [0, -40, 40], "power": 100}


@dataclass(frozen=True)
class InverseRun:
    """device: as Engine takes it; threads: that each may have; samples: of Mitsuba's steps; photographed: of a pixel of
    the photographs, in each of some batches.
    """

    device: str = ""
    threads: int = 1
    samples: tuple[int, ...] = SAMPLES
    steps: int = _STEPS
    photographed: int = _PHOTOGRAPHED


def run(wanted: InverseRun, tell: ProgressCallback) -> dict[str, Any]:
    """Measure all. Raises InputError without Mitsuba, and what bakes and recoveries raise."""
    path_tracing.load_mitsuba(path_tracing.COMPILED)
    with tempfile.TemporaryDirectory(prefix="quadgraph-inverse-") as name, limited_threads(wanted.threads):
        folder = Path(name)
        tell("bake")
        begun = time.perf_counter()
        write_body(folder)
        bake_s = time.perf_counter() - begun
        tell("photographs")
        apart(photograph, folder, wanted.photographed, wanted.threads)
        rows = []
        for title, corrected in (("acquire --no-correction", False), ("acquire", True)):
            tell(title)
            found = apart(acquired, folder, wanted.device, corrected)
            rows.append({"name": title} | _judged(found, folder, wanted.device))
        for samples in wanted.samples:
            title = f"prbvolpath, {samples} samples a pixel"
            tell(title)
            how = Descent(samples, _RATE, wanted.steps, START, wanted.threads)
            found = means(apart(descended, folder, how))
            rows.append({"name": title} | _judged(found, folder, wanted.device))
    return {"threads": wanted.threads, "load": round(os.getloadavg()[0], 1), "bake_s": bake_s, "rows": rows}


def write_body(folder: Path) -> None:
    """Bake the block, its tets sized for its material."""
    unseen_bodies.write(folder / "block.ply", boxes.surface(SIDES, _PER_MM))
    bake(folder / "block.ply", folder / "block.qgraph", BakeOptions(unit="mm", for_materials=(_material(TRUE).text,)))


def _material(coefficients: np.ndarray) -> Material:
    absorption, scattering = (tuple(float(f"{each:.6g}") for each in row) for row in coefficients)
    return Material(scattering, absorption, 1.0)


def scene() -> dict[str, Any]:
    """The block under its two lights."""
    return {
        "quadgraph_scene": 1,
        "body": "block.qgraph",
        "material": json.loads(core.material_json(_material(TRUE).text)),
        "lights": [_rectangle((-50, 30, 50), 120), _rectangle((55, 10, -45), 100)],
        "camera": {"azimuth": 20, "elevation": 15, "fov": 24},
        "picture": {"width": _PIXELS, "height": _PIXELS},
    }


def _rectangle(centre: tuple[float, float, float], power: float) -> dict[str, Any]:
    """A light of 40 x 40 mm that shines towards the origin."""
    normal = -np.array(centre) / np.linalg.norm(centre)
    u = np.cross([0, 1, 0], normal)
    u *= 40 / np.linalg.norm(u)
    edges = {"u": u.tolist(), "v": np.cross(normal, u).tolist()}
    return {"type": "rectangle", "centre": list(centre), "power": power} | edges


def photograph(folder: Path, samples: int, threads: int) -> None:
    """Write the capture: Mitsuba's pictures with the noise of a camera."""
    (folder / "scene.json").write_text(json.dumps(scene()))
    found = photographed.subject(folder / "scene.json")
    options = photographed.PhotographOptions(noise=_NOISE, seed=1)
    cameras, block = photographed.views(found, options), TracedBlock(SIDES, threads)
    radiances = {
        (eye, light): block.seen(block.scene(camera, stated, TRUE), samples, _BATCHES)
        for eye, camera in cameras.items()
        for light, stated in found.lights.items()
    }
    taken = photographed.taken(radiances, options)
    photographed.write(folder / "capture.json", found, cameras, taken, {"made_by": "Mitsuba"})


def acquired(folder: Path, device: str, corrected: bool) -> list[DescentStep]:
    """What `acquire` finds, after each of its outer steps."""
    begun, used = time.perf_counter(), time.process_time()
    times = []

    def tell(text: str) -> None:
        if text.startswith("step"):
            times.append((time.perf_counter() - begun, time.process_time() - used))

    read = capture.read(folder / "capture.json")
    fit = recover(read, corrected, None, tell, lambda share: None, device).fit
    assert isinstance(fit, Fit)  # homogeneous
    steps = [DescentStep(*when, step.coefficients) for when, step in zip(times, fit.steps, strict=True)]
    return [*steps, DescentStep(time.perf_counter() - begun, time.process_time() - used, fit.coefficients)]


def descended(folder: Path, how: Descent) -> list[DescentStep]:
    """What Mitsuba's derivatives lead to, after each step."""
    read = capture.read(folder / "capture.json")
    stated = json.loads((folder / "capture.json").read_text())
    shots = []
    for each, entry in zip(photographs.read_all(read), stated["photographs"], strict=True):
        exposure, noise = entry["exposure"], entry["noise"]
        variance = noise["read_out"] ** 2 + noise["shot"] * np.maximum(each.values, 0)
        camera, light = stated["cameras"][entry["camera"]], stated["lights"][entry["lights"][0]]
        shots.append(WantedPicture(camera, light, each.values / exposure, variance / exposure**2))
    return TracedBlock(SIDES, how.threads).descend(shots, how, lambda number: None)


def means(steps: list[DescentStep]) -> list[DescentStep]:
    """Some of the steps, each with the mean of the logarithms of those before it."""
    result = []
    for number in _SHOWN:
        if number <= len(steps):
            first = min(int(number * (1 - _KEPT)), number - 1)
            logs = np.mean([np.log(step.coefficients) for step in steps[first:number]], axis=0)
            result.append(DescentStep(steps[number - 1].seconds, steps[number - 1].processor_s, np.exp(logs)))
    return result


def _judged(steps: list[DescentStep], folder: Path, device: str) -> dict[str, Any]:
    """How far what was found is off at each time, and at last, by channel."""
    exact = _picture(folder, TRUE, device)
    trace = []
    for step in steps:
        off = np.log(step.coefficients / TRUE)
        there = _picture(folder, step.coefficients, device)
        sigma_a, sigma_s_prime = np.sqrt((off**2).mean(axis=1)).tolist()
        relighting = float(np.sqrt(((there - exact) ** 2).mean() / (exact**2).mean()))
        times = {"seconds": step.seconds, "processor_s": step.processor_s}
        trace.append(times | {"sigma_a": sigma_a, "sigma_s_prime": sigma_s_prime, "relighting": relighting})
    return {"off": (steps[-1].coefficients / TRUE - 1).tolist(), "trace": trace}


def _picture(folder: Path, coefficients: np.ndarray, device: str) -> np.ndarray:
    """Of the block of such a material under another light, by the engine."""
    stage = core.Stage(device)
    document: dict[str, Any] = {"body": str(folder / "block.qgraph"), "lights": [_OTHER_LIGHT]}
    document["material"] = json.loads(core.material_json(_material(coefficients).text))
    document |= {"camera": {"azimuth": 15, "elevation": 20}, "picture": {"width": 64, "height": 64, "samples": 4}}
    stage.show(core.scene_file(json.dumps(document)).at(0))
    stage.solve()
    return np.array(stage.render().scattered, np.float64)


def tables(record: dict[str, Any]) -> list[Table]:
    """What each found at last, and on the way."""
    last = Table(title=f"coefficients of the same photographs, {record['threads']} thread: off by, %, red/green/blue")
    way = Table(title="on the way: RMS over the channels, %")
    for head in ("", "sigma_a", "sigma_s'", "relighting", "s", "CPU s"):
        last.add_column(head)
        way.add_column(head)
    for row in record["rows"]:
        end = row["trace"][-1]
        off = ["/".join(f"{100 * value:+.1f}" for value in part) for part in row["off"]]
        last.add_row(row["name"], *off, *_cells(end, ("relighting",)))
        for each in row["trace"]:
            way.add_row(row["name"], *_cells(each, ("sigma_a", "sigma_s_prime", "relighting")))
    return [last, way]


def _cells(each: dict[str, Any], names: tuple[str, ...]) -> list[str]:
    return [f"{100 * each[name]:.2f}" for name in names] + [f"{each[k]:.0f}" for k in ("seconds", "processor_s")]
