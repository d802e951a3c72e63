"""The wide-field example of redbirdpy by redbirdpy, by pmmc and by the engine, on the same tets: error, time, memory.

What leaves a block in light that falls on a square, against many more walks of pmmc; and the block's two coefficients,
fitted through each way's predictions to what these walks measured on the faces.
"""

from __future__ import annotations

import os
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph.base.progress import ProgressCallback
from quadgraph_validation.accuracy import wide_field_case as case
from quadgraph_validation.accuracy import wide_field_ways as ways
from quadgraph_validation.accuracy.wide_field_case import MEDIUM, REGIONS, Left, Truth
from quadgraph_validation.base.apart import apart
from quadgraph_validation.base.thread_count import limited_threads
from quadgraph_validation.bodies import boxes, unseen_bodies
from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.truth import pmmc_walk

INTERIOR = 2.5  # mm, edges of tets: redbirdpy's example asks for tets of 2 mm^3 at most
START = Medium(2.0, 0.02)  # of the fit
_PER_MM = 0.4  # faces along an edge
_LEAST = 0.02  # of a patch, how far it counts as uncertain at least, in the fit
_STEPS = 6  # of redbirdpy's own reconstruction
_STEP = 0.05  # of logarithms, for differences
_FITTED = ("redbirdpy, cg+amg", "ours, --no-correction", "ours")


@dataclass(frozen=True)
class WideFieldRun:
    """walks: of the truth; device: as Engine takes it; threads: that each way may have; interior: mm, edges of tets."""

    walks: int
    device: str = ""
    threads: int = 1
    interior: float = INTERIOR


def run(wanted: WideFieldRun, tell: ProgressCallback) -> dict[str, Any]:
    """Measure all. Raises InputError without redbirdpy or pmmc, and what bakes and solves raise."""
    ways.redbird()
    pmmc_walk.load()
    with tempfile.TemporaryDirectory(prefix="quadgraph-wide-field-") as name, limited_threads(wanted.threads):
        path = Path(name) / "block.qgraph"
        tell("bake")
        begun = time.perf_counter()
        write(path, wanted.interior)
        bake_s = time.perf_counter() - begun
        true = case.truth(wanted.walks, tell)
        rows, fits = [], []
        for way in ways.WAYS:
            tell(way)
            rows.append(row(way, apart(ways.measured, way, path, wanted.device), true))
        for way in _FITTED:
            tell(f"fit, {way}")
            fits.append({"name": way} | apart(fitted, way, path, wanted.device, true))
        tell("redbirdpy's reconstruction")
        fits.append(apart(reconstructed, path, true))
    return {
        "walks": wanted.walks,
        "threads": wanted.threads,
        "load": round(os.getloadavg()[0], 1),
        "bake_s": bake_s,
        "truth": {"power": true.mean.power, "power_error": true.power_error},
        "detector_error": true.error.detector / true.mean.detector,
        "rows": rows,
        "fits": fits,
    }


def write(path: Path, interior: float) -> None:
    """Bake the block."""
    mesh = path.with_suffix(".ply")
    unseen_bodies.write(mesh, boxes.surface(case.SIDES, _PER_MM))
    bake(mesh, path, BakeOptions(unit="mm", interior=interior))


def row(name: str, found: ways.WayTaken, true: Truth) -> dict[str, Any]:
    """What a way is off by, and takes."""
    taken = {key: getattr(found, key) for key in ("set_up_s", "solve_s", "clock_s", "peak_bytes", "tets")}
    return {"name": name} | case.judged(found.left, true) | taken


def fitted(name: str, path: Path, device: str, true: Truth) -> dict[str, Any]:
    """sigma_s' and sigma_a that make a way's patches those of the truth, from START, by least squares in logarithms."""
    from scipy.optimize import least_squares

    solve = ways.WAYS[name](path, device)
    exact, noise = _patches(true.mean), _patches(true.error)
    weight = 1 / np.hypot(noise, _LEAST * exact)

    def residuals(logarithms: np.ndarray) -> np.ndarray:
        return (_patches(solve(Medium(*np.exp(logarithms)))) - exact) * weight

    begun, used = time.perf_counter(), time.process_time()
    start = np.log([START.sigma_s_prime, START.sigma_a])
    done = least_squares(residuals, start, _differences(residuals), method="lm", ftol=1e-4, xtol=1e-4)
    found = Medium(*np.exp(done.x))
    return {
        "sigma_s_prime": found.sigma_s_prime / MEDIUM.sigma_s_prime - 1,
        "sigma_a": found.sigma_a / MEDIUM.sigma_a - 1,
        "residual": float(np.sqrt((done.fun**2).mean())),
        "seconds": time.perf_counter() - begun,
        "processor_s": time.process_time() - used,
        "solves": int(done.nfev + 2 * done.njev),
    }


def reconstructed(path: Path, true: Truth) -> dict[str, Any]:
    """sigma_a by redbirdpy's own reconstruction from what its detector reads, with the right sigma_s'."""
    begun, used = time.perf_counter(), time.process_time()
    found = ways.reconstructed(path, true.mean.detector, START.sigma_a, _STEPS)
    return {
        "name": "redbirdpy's own, by its detector",
        "sigma_a": found / MEDIUM.sigma_a - 1,
        "seconds": time.perf_counter() - begun,
        "processor_s": time.process_time() - used,
        "solves": _STEPS,
    }


def _differences(residuals: Any) -> Any:
    def jacobian(logarithms: np.ndarray) -> np.ndarray:
        there = residuals(logarithms)
        steps = _STEP * np.eye(len(logarithms))
        return np.column_stack([(residuals(logarithms + step) - there) / _STEP for step in steps])

    return jacobian


def _patches(left: Left) -> np.ndarray:
    return np.concatenate([left.regions()[name] for name in REGIONS])


def tables(record: dict[str, Any]) -> list[Table]:
    """Errors, time and memory; and what was fitted."""
    noise = record["rows"][0]["noise"]
    title = f"a block in wide light, {record['rows'][0]['tets']:,} tets, {record['threads']} thread: off by, %"
    table = Table(title=title)
    for head in ("", "power out", *REGIONS, "detector", "set-up, CPU s", "solve, CPU s", "by the clock", "MB"):
        table.add_column(head)
    for each in record["rows"]:
        table.add_row(
            each["name"],
            f"{100 * each['power']:+.2f}",
            *(f"{100 * each['rms'][name]:.2f}" for name in REGIONS),
            f"{100 * each['detector']:+.2f}",
            *(f"{each[key]:.2f}" for key in ("set_up_s", "solve_s", "clock_s")),
            f"{each['peak_bytes'] / 1e6:.0f}",
        )
    error = 100 * record["truth"]["power_error"] / record["truth"]["power"]
    own = [f"{100 * noise[name]:.2f}" for name in REGIONS]
    table.add_row("the truth's noise", f"{error:.2f}", *own, f"{100 * record['detector_error']:.2f}")
    fits = Table(title="coefficients fitted to the truth's patches: off by, %")
    for head in ("", "sigma_s'", "sigma_a", "solves", "s", "CPU s"):
        fits.add_column(head)
    for each in record["fits"]:
        off = [f"{100 * each[key]:+.2f}" if key in each else "told" for key in ("sigma_s_prime", "sigma_a")]
        fits.add_row(each["name"], *off, str(each["solves"]), *(f"{each[k]:.1f}" for k in ("seconds", "processor_s")))
    return [table, fits]
