"""The parts of the benchmark on the fixed scenes, or on a file of the user's."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quadgraph.base.progress import ProgressCallback
from quadgraph.core import load_core
from quadgraph_validation.benchmark import frame_passes as passes
from quadgraph_validation.benchmark import live_frames as live
from quadgraph_validation.benchmark import rivals, scaling, solver_convergence
from quadgraph_validation.benchmark.bench_scene import BenchScene, Device, bake_bunny

_HEIGHTS_MM = (30, 100)  # of the bunny that the solvers are compared on
_PASSES_HEIGHT_MM = 60  # of the one whose passes are timed, in both orders


@dataclass
class Parts:
    """What to measure on: `file` or, if None, bunnies that are baked into `folder` unless they are there.

    copied: as _core.copy_bandwidth tells.
    """

    file: Path | None
    random_order: Path | None
    material: str
    repeats: int
    device: Device
    folder: Path
    copied: dict[str, Any]
    tell: ProgressCallback

    def passes(self) -> list[dict[str, Any]]:
        """Time, bytes and speed of the passes of every way to solve; in both orders of nodes where there are two."""
        files = self._both_orders()
        lights = load_core().default_lights()
        engines = {order: self.device.open(path, self.material, lights) for order, path in files.items()}
        entries = []
        for way in passes.METHODS:
            self.tell(f"passes: {passes.name_of(way)}")
            entries.append(passes.measure(engines, self.material, way, self.repeats, self.copied["gb_per_s"]))
        return entries

    def solvers(self) -> list[dict[str, Any]]:
        """Error against work and time on every scene."""
        return [solver_convergence.run(scene, self.device, self.repeats, self.tell) for scene in self._scenes()]

    def live(self, side: int) -> dict[str, Any]:
        """Frames of side x side pixels while light, material and shape change."""
        path = self.file or self._bunny(_PASSES_HEIGHT_MM, "blocks")
        self.tell("live: light, material and shape change")
        return live.run(path, self.material, self.device, self.repeats, self.copied["gb_per_s"], side)

    def rivals(self) -> list[dict[str, Any]]:
        """Our two best solvers beside other people's on every scene."""
        return [rivals.run(scene, self.device, self.repeats, self.tell) for scene in self._scenes()]

    def scaling(self, sizes: tuple[int, ...]) -> dict[str, Any]:
        """Cycles and time by size, in surface vertices."""
        return scaling.run(self.folder, sizes, self.device, self.repeats, self.tell)

    def _both_orders(self) -> dict[str, Path]:
        if self.file is None:
            return {order: self._bunny(_PASSES_HEIGHT_MM, order) for order in ("blocks", "random")}
        return {"blocks": self.file} | ({"random": self.random_order} if self.random_order else {})

    def _scenes(self) -> list[BenchScene]:
        if self.file is not None:
            return [BenchScene(self.file.stem, self.file, self.material)]
        return [BenchScene(f"bunny, {h} mm", self._bunny(h, "blocks"), self.material) for h in _HEIGHTS_MM]

    def _bunny(self, height_mm: float, order: str) -> Path:
        path = self.folder / f"bunny-{height_mm:g}mm-{order}.qgraph"
        if path.exists():
            return path
        self.tell(f"baking the bunny, {height_mm:g} mm high, nodes in order: {order}")
        return bake_bunny(path, height_mm, order)
