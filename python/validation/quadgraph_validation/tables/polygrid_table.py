"""Table III and Figure 15 of the polygrid paper (Wang et al. 2008) again, on comparable shapes, beside its numbers.

The paper's times are of an NVIDIA GeForce 8800GTX, and its polygrids finer; nodes, bytes and the ratios between its
schemes are what compares.
"""

from __future__ import annotations

import json
import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from quadgraph.core import load_core
from quadgraph_validation.base.machine import machine
from quadgraph_validation.chart.chart_body import STEP_DEGREES

if TYPE_CHECKING:
    from quadgraph.core import Engine

TOLERANCE = 5e-3  # algebraic error of a frame; the paper stops below 0.5%
ACTIVE_LAYERS = 2
_MATERIAL = "sigma_s_prime=2.19/2.62/3.00,sigma_a=.0021/.0041/.0071,eta=1.3"
_FRAMES = 5
_PIXELS = 256
_SWEEPS = (1, 2, 4, 8, 16, 32, 64, 128, 256)


@dataclass(frozen=True)
class Published:
    """A row of Table III: cubes and cells along their sides, MB, milliseconds of the three passes, frames per second
    from nothing and with coherence.
    """

    name: str
    cubes: int
    cells: int
    megabytes: float
    milliseconds: tuple[float, float, float]
    frames_per_s: tuple[float, float]

    @property
    def nodes(self) -> int:
        """All cells, as the paper counts."""
        return self.cubes * self.cells**3


TABLE_III = (
    Published("Bunny", 253, 16, 24.9, (3.9, 23.2, 11.5), (25.9, 34.7)),
    Published("Bust", 17, 32, 18.9, (2.5, 19.9, 7.0), (34.0, 52.7)),
    Published("Bird", 108, 24, 39.6, (4.0, 48.3, 13.0), (15.3, 24.0)),
    Published("Hole", 36, 12, 4.8, (1.5, 8.9, 2.1), (80.0, 160.4)),
    Published("Snail", 81, 12, 18.9, (1.6, 14.0, 3.1), (53.4, 106.7)),
)
_OTHER_STAGES = ("material", "assembly", "shape", "deform")


def measure(path: Path, device: str = "") -> dict[str, Any]:
    """A body's row of Table III and its curves of Figure 15, ready for JSON."""
    engine = load_core().Engine(path, device=device)
    engine.set_material(_MATERIAL)
    sizes = json.loads(engine.graph.metadata)["polygrid"]
    times = {"cold": _frames(engine, warm=False), "coherent": _frames(engine, warm=True)}
    return times | {
        "cubes": sizes["cubes"],
        "cells": sizes["cells"],
        "nodes": sizes["nodes"],
        "megabytes": sum(use["bytes"] for use in engine.memory()) / 1e6,
        "curves": curves(engine, sizes["nodes"]),
        "machine": machine(load_core().copy_bandwidth(device)),
    }


def _way(**options: Any) -> dict[str, Any]:
    return {"method": "polygrid", "model": "diffusion", "source": "diffuse", "solver": "cascade"} | options


def _turned(frame: int) -> str:
    angle = np.radians(STEP_DEGREES * frame)
    return f"directional:{np.sin(angle):.6f},-0.3,{-np.cos(angle):.6f}:2"


def _frames(engine: Engine, warm: bool) -> dict[str, Any]:
    """Medians over frames in which the light turns: ms of the light's, the solve's and the picture's passes, of which
    is what a frame takes in all.
    """
    found: dict[str, list[float]] = {"light": [], "solve": [], "picture": [], "work": []}
    for frame in range(_FRAMES + 1):
        engine.set_lights([_turned(frame)])
        report = engine.solve(**_way(tolerance=TOLERANCE, active_layers=ACTIVE_LAYERS, warm=warm))
        engine.render(width=_PIXELS, height=_PIXELS, samples=4, radiance="lambertian")
        if frame == 0:
            continue  # compiles, assembles and makes room
        passes = {entry["name"]: entry["time_ms"] for entry in engine.passes}
        for stage in ("light", "solve", "picture"):
            found[stage].append(sum(ms for name, ms in passes.items() if stage_of(name) == stage))
        found["work"].append(report["work"])
    return {stage: statistics.median(values) for stage, values in found.items()}


def stage_of(name: str) -> str:
    """The paper's pass that one of ours belongs to."""
    if any(word in name for word in ("irradiance", "shadow", "sky")):
        return "light"
    if any(word in name for word in ("sweep", "residual", "transfer", "surface", "right-hand", "exitance", "energy")):
        return "solve"
    return "picture" if not any(word in name for word in _OTHER_STAGES) else "other"


def curves(engine: Engine, nodes: int) -> dict[str, list[tuple[float, float]]]:
    """Figure 15: thousands of nodes processed, and sum of squares of the error over that of the answer, by scheme."""
    engine.set_lights([_turned(0)])
    engine.solve(**_way(tolerance=1e-6, max_iterations=100_000))
    field = engine.surface_field()
    exact, area = np.asarray(field["exitance"], float), np.asarray(field["area"], float)[:, None]
    schemes: dict[str, dict[str, Any]] = {
        "plain": {"solver": "jacobi"},
        "hierarchical": {},
        "adaptive": {"active_layers": ACTIVE_LAYERS},
    }
    found: dict[str, list[tuple[float, float]]] = {}
    for name, options in schemes.items():
        points = []
        for sweeps in _SWEEPS:
            report = engine.solve(**_way(tolerance=TOLERANCE, cycles=sweeps, **options))
            error = np.asarray(engine.surface_field()["exitance"], float) - exact
            points.append((report["work"] * nodes / 1e3, float((area * error**2).sum() / (area * exact**2).sum())))
        found[name] = points
    return found


def to_error(points: Sequence[tuple[float, float]], error: float) -> float | None:
    """Thousands of nodes after which a scheme is below an error; None if it never is."""
    return next((work for work, found in points if found < error), None)


def document(rows: dict[str, dict[str, Any]]) -> str:
    """The table and what the curves say, as Markdown; rows by the paper's name."""
    lines = [
        "| | cubes x cells | nodes, k | MB | t1 / t2 / t3, ms | frames a second | with coherence | gain | of work |",
        "|---|---|--:|--:|---|--:|--:|--:|--:|",
    ]
    for row in TABLE_III:
        t = " / ".join(f"{ms:g}" for ms in row.milliseconds)
        cold, warm = row.frames_per_s
        lines.append(
            f"| {row.name}, published | {row.cubes} x {row.cells}³ | {row.nodes / 1e3:.0f} | {row.megabytes:g} | {t} | "
            f"{cold:g} | {warm:g} | {warm / cold:.2f} | |"
        )
        if row.name in rows:
            lines.append(_line(rows[row.name]))
    lines += ["", "| k nodes to 0.5% | plain | hierarchical | adaptive |", "|---|--:|--:|--:|"]
    for name, found in rows.items():
        cells = [to_error(found["curves"][scheme], 5e-3) for scheme in ("plain", "hierarchical", "adaptive")]
        lines.append(f"| {name} | " + " | ".join("never" if c is None else f"{c:,.0f}" for c in cells) + " |")
    return "\n".join(lines) + "\n"


def _line(found: dict[str, Any]) -> str:
    cold, warm = found["cold"], found["coherent"]
    total = [sum(part[stage] for stage in ("light", "solve", "picture")) for part in (cold, warm)]
    times = " / ".join(f"{cold[stage]:.0f}" for stage in ("light", "solve", "picture"))
    size = "" if found["megabytes"] is None else f"{found['megabytes']:.0f}"
    return (
        f"| {found['body']} | {found['cubes']} x {found['cells']}³ | {found['nodes'] / 1e3:.1f} | {size} | {times} | "
        f"{1e3 / total[0]:.1f} | {1e3 / total[1]:.1f} | {total[0] / total[1]:.2f} | "
        f"{cold['work'] / warm['work']:.2f} |"
    )


def draw(path: Path, rows: dict[str, dict[str, Any]], load: Callable[[str], Any]) -> None:
    """Figure 15 of every row side by side, PNG."""
    pyplot = load("bench")
    figure, axes = pyplot.subplots(1, len(rows), figsize=(4.2 * len(rows), 3.6), squeeze=False, layout="constrained")
    for axis, (name, found) in zip(axes[0], rows.items(), strict=True):
        for scheme, points in found["curves"].items():
            axis.loglog(*np.array(points).T, marker="o", markersize=3, label=scheme)
        axis.set(title=f"{found['body']} (paper: {name})", xlabel="thousand nodes processed", ylabel="squared error")
        axis.axhline(5e-3, color="0.7", linewidth=1)
        axis.legend()
    figure.savefig(path, dpi=100, metadata={"Software": None})
    pyplot.close(figure)
