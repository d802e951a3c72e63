"""How cycles and time grow with the size: one body, the bunny at 100 mm, at growing resolutions.

Every size is simplified from the bundled mesh; finer ones than that are then subdivided (Loop). All are baked as usual.
A body has about six tets per surface vertex.
"""

from __future__ import annotations

import math
import time
from dataclasses import replace
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Any

import numpy as np

from quadgraph.base.progress import ProgressCallback
from quadgraph_validation.benchmark.algebraic_error import judge
from quadgraph_validation.benchmark.bench_scene import LIGHT, Device
from quadgraph_validation.benchmark.solver_convergence import OURS, SolverRunner, SolverWay
from quadgraph_validation.bodies.bunny import bunny_mesh

if TYPE_CHECKING:
    from quadgraph.core import Engine

SURFACE_VERTICES = (500, 1800, 8500, 28_000, 80_000, 165_000, 330_000)
MODELS = ("diffusion", "sp3")
TOLERANCE = 1e-3  # error of the unlit part that the cycles are counted to
FITTED_FROM = 50_000  # tets; smaller bodies are all overhead
HEIGHT_MM = 100.0
_BUNNY_VERTICES = 28_000  # below those of the bundled mesh, so that it can be simplified to them
_MOST_CYCLES = 40
_NO_SECOND_LEVEL = 1500  # surface vertices below which the chain of levels may end at once
_LIMITS: dict[str, Any] = {"time_limit_s": 3600.0, "memory_limit_bytes": 24 << 30}


def run(
    folder: Path, sizes: tuple[int, ...], device: Device, repeats: int, tell: ProgressCallback, way: SolverWay = OURS
) -> dict[str, Any]:
    """Bake into `folder` what is not there from an earlier run, count cycles, take times (medians of `repeats`).

    Raises InputError, ToolError, SolverError.
    """
    bodies = []
    for size in sizes:
        path, seconds = _baked(folder, size, tell)
        engine = device.open(path, "marble", [LIGHT])
        level = engine.graph.levels[0]
        counts = {"tets": len(level.tets), "vertices": len(level.vertices), "levels": len(engine.graph.levels)}
        entry = {"surface_vertices": size} | counts
        tell(f"{entry['tets']:,} tets: cycles and time")
        models = {model: _measure(engine, replace(way, model=model), repeats) for model in MODELS}
        bodies.append(entry | {"bake_s": seconds, "models": models})
    return {
        "height_mm": HEIGHT_MM,
        "solver": way.solver,
        "tolerance": TOLERANCE,
        "repeats": repeats,
        "bodies": bodies,
        "exponents": {model: exponent(bodies, model) for model in MODELS},
    }


def exponent(bodies: list[dict[str, Any]], model: str) -> float | None:
    """Slope of log time over log tets for the bodies of FITTED_FROM tets and more; None for fewer than two."""
    fitted = [b for b in bodies if b["tets"] >= FITTED_FROM and b["models"][model]["time_ms"] is not None]
    if len(fitted) < 2:
        return None
    times = [body["models"][model]["time_ms"] for body in fitted]
    return float(np.polyfit(np.log([body["tets"] for body in fitted]), np.log(times), 1)[0])


def _baked(folder: Path, size: int, tell: ProgressCallback) -> tuple[Path, float | None]:
    """The body with about `size` surface vertices, and seconds of its bake; None if it was there."""
    from quadgraph.baking.pipeline import BakeOptions, bake

    path = folder / f"bunny-{size}.qgraph"
    if path.exists():
        return path, None
    steps = max(0, math.ceil(math.log(size / _BUNNY_VERTICES, 4)))
    mesh = _subdivided(folder, size, steps) if steps else bunny_mesh()
    # The smallest bodies would get one level, which has no cycles.
    options = BakeOptions(
        height_mm=HEIGHT_MM,
        surface_vertices=None if steps else size,
        levels=2 if size < _NO_SECOND_LEVEL else None,
        **_LIMITS,
    )
    start = time.perf_counter()
    bake(mesh, path, options, lambda text: tell(f"{size:,} surface vertices: {text}"))
    return path, time.perf_counter() - start


def _subdivided(folder: Path, size: int, steps: int) -> Path:
    """The bundled mesh, simplified so that `steps` subdivisions of a triangle into four bring it to `size` vertices."""
    import pymeshlab

    from quadgraph.mesh import lod, mesh_io

    coarse = lod.simplify(mesh_io.read_surface(bunny_mesh(), height_mm=HEIGHT_MM).surface, size // 4**steps)
    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(coarse.vertices, coarse.triangles))
    meshes.meshing_surface_subdivision_loop(iterations=steps, threshold=pymeshlab.PercentageValue(0))
    path = folder / f"bunny-{size}.ply"
    meshes.save_current_mesh(str(path))
    return path


def _measure(engine: Engine, way: SolverWay, repeats: int) -> dict[str, Any]:
    """Least cycles to the tolerance in the unlit part, by the true error, and by the solver's own; work; time of it."""
    runner = SolverRunner(engine, way, judge(engine, **way.system))
    point = next((point for n in range(1, _MOST_CYCLES) if (point := runner.at(n, TOLERANCE)).unlit <= TOLERANCE), None)
    report = engine.solve(**way.system, solver=way.solver, tolerance=TOLERANCE, inter_reflection=False)
    found = {"cycles_by_estimate": report["levels"][-1]["iterations"]}
    if point is None:
        return found | {"cycles": None, "time_ms": None}
    for _ in range(repeats):
        runner.time(point)
    return found | {
        "cycles": point.iterations,
        "work": point.work,
        "whole": point.whole,
        "unlit": point.unlit,
        "time_ms": median(point.time_ms),
        "wall_ms": median(point.wall_ms),
        **point.timed(),
    }
