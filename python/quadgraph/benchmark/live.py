"""A frame as the window shows it while the light changes, the material too, and the shape too: milliseconds by pass."""

from __future__ import annotations

import json
import statistics
import tempfile
import time
from pathlib import Path
from typing import Any

from rich.table import Table

from quadgraph.benchmark.passes import median_passes
from quadgraph.benchmark.scene import Device
from quadgraph.commands import report as text
from quadgraph.commands.scene import load_core

SIDE = 512  # pixels
KINDS = {
    "light": ("lights",),
    "light and material": ("lights", "edits"),
    "light, material and shape": ("lights", "edits", "deformation"),
}


def run(path: Path, material: str, device: Device, repeats: int, copy_gb_per_s: float) -> dict[str, Any]:
    """Frames with one warm cycle and Lambertian radiance, the kinds in turn; medians over `repeats` of each."""
    core, frame = load_core(), 0
    with tempfile.TemporaryDirectory(prefix="quadgraph-live-") as folder:
        scene = Path(folder) / "scene.json"
        scene.write_text(json.dumps({"body": str(path.resolve()), "material": material}))
        file = core.SceneFile(scene)
    stage = core.Stage(device=device.name, validation=device.validation)
    stage.show(file.at(0))
    stage.solve()
    found: dict[str, list[tuple[float, list[dict]]]] = {name: [] for name in KINDS}
    for _ in range(repeats + 1):  # the first of each makes room
        for name, parts in KINDS.items():
            frame += 1
            for part in parts:
                file.set(f"/{part}", json.dumps(_changed(part, frame)))
            start = time.perf_counter()
            stage.show(file.at(0))
            report = stage.engine.solve(warm=True, cycles=1)
            stage.engine.render(width=SIDE, height=SIDE, radiance="lambertian")
            found[name].append((1e3 * (time.perf_counter() - start), stage.engine.passes))
    level = stage.engine.graph.levels[0]
    return {
        "file": path.name,
        "material": material,
        "side": SIDE,
        "model": report["model"],
        "tets": len(level.tets),
        "faces": len(level.faces),
        "kinds": [_kind(name, frames[1:], copy_gb_per_s) for name, frames in found.items()],
    }


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


def _kind(name: str, frames: list[tuple[float, list[dict]]], copy_gb_per_s: float) -> dict[str, Any]:
    passes = median_passes([taken for _, taken in frames], copy_gb_per_s)
    return {"changes": name, "wall_ms": statistics.median(ms for ms, _ in frames), "passes": passes}


def tables(record: dict[str, Any]) -> list[Table]:
    """One table a kind."""
    shown = []
    for kind in record["kinds"]:
        table = text.pass_table(kind["passes"])
        table.title = f"{kind['changes']} changing: {kind['wall_ms']:.0f} ms by the clock"
        table.caption = f"{record['file']}, {record['tets']:,} tets, {record['side']}² pixels"
        shown.append(table)
    return shown
