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
    {"method": "fem", "model": "diffusion", "source": "buried", "solver": "dpcg"},
    {"method": "fem", "model": "sp3", "source": "buried", "solver": "dpcg"},
    {"method": "fem", "model": "diffusion", "source": "buried", "solver": "cascade"},
    {"method": "quadgraph-fv", "model": "diffusion", "source": "buried", "solver": "dpcg"},
    {"method": "quadgraph-fdm", "model": "diffusion", "source": "diffuse", "solver": "dpcg"},
    {"method": "quadgraph-fdm", "model": "diffusion", "source": "diffuse", "solver": "cascade"},
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
        "methods": [measure(engines, args.material, way, args.repeats) for way in METHODS],
    }
    console.print(f"device: {record['device']}, driver: {record['driver']}, commit: {record['commit']}")
    console.print(text.size_text(first))
    for entry in record["methods"]:
        table = text.pass_table(entry["passes"])
        table.title = f"{name_of(entry)}, {entry['iterations']} iterations (coarsest to finest)"
        console.print(table)
    console.print(cost_table(record["methods"]))
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


def name_of(entry: dict) -> str:
    """One way to solve in words."""
    return " ".join(entry[key] for key in ("method", "model", "source", "solver"))


def measure(engines: dict, material: str, way: dict, repeats: int) -> dict:
    """Whole frames, alternating between the engines; the median time of every pass."""
    frames: dict[str, list[list[dict]]] = {name: [] for name in engines}
    reports = {}
    before = engines["blocks"].device_bytes
    for _ in range(repeats):
        for name, engine in engines.items():
            engine.set_material(material)
            engine.set_lights(scene.load_core().default_lights())
            reports[name] = engine.solve(**way, tolerance=1e-3)
            engine.render()
            frames[name].append(engine.passes)
    levels = reports["blocks"]["levels"]
    entry = way | {
        "iterations": [level["iterations"] for level in levels],
        "unknowns": [level["unknowns"] for level in levels],
        "added_bytes": engines["blocks"].device_bytes - before,
        "error": reports["blocks"]["error"],
        "passes": median_passes(frames["blocks"]),
    }
    if "random" in frames:
        entry["random_order_passes"] = median_passes(frames["random"])
    return entry


def median_passes(frames: list[list[dict]]) -> list[dict]:
    """Median time over the frames of each pass of the last one, with GB/s from it; what only the first needs is out."""
    passes = []
    for entry in frames[-1]:
        same = [p for frame in frames for p in frame if p["name"] == entry["name"]]
        time_ms = statistics.median(p["time_ms"] for p in same)
        merged = entry | {"time_ms": time_ms}
        passes.append(merged | {"gb_per_s": text.bandwidth(merged)})
    return passes


# What a frame does for the picture, not for the solution.
PICTURE_PASSES = ("shadow maps", "irradiance", "surface", "resolve")


def application_ms(entry: dict) -> float:
    """Time of one application of the finest operator: that of all of them, shared out by unknowns."""
    spent = sum(p["time_ms"] for p in entry["passes"] if p["name"] in ("cg-multiply", "sweep"))
    finest = entry["unknowns"][-1]
    return spent / sum(n * size / finest for n, size in zip(entry["iterations"], entry["unknowns"], strict=True))


def cost_table(methods: list[dict]) -> Table:
    """Return assembly, source walk and solve in applications of the finest operator, and times against the first."""
    table = Table("", "assembly", "walk", "all / first", "MB", title="cost of a solution")
    table.columns[0].no_wrap = True
    table.caption = (
        "assembly and source walk on all levels, in applications of the same operator on the finest level; all passes "
        "of the solution against the first row; memory that it adds"
    )
    solve = [sum(p["time_ms"] for p in e["passes"] if p["name"] not in PICTURE_PASSES) for e in methods]
    for entry, spent in zip(methods, solve, strict=True):
        of = {p["name"]: p["time_ms"] for p in entry["passes"]}
        unit = application_ms(entry)
        table.add_row(
            name_of(entry),
            f"{of['assembly'] / unit:.1f}",
            f"{of.get('source walk', 0.0) / unit:.1f}",
            f"{spent / solve[0]:.2f}",
            f"{entry['added_bytes'] / 1e6:.0f}",
        )
    return table


def order_table(methods: list[dict]) -> Table:
    """Return time in random order over time in blocks, for passes of at least a tenth of the frame."""
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


def commit() -> str:
    """Return the commit of the source tree with '-dirty' if it was changed, 'unknown' outside one."""
    command = ["git", "-C", str(Path(__file__).parent), "describe", "--always", "--dirty", "--abbrev=12"]
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True, timeout=10).stdout.strip()
    except (OSError, subprocess.SubprocessError):
        return "unknown"
