"""A frame as the window shows it while the light changes, the material too, and the shape too: milliseconds by pass,
and how far it is from the converged answer.
"""

from __future__ import annotations

import json
import statistics
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from quadgraph.base import pass_report
from quadgraph.base.relative_error import relative_rms
from quadgraph.core import load_core
from quadgraph_validation.benchmark import figures
from quadgraph_validation.benchmark.bench_scene import Device
from quadgraph_validation.benchmark.frame_passes import frame_figures, median_passes

SIDE = 512  # pixels, where none are asked for
_CONVERGED = 1e-4  # algebraic error of what frames are held against
KINDS = {
    "light": ("lights",),
    "light and material": ("lights", "edits"),
    "light, material and shape": ("lights", "edits", "deformation"),
}


def run(
    path: Path, material: str, device: Device, repeats: int, copy_gb_per_s: float, side: int = SIDE
) -> dict[str, Any]:
    """Frames as the window has them in motion, with Lambertian radiance, left on the device; of each kind medians over
    `repeats`.
    """
    core = load_core()
    with tempfile.TemporaryDirectory(prefix="quadgraph-live-") as folder:
        scene = Path(folder) / "scene.json"
        scene.write_text(json.dumps({"body": str(path.resolve()), "material": material}))
        file = core.SceneFile(scene)
    stage = core.Stage(device=device.name, validation=device.validation)
    stage.show(file.at(0))
    report = stage.solve()
    kinds = [_measure(file, stage, name, repeats, copy_gb_per_s, side) for name in KINDS]
    level = stage.engine.graph.levels[0]
    return {
        "file": path.name,
        "material": material,
        "side": side,
        "model": report["model"],
        "tets": len(level.tets),
        "faces": len(level.faces),
        "kinds": kinds,
    }


def _measure(file: Any, stage: Any, name: str, repeats: int, copy_gb_per_s: float, side: int) -> dict[str, Any]:
    taken: list[tuple[float, list[dict], float]] = []
    for frame in range(1, repeats + 2):  # the first makes room
        for part in KINDS[name]:
            file.set(f"/{part}", json.dumps(_changed(part, frame)))
        start = time.perf_counter()
        stage.show(file.at(0))
        segments = stage.engine.solve(motion=True)["walk_segments"]
        stage.engine.draw(width=side, height=side, samples=4, radiance="lambertian")
        taken.append((1e3 * (time.perf_counter() - start), stage.engine.passes, segments))
    wall_ms, passes, segments_of = zip(*taken[1:], strict=True)
    return {
        "changes": name,
        "wall_ms": statistics.median(wall_ms),
        "off": _off(stage.engine),
        "walk_segments": statistics.median(segments_of),
        "walk_segments_per_s": statistics.median(map(_segments_per_s, segments_of, passes)),
        "passes": median_passes(list(passes), copy_gb_per_s),
        "frames": frame_figures(list(passes)) | {"": figures.times(wall_ms)},
    }


def _segments_per_s(segments: float, passes: list[dict]) -> float:
    """How fast the rays of the source crossed so many tets."""
    return 1e3 * segments / pass_report.ms_by_pass(passes)["source walk"]


def _off(engine: Any) -> dict[str, float]:
    """Relative difference of the last frame's exitance to the converged one: median, 99%, and RMS over the surface."""
    shown = engine.surface_field()["exitance"].mean(axis=1)
    engine.solve(tolerance=_CONVERGED)
    field = engine.surface_field()
    exact = field["exitance"].mean(axis=1)
    relative = np.abs(shown - exact) / exact
    rms = relative_rms(np.asarray(field["area"], np.float64), (shown - exact)[:, None], exact[:, None])
    return {"median": float(np.median(relative)), "most": float(np.quantile(relative, 0.99)), "rms": rms}


def _changed(part: str, frame: int) -> list[dict]:
    """The lights that pictures have by default, the first of them turned; a stroke across the body; a twist."""
    if part == "lights":
        return [
            {"type": "directional", "direction": [frame % 7 - 3, -2, -3], "irradiance": 1},
            {"type": "directional", "direction": [0.6, -0.2, 0.8], "irradiance": 1},
            {"type": "ambient", "irradiance": 0.3},
        ]
    if part == "edits":
        across = [[-10, 5 * (frame % 4), 0], [10, 5 * (frame % 4), 0]]
        return [{"operation": "multiply", "sigma_a": 1 + frame % 3, "stroke": across, "radius": 5}]
    return [{"type": "twist", "degrees": 5 * (frame % 9)}]


def tables(record: dict[str, Any]) -> list[Table]:
    """One table a kind."""
    shown = []
    for kind in record["kinds"]:
        table = pass_report.pass_table(kind["passes"])
        table.title = f"{kind['changes']} changing: {kind['wall_ms']:.0f} ms by the clock"
        off = kind["off"]
        table.caption = (
            f"{record['file']}, {record['tets']:,} tets, {record['side']}² pixels; the last frame's exitance is off by "
            f"{100 * off['median']:.1f}% at the median, {100 * off['most']:.0f}% at 99% of the faces, "
            f"{100 * off['rms']:.1f}% RMS; rays of the source cross {kind['walk_segments_per_s'] / 1e6:.1f} million "
            "tets a second"
        )
        shown.append(table)
    return shown
