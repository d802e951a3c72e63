"""Time, bytes and share of the copy bandwidth of every pass of a frame, for the ways to solve."""

from __future__ import annotations

import statistics
from typing import TYPE_CHECKING, Any

from rich.table import Table

from quadgraph.base import pass_report
from quadgraph.core import load_core
from quadgraph_validation.benchmark import figures

if TYPE_CHECKING:
    from quadgraph.core import Engine

# Relaxation of quadgraph-fv is left out: its stiff surface links take it thousands of sweeps.
METHODS = (
    {"method": "fem", "model": "diffusion", "source": "buried", "solver": "fmg-pcg"},
    {"method": "fem", "model": "sp3", "source": "buried", "solver": "fmg-pcg"},
    {"method": "fem", "model": "diffusion", "source": "buried", "solver": "dpcg"},
    {"method": "fem", "model": "diffusion", "source": "buried", "solver": "cascade"},
    {"method": "quadgraph-fv", "model": "diffusion", "source": "buried", "solver": "dpcg"},
    {"method": "quadgraph-fdm", "model": "diffusion", "source": "diffuse", "solver": "dpcg"},
    {"method": "quadgraph-fdm", "model": "diffusion", "source": "diffuse", "solver": "cascade"},
)

# What a frame does for the light on the surface and for the picture, not for the solution.
PICTURE_PASSES = ("shadow maps", "irradiance", "visibility", "coverage", "shading")

# What iterating consists of, on all levels.
SOLVER_PASSES = (
    "residual",
    "cg-multiply",
    "cg-update",
    "cg-direction",
    "sweep",
    "smoothing",
    "coarse residual",
    "restriction",
    "prolongation",
    "coarse solve",
    "correction",
    "transfer",
    "surface change",
)


def measure(
    engines: dict[str, Engine], material: str, way: dict[str, Any], repeats: int, copy_gb_per_s: float
) -> dict[str, Any]:
    """Whole frames, alternating between the engines ("blocks", perhaps "random"); the median time of every pass.

    A first frame of each engine, which makes room, is left out.
    """
    frames: dict[str, list[list[dict]]] = {name: [] for name in engines}
    reports = {}
    before = engines["blocks"].device_bytes
    lights = load_core().default_lights()
    for number in range(repeats + 1):
        for name, engine in engines.items():
            engine.set_material(material)
            # In another order each time: shadow maps of lights that have not changed would not be drawn.
            engine.set_lights(lights[:: 1 if number % 2 else -1])
            reports[name] = engine.solve(**way, tolerance=1e-3)
            engine.render(samples=4)
            if number > 0:
                frames[name].append(engine.passes)
    levels = reports["blocks"]["levels"]
    entry = way | {
        "iterations": [level["iterations"] for level in levels],
        "unknowns": [level["unknowns"] for level in levels],
        "work": reports["blocks"]["work"],
        "added_bytes": engines["blocks"].device_bytes - before,
        "error": reports["blocks"]["error"],
        "passes": median_passes(frames["blocks"], copy_gb_per_s),
        "frames": frame_figures(frames["blocks"]),
    }
    if "random" in frames:
        entry["random_order_passes"] = median_passes(frames["random"], copy_gb_per_s)
        entry["random_order_frames"] = frame_figures(frames["random"])
    return entry


def median_passes(frames: list[list[dict]], copy_gb_per_s: float) -> list[dict[str, Any]]:
    """For each pass of the last frame: median time over all frames, GB/s, and its share of the copy bandwidth."""
    passes = []
    for entry in frames[-1]:
        same = [p for frame in frames for p in frame if p["name"] == entry["name"]]
        merged = entry | {"time_ms": statistics.median(p["time_ms"] for p in same)}
        speed = pass_report.bandwidth(merged)
        passes.append(merged | {"gb_per_s": speed, "copy_share": speed / copy_gb_per_s})
    return passes


def frame_figures(frames: list[list[dict]]) -> dict[str, figures.Figure]:
    """Time over the frames, of each pass that all frames have, by name, and of all passes together, under ""."""
    by_pass = [pass_report.ms_by_pass(frame) for frame in frames]
    common = [name for name in by_pass[0] if all(name in frame for frame in by_pass)]
    found = {"": figures.times([sum(frame.values()) for frame in by_pass])}
    return found | {name: figures.times([frame[name] for frame in by_pass]) for name in common}


def name_of(entry: dict[str, Any]) -> str:
    """One way to solve in words."""
    return " ".join(entry[key] for key in ("method", "model", "source", "solver"))


def tables(methods: list[dict[str, Any]]) -> list[Table]:
    """Return the passes of every way, what a solution costs, and what the order of the nodes is worth."""
    shown = [_pass_table(entry) for entry in methods] + [_cost_table(methods)]
    return shown + ([_order_table(methods)] if "random_order_passes" in methods[0] else [])


def _pass_table(entry: dict[str, Any]) -> Table:
    table = pass_report.pass_table(entry["passes"])
    table.title = f"{name_of(entry)}, {entry['iterations']} iterations (coarsest to finest)"
    return table


def _unit_ms(entry: dict[str, Any]) -> float:
    """Time of one unit of work: of an application of the finest operator with all that the solver does beside it."""
    return sum(p["time_ms"] for p in entry["passes"] if p["name"] in SOLVER_PASSES) / entry["work"]


def _cost_table(methods: list[dict[str, Any]]) -> Table:
    table = Table("", "work", "assembly", "walk", "all / first", "MB", title="cost of a solution")
    table.columns[0].no_wrap = True
    table.caption = (
        "work in applications of the finest operator; assembly and source walk on all levels, in units of that work; "
        "all passes of the solution against the first row; memory that it adds"
    )
    solve = [sum(p["time_ms"] for p in e["passes"] if p["name"] not in PICTURE_PASSES) for e in methods]
    for entry, spent in zip(methods, solve, strict=True):
        of = {p["name"]: p["time_ms"] for p in entry["passes"]}
        unit = _unit_ms(entry)
        table.add_row(
            name_of(entry),
            f"{entry['work']:.1f}",
            f"{of['assembly'] / unit:.1f}",
            f"{of.get('source walk', 0.0) / unit:.1f}",
            f"{spent / solve[0]:.2f}",
            f"{entry['added_bytes'] / 1e6:.0f}",
        )
    return table


def _order_table(methods: list[dict[str, Any]]) -> Table:
    """Time in random order over time in blocks, for passes of at least a tenth of the frame."""
    table = Table("", "pass", "ms", "random ms", "ratio", title="order of the nodes: in blocks, and at random")
    table.columns[0].no_wrap = True
    for entry in methods:
        for ours, theirs in zip(entry["passes"], entry["random_order_passes"], strict=True):
            if ours["time_ms"] > 0.1 * sum(p["time_ms"] for p in entry["passes"]):
                table.add_row(
                    name_of(entry),
                    ours["name"],
                    f"{ours['time_ms']:.2f}",
                    f"{theirs['time_ms']:.2f}",
                    f"{theirs['time_ms'] / ours['time_ms']:.2f}",
                )
    return table
