"""The benchmark's tables for people; those of the solvers and the rivals are docs/benchmarks/README.md's."""

from __future__ import annotations

from typing import Any

from rich.box import MARKDOWN
from rich.table import Table

from quadgraph_validation.benchmark import frame_passes, live_frames


def _table(title: str) -> Table:
    """A table that can be pasted into a Markdown file."""
    return Table(title=title, box=MARKDOWN)


def copy_text(copied: dict[str, Any]) -> str:
    """The device's copy bandwidth in words."""
    return (
        f"copying {copied['bytes'] / 1e6:.0f} MB: {copied['gb_per_s']:.1f} GB/s read and written "
        f"(compute pass {copied['kernel']:.1f}, transfer {copied['transfer']:.1f})"
    )


def all_of(record: dict[str, Any]) -> list[Table]:
    """Return the tables of every part that the record has."""
    shown = frame_passes.tables(record["passes"]) if "passes" in record else []
    shown += live_frames.tables(record["live"]) if "live" in record else []
    shown += [solvers(scene) for scene in record.get("solvers", [])]
    shown += [rivals(scene) for scene in record.get("rivals", [])]
    shown += [scaling(record["scaling"])] if "scaling" in record else []
    return shown + (growth(record["growth"]) if "growth" in record else [])


def solvers(scene: dict[str, Any]) -> Table:
    """Iterations, work and time of every way to the targets on one scene; in brackets how much more than the first."""
    table = _table(f"{scene['name']}, {scene['material']}: least to an error of the unlit side")
    table.add_column("solver", no_wrap=True)
    for entry in scene["ways"][0]["targets"]:
        for column in ("iterations", "work", "ms"):
            table.add_column(f"{100 * entry['unlit']:g}%: {column}", justify="right")
    first = [entry["reached"] for entry in scene["ways"][0]["targets"]]
    for way in scene["ways"]:
        pairs = zip(way["targets"], first, strict=True)
        table.add_row(way["name"], *(cell for entry, best in pairs for cell in _cells(entry["reached"], best)))
    return table


def _cells(point: dict[str, float] | None, best: dict[str, float] | None) -> list[str]:
    if point is None:
        return ["not reached", "", ""]
    ratios = [f" ({point[key] / best[key]:.1f})" if best else "" for key in ("work", "time_ms")]
    return [str(point["iterations"]), f"{point['work']:.1f}{ratios[0]}", f"{point['time_ms']:.0f}{ratios[1]}"]


def rivals(scene: dict[str, Any]) -> Table:
    """Time of all three channels to the targets, and to the residual that our first solver then has."""
    table = _table(f"{scene['name']}, {scene['material']}: three channels on the same cores")
    table.add_column("solver", no_wrap=True)
    table.add_column("set-up, ms", justify="right")
    for target in scene["targets"]:
        for column in ("iterations", "ms", "same residual, ms"):
            table.add_column(f"{100 * target['unlit']:g}%: {column}", justify="right")
    for name in scene["targets"][0]["ours"]:
        points = [target["ours"][name] for target in scene["targets"]]
        cells = [cell for p in points for cell in (str(p["iterations"]), f"{p['wall_ms']:.0f}", "")]
        table.add_row(f"ours, {name}", "", *cells)
    for name, set_up_ms in scene["set_up_ms"].items():
        cells = []
        for goals in (target["rivals"][name] for target in scene["targets"]):
            times = [f"{goals[goal]['time_ms']:.0f}" for goal in ("error", "residual")]
            cells += [str(max(goals["error"]["iterations"])), *times]
        table.add_row(name, f"{set_up_ms:.0f}", *cells)
    whole, unlit = (f"{100 * scene['agreement'][part]:.3f}%" for part in ("whole", "unlit"))
    table.caption = (
        "iterations of the slowest channel; ours with results and estimates. "
        f"The exitance of both sides differs by {whole} over the whole surface, {unlit} over the unlit part"
    )
    return table


def scaling(record: dict[str, Any]) -> Table:
    """Cycles and time by size."""
    table = _table(f"{record['solver']}: to {100 * record['tolerance']:g}% on the unlit side")
    for column in ("tets", "vertices", "levels"):
        table.add_column(column, justify="right")
    models = list(record["exponents"])
    for model in models:
        for column in ("cycles", "by estimate", "work", "ms"):
            table.add_column(f"{model}: {column}", justify="right")
    for body in record["bodies"]:
        cells = [cell for model in models for cell in _scaling_cells(body["models"][model])]
        table.add_row(f"{body['tets']:,}", f"{body['vertices']:,}", str(body["levels"]), *cells)
    fitted = [(model, value) for model, value in record["exponents"].items() if value is not None]
    if fitted:
        table.caption = "time grows as size to the power " + ", ".join(f"{v:.2f} ({m})" for m, v in fitted)
    return table


def _scaling_cells(entry: dict[str, Any]) -> list[str]:
    if entry["cycles"] is None:
        return ["not reached", str(entry["cycles_by_estimate"]), "", ""]
    return [
        str(entry["cycles"]),
        str(entry["cycles_by_estimate"]),
        f"{entry['work']:.1f}",
        f"{entry['time_ms']:.0f}",
    ]


def growth(record: dict[str, Any]) -> list[Table]:
    """Bakes and acquisitions by size, lights and workers."""
    powers = record["exponents"]
    bakes = _table("bakes")
    for column in ("surface vertices", "tets", "s of processors", "most memory, MB", "file, MB"):
        bakes.add_column(column, justify="right")
    for each in record["bakes"]:
        sizes = (f"{each[name] / 1e6:.1f}" for name in ("peak_bytes", "file_bytes"))
        bakes.add_row(f"{each['surface_vertices']:,}", f"{each['tets']:,}", f"{each['cpu_s']:.1f}", *sizes)
    bakes.caption = f"as tets to the power {powers['bake_s']:.2f} (s), {powers['bake_bytes']:.2f} (memory)"
    acquired = _table("acquisitions")
    for column in ("tets", "lights", "s of processors", "steps", "s a step"):
        acquired.add_column(column, justify="right")
    for each in record["acquisitions"]:
        step = f"{each['cpu_s'] / each['steps']:.1f}"
        acquired.add_row(f"{each['tets']:,}", str(each["lights"]), f"{each['cpu_s']:.1f}", str(each["steps"]), step)
    acquired.caption = f"a step with two lights as tets to the power {powers['acquire_step_s']:.2f}"
    workers = _table("bakes by several workers")
    for column in ("workers", "bodies an hour"):
        workers.add_column(column, justify="right")
    for each in record["workers"]:
        workers.add_row(str(each["workers"]), f"{each['bodies_an_hour']:.0f}")
    return [bakes, acquired, workers]
