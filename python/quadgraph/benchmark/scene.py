"""The fixed scenes of the benchmark, and what they run on."""

from __future__ import annotations

import os
import subprocess
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from quadgraph import __version__
from quadgraph.commands.scene import load_core

if TYPE_CHECKING:
    from quadgraph._core import Engine

DIRECTION = (0.0, 0.0, -1.0)  # in which the one light of the solver's scenes travels: its far side is unlit
LIGHT = f"directional:{','.join(f'{d:g}' for d in DIRECTION)}:1"  # W/mm^2


@dataclass(frozen=True)
class Device:
    """The choice of Vulkan device, by a part of its name, and whether the validation layer watches."""

    name: str = ""
    validation: bool = False

    def open(self, path: Path, material: str, lights: list[str]) -> Engine:
        """Load a .qgraph with material and lights. Raises FormatError, InputError, VulkanError."""
        engine = load_core().Engine(path, device=self.name, validation=self.validation)
        engine.set_material(material)
        engine.set_lights(lights)
        return engine


@dataclass(frozen=True)
class Scene:
    """A baked body under the one light, as the solvers are compared on."""

    name: str
    path: Path
    material: str = "marble"
    lights: list[str] = field(default_factory=lambda: [LIGHT])


def bunny_mesh() -> Path:
    """The Stanford bunny that pymeshlab brings along: 28 thousand vertices."""
    import pymeshlab

    return Path(pymeshlab.__file__).parent / "tests" / "sample_meshes" / "bunny.obj"


def bake_bunny(path: Path, height_mm: float, order: str = "blocks") -> Path:
    """Bake that bunny as every run of the benchmark does."""
    from quadgraph.bake import BakeOptions, bake

    bake(bunny_mesh(), path, BakeOptions(height_mm=height_mm, order=order))
    return path


def machine(copied: dict[str, Any]) -> dict[str, Any]:
    """What a record starts with: device, driver and copy bandwidth, cores and their load, commit and version."""
    return {
        "device": copied["device"],
        "driver": copied["driver"],
        "copy": {key: copied[key] for key in ("gb_per_s", "kernel", "transfer", "bytes")},
        "cores": os.cpu_count(),
        "load": round(os.getloadavg()[0], 1),
        "commit": commit(),
        "version": __version__,
    }


def commit() -> str:
    """Return the commit of the source tree with '-dirty' if it was changed, 'unknown' outside one."""
    command = ["git", "-C", str(Path(__file__).parent), "describe", "--always", "--dirty", "--abbrev=12"]
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True, timeout=10).stdout.strip()
    except (OSError, subprocess.SubprocessError):
        return "unknown"
