"""`quadgraph bench`: time and bytes per pass, and what the cache-local order gains."""

from __future__ import annotations

import argparse
import statistics
import subprocess
import tempfile
from pathlib import Path

from rich.console import Console
from rich.table import Table

from quadgraph import __version__, atomic_file
from quadgraph.commands import report as text
from quadgraph.commands import scene
from quadgraph.errors import InputError

# Relaxation of quadgraph-fv is left out: its stiff surface links take it thousands of sweeps.
METHODS = (
    ("fem", "dpcg"),
    ("fem", "cascade"),
    ("quadgraph-fv", "dpcg"),
    ("quadgraph-fdm", "dpcg"),
    ("quadgraph-fdm", "cascade"),
)


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser("bench", help="time and bytes per pass", description=__doc__)
    parser.add_argument(
        "file",
        metavar="FILE",
        type=Path,
        nargs="?",
        help="a baked .qgraph (default: pymeshlab's bunny, 60 mm high, baked in both orders for the occasion)",
    )
    parser.add_argument(
        "--random-order",
        type=Path,
        metavar="FILE",
        help="the same object baked with --order random: every measurement alternates between the two files",
    )
    parser.add_argument("--repeats", type=scene.positive_int, default=3, metavar="N", help="default: %(default)s")
    parser.add_argument("--material", default="marble", metavar="M", help="default: %(default)s")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the record here")
    scene.add_device_arguments(parser)


def run(args: argparse.Namespace) -> int:
    """Measure, print, record; 0 on success."""
    if args.file:
        files = {"blocks": args.file} | ({"random": args.random_order} if args.random_order else {})
        return run_on(files, args)
    if args.random_order:
        raise InputError("--random-order needs the FILE to compare with")
    with tempfile.TemporaryDirectory(prefix="quadgraph-bench-") as folder:
        return run_on(bake_bunny(Path(folder)), args)


def bake_bunny(folder: Path) -> dict[str, Path]:
    """Bake the bundled bunny in both orders; the fixed scene of the benchmark."""
    import pymeshlab

    from quadgraph.bake import BakeOptions, bake

    mesh = Path(pymeshlab.__file__).parent / "tests" / "sample_meshes" / "bunny.obj"
    files = {order: folder / f"bunny-{order}.qgraph" for order in ("blocks", "random")}
    with Console(stderr=True).status("baking the bunny in both orders"):
        for order, path in files.items():
            bake(mesh, path, BakeOptions(height_mm=60.0, order=order))
    return files


def run_on(files: dict[str, Path], args: argparse.Namespace) -> int:
    """Measure the same object in one or both orders."""
    engines = {order: open_engine(args, path) for order, path in files.items()}
    console = Console(highlight=False)
    first = engines["blocks"]
    record = {
        "device": first.device_name,
        "driver": first.driver,
        "commit": commit(),
        "version": __version__,
        "file": files["blocks"].name,
        "nodes": len(first.graph.levels[0].nodes),
        "vertices": len(first.graph.levels[0].vertices),
        "levels": len(first.graph.levels),
        "material": args.material,
        "repeats": args.repeats,
        "methods": [measure(engines, args.material, method, solver, args.repeats) for method, solver in METHODS],
    }
    console.print(f"device: {record['device']}, driver: {record['driver']}, commit: {record['commit']}")
    console.print(text.size_text(first))
    for entry in record["methods"]:
        table = text.pass_table(entry["passes"])
        table.title = f"{entry['method']} / {entry['solver']}, {entry['iterations']} iterations (coarsest to finest)"
        console.print(table)
    if "random" in engines:
        console.print(order_table(record["methods"]))
    if args.json:
        atomic_file.write_json(args.json, record)
    return 0


def open_engine(args: argparse.Namespace, path: Path):
    """Load one file with the benchmark's material and lights."""
    engine = scene.load_core().Engine(path, device=args.device, validation=args.validation)
    engine.set_material(args.material)
    engine.set_lights(scene.load_core().default_lights())
    return engine


def measure(engines: dict, material: str, method: str, solver: str, repeats: int) -> dict:
    """Whole frames, alternating between the engines; the median time of every pass."""
    frames: dict[str, list[list[dict]]] = {name: [] for name in engines}
    reports = {}
    for _ in range(repeats):
        for name, engine in engines.items():
            engine.set_material(material)
            engine.set_lights(scene.load_core().default_lights())
            reports[name] = engine.solve(method=method, solver=solver, tolerance=1e-3)
            engine.render()
            frames[name].append(engine.passes)
    entry = {
        "method": method,
        "solver": solver,
        "iterations": [level["iterations"] for level in reports["blocks"]["levels"]],
        "error": reports["blocks"]["error"],
        "passes": median_passes(frames["blocks"]),
    }
    if "random" in frames:
        entry["random_order_passes"] = median_passes(frames["random"])
    return entry


def median_passes(frames: list[list[dict]]) -> list[dict]:
    """Median time of each pass over the frames, with GB/s from it."""
    passes = []
    for position, entry in enumerate(frames[0]):
        time_ms = statistics.median(frame[position]["time_ms"] for frame in frames)
        merged = entry | {"time_ms": time_ms}
        passes.append(merged | {"gb_per_s": text.bandwidth(merged)})
    return passes


def order_table(methods: list[dict]) -> Table:
    """Return time in random order over time in blocks, for passes of at least a tenth of the frame."""
    table = Table("method", "pass", "blocks ms", "random ms", "random / blocks", title="order of the nodes")
    table.columns[0].no_wrap = True
    for entry in methods:
        for ours, theirs in zip(entry["passes"], entry["random_order_passes"], strict=True):
            if ours["time_ms"] > 0.1 * sum(p["time_ms"] for p in entry["passes"]):
                table.add_row(
                    f"{entry['method']} / {entry['solver']}",
                    ours["name"],
                    f"{ours['time_ms']:.2f}",
                    f"{theirs['time_ms']:.2f}",
                    f"{theirs['time_ms'] / ours['time_ms']:.2f}",
                )
    return table


def commit() -> str:
    """Return the commit of the source tree with '-dirty' if it was changed, 'unknown' outside one."""
    command = ["git", "-C", str(Path(__file__).parent), "describe", "--always", "--dirty", "--abbrev=12"]
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True, timeout=10).stdout.strip()
    except (OSError, subprocess.SubprocessError):
        return "unknown"
