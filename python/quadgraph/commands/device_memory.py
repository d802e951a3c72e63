"""Device memory that solving and showing a .qgraph takes, by purpose: asked of the engine, which makes room for it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rich.table import Table

from quadgraph.base.errors import QuadGraphError
from quadgraph.base.pass_report import PICTURE_PURPOSES
from quadgraph.commands.scene_options import default_of
from quadgraph.core import load_core

VARIED_MATERIAL = "marble-veins"


def ask(path: Path) -> dict[str, Any]:
    """Return {"entries": what `measure` returns, "unknown": None}, or no entries and why not."""
    try:
        return {"entries": measure(path), "unknown": None}
    except QuadGraphError as error:
        return {"entries": [], "unknown": str(error)}


def measure(path: Path) -> list[dict[str, Any]]:
    """Return for both models, and a homogeneous and a varied material, what is allocated with the default lights.

    Each entry: "model", "material", "purposes" ({purpose: bytes}), "solve" and "total" (bytes, without and with what
    lights and any picture keep; what depends on its size is not in it). Raises InputError without the compiled engine,
    DeviceError without a device.
    """
    core = load_core()
    entries = []
    for material in (default_of("material"), VARIED_MATERIAL):
        for model in ("diffusion", "sp3"):
            engine = core.Engine(path)
            engine.set_material(material)
            engine.set_lights(core.default_lights())
            engine.make_room(model=model)
            purposes = {use["purpose"]: use["bytes"] for use in engine.memory()}
            total = sum(purposes.values())
            solve = total - sum(purposes.get(purpose, 0) for purpose in PICTURE_PURPOSES)
            entries.append({"model": model, "material": material, "purposes": purposes, "solve": solve, "total": total})
    return entries


def table(entries: list[dict[str, Any]]) -> Table:
    """Return what `measure` found, MB, a column each."""
    result = Table("device memory, MB", *(f"{entry['model']}, {entry['material']}" for entry in entries))
    largest: dict[str, int] = {}
    for entry in entries:
        for purpose, size in entry["purposes"].items():
            largest[purpose] = max(size, largest.get(purpose, 0))
    for purpose in sorted(largest, key=lambda purpose: largest[purpose], reverse=True):
        result.add_row(purpose, *(f"{entry['purposes'].get(purpose, 0) / 1e6:.2f}" for entry in entries))
    result.add_section()
    result.add_row("without shadow maps and picture", *(f"{entry['solve'] / 1e6:.2f}" for entry in entries))
    result.add_row("all", *(f"{entry['total'] / 1e6:.2f}" for entry in entries))
    return result
