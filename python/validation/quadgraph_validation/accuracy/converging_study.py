"""Pictures that converge to an error, of bodies that nobody tuned for, beside random walks from the camera."""

from __future__ import annotations

import tempfile
import time
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from quadgraph.api.engine import Engine
from quadgraph.api.picture import Convergence, Picture
from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph_validation.accuracy import pictures_study, unseen_engine
from quadgraph_validation.accuracy.kept_rows import KeptRows, Row
from quadgraph_validation.accuracy.pictures_study import BLOCK, PIXELS, Sight, blocks
from quadgraph_validation.base import extra_module
from quadgraph_validation.bodies import unseen_bodies
from quadgraph_validation.bodies.smooth_sky import SmoothSky

WAYS = ("uncorrected", "one sweep", "default", "converged")
SAMPLES = 16  # of a pixel, in each solve


@dataclass(frozen=True)
class ConvergingRun:
    """seed: of the first body, all of which are in even light; count: of bodies; walks: of each pixel; converge: the
    error that is asked for; seconds: that it may take; device: as Engine takes it; for_material: bake each body for its
    own material.
    """

    seed: int
    count: int
    walks: int
    converge: float
    seconds: float
    device: str = ""
    for_material: bool = False


def run(wanted: ConvergingRun, kept: KeptRows | None = None) -> dict[str, Any]:
    """Judge all bodies, or what is not kept. Raises InputError, and what bakes and solves raise."""
    extra_module.load("numba", "walks")
    first = wanted.seed + wanted.seed % 2
    seeds = range(first, first + 2 * wanted.count, 2)
    cases = [(str(seed), partial(_row, seed, wanted)) for seed in seeds]
    return record_of(wanted, (kept or KeptRows()).complete(cases))


def record_of(wanted: ConvergingRun, rows: list[Row]) -> dict[str, Any]:
    """The record of a run with these rows."""
    names = ("walks", "converge", "seconds", "for_material")
    asked = {name: getattr(wanted, name) for name in names}
    return {"seed": wanted.seed, **asked, "pixels": PIXELS, "rows": rows}


def _row(seed: int, wanted: ConvergingRun) -> Row:
    sight = pictures_study.drawn(seed)
    case = sight.case
    truth, deviation = pictures_study.truth_of(sight, wanted.walks)
    pictures, seconds, found = _pictures(sight, wanted)
    inside = blocks(pictures["default"].alpha.astype(float)) > 0.999
    noise = np.sqrt(blocks(deviation**2)[inside]) / BLOCK
    walked = blocks(truth)[inside]
    seen = {way: blocks(picture.scattered[..., 0].astype(float))[inside] for way, picture in pictures.items()}
    return {
        "seed": case.seed,
        "kind": case.medium.kind,
        "eta": case.medium.eta,
        "size": case.size,
        "albedo": case.albedo,
        "noise": pictures_study.errors(walked + noise, walked, np.zeros_like(noise))["whole"],
        "true": {way: pictures_study.errors(seen[way], walked, noise)["whole"] for way in WAYS},
        "ratio": {way: float(seen[way].sum() / walked.sum()) for way in WAYS},
        "stated": {way: picture.error.whole for way, picture in pictures.items() if picture.error},
        "seconds": seconds,
        "reached": found.reached,
        "out_of_time": found.out_of_time,
        "least": found.least,
        "limit": found.limit,
        "steps": [
            {"solves": step.solves, "sweeps": step.sweeps, "seconds": step.seconds, "error": step.error.whole}
            | {"noise": step.noise}
            for step in found.steps
        ],
    }


def _pictures(sight: Sight, wanted: ConvergingRun) -> tuple[dict[str, Picture], dict[str, float], Convergence]:
    """A picture, and the seconds of solve and picture, in each way; and how the last one converged."""
    pictures: dict[str, Picture] = {}
    seconds: dict[str, float] = {}
    size: dict[str, Any] = pictures_study.AS_WALKED | {"samples": SAMPLES}
    limits = {"converge": wanted.converge, "time_limit": wanted.seconds}
    ways: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
        "uncorrected": ({"correction": False}, {}),
        "one sweep": ({"sweeps": 1}, {}),
        "default": ({}, {}),
        "converged": ({}, limits),
    }
    light = sight.case.light
    assert not isinstance(light, SmoothSky)
    with tempfile.TemporaryDirectory(prefix="quadgraph-converging-") as name:
        mesh, file = Path(name) / "body.ply", Path(name) / "body.qgraph"
        unseen_bodies.write(mesh, sight.case.surface)
        materials = (unseen_engine.text_of(sight.case.medium, Path(name)),) if wanted.for_material else ()
        bake(mesh, file, BakeOptions(unit="mm", for_materials=materials))
        with Engine(file, device=wanted.device) as engine:
            engine.material = unseen_engine.material_of(sight.case.medium)
            engine.lights = [light]
            for way, (solve, picture) in ways.items():
                began = time.perf_counter()
                engine.solve(**solve)
                pictures[way] = engine.render(pictures_study.camera_of(sight), **size, **picture)
                seconds[way] = time.perf_counter() - began
    found = pictures["converged"].convergence
    assert found is not None
    return pictures, seconds, found


def tables(record: dict[str, Any]) -> list[Table]:
    """Each body's errors, true and stated."""
    asked = f"{100 * record['converge']:g}%, {record['seconds']:g} s"
    title = f"radiance, RMS of blocks, true (stated), %; converged to {asked} at most"
    table = Table("seed", "material", *WAYS, "walks' noise", "solves of sweeps", "s: default, converged", title=title)
    for row in record["rows"]:
        last = row["steps"][-1]
        table.add_row(
            str(row["seed"]),
            f"{row['kind']}, eta {row['eta']:.2f}, {row['size']:.0f} mfp, {row['albedo']:.4f}",
            *(_text(row, way) for way in WAYS),
            f"{100 * row['noise']:.2f}",
            f"{last['solves']} of {last['sweeps']}{'' if row['reached'] else '*'}",
            f"{row['seconds']['default']:.1f}, {row['seconds']['converged']:.1f}",
        )
    return [table]


def _text(row: dict[str, Any], way: str) -> str:
    stated = f" ({100 * row['stated'][way]:.2f})" if way in row["stated"] else ""
    return f"{100 * row['true'][way]:.2f}{stated}"
