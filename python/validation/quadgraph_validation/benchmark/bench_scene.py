"""The fixed scenes of the benchmark, and what they run on."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from quadgraph.core import load_core
from quadgraph_validation.bodies.bunny import bunny_mesh

if TYPE_CHECKING:
    from quadgraph.core import Engine

DIRECTION = (0.0, 0.0, -1.0)  # in which the one light of the solver's scenes travels: its far side is unlit
LIGHT = f"directional:{','.join(f'{d:g}' for d in DIRECTION)}:1"  # W/mm^2


@dataclass(frozen=True)
class Device:
    """The choice of the device (docs/devices.md), and whether Vulkan's validation layer watches."""

    name: str = ""
    validation: bool = False

    def open(self, path: Path, material: str, lights: list[str]) -> Engine:
        """Load a .qgraph with material and lights. Raises FormatError, InputError, DeviceError."""
        engine = load_core().Engine(path, device=self.name, validation=self.validation)
        engine.set_material(material)
        engine.set_lights(lights)
        return engine


@dataclass(frozen=True)
class BenchScene:
    """A baked body under the one light, as the solvers are compared on."""

    name: str
    path: Path
    material: str = "marble"
    lights: list[str] = field(default_factory=lambda: [LIGHT])


def bake_bunny(path: Path, height_mm: float, order: str = "blocks") -> Path:
    """Bake that bunny as every run of the benchmark does."""
    from quadgraph.baking.pipeline import BakeOptions, bake

    bake(bunny_mesh(), path, BakeOptions(height_mm=height_mm, order=order))
    return path
