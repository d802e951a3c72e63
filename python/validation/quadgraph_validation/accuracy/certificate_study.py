"""What a certificate measures of bodies that nobody tuned for, beside random walks that share no line with it."""

from __future__ import annotations

import tempfile
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from quadgraph import core
from quadgraph.api.engine import Engine
from quadgraph.api.fields import SurfaceField
from quadgraph.api.solution import Solution
from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph.mesh.surface import Surface
from quadgraph_validation.accuracy import unseen_engine
from quadgraph_validation.accuracy.kept_rows import KeptRows, Row
from quadgraph_validation.base import extra_module
from quadgraph_validation.bodies import unseen_bodies, unseen_cases
from quadgraph_validation.bodies.smooth_sky import SmoothSky
from quadgraph_validation.bodies.unseen_cases import UnseenCase

BATCHES = 10  # of the truth
PARTS = ("whole", "unlit", "dimmest")
TOLD = 0.02  # noise of the truth, relative, above which a power is not compared
UNLIT = 0.1  # of the mean irradiance: faces with less are unlit


@dataclass(frozen=True)
class CertificateRun:
    """seed: of the first body; count: of bodies; seconds: of a certificate; walks: of a truth; device: as Engine's."""

    seed: int
    count: int
    seconds: float
    walks: int
    device: str = ""


def run(wanted: CertificateRun, kept: KeptRows | None = None) -> dict[str, Any]:
    """Certify all bodies, or what is not kept. Raises InputError, and what bakes and solves raise."""
    extra_module.load("numba", "walks")
    seeds = range(wanted.seed, wanted.seed + wanted.count)
    cases = [(str(seed), partial(_row, seed, wanted)) for seed in seeds]
    return record_of(wanted, (kept or KeptRows()).complete(cases))


def record_of(wanted: CertificateRun, rows: list[Row]) -> dict[str, Any]:
    """The record of a run with these rows."""
    settings = {"seed": wanted.seed, "seconds": wanted.seconds, "walks": wanted.walks}
    return settings | {"rows": rows, "summary": summary(rows)}


def _row(seed: int, wanted: CertificateRun) -> Row:
    case = unseen_cases.drawn(seed, unseen_bodies.surface_of(seed))
    solution, field, surface = _certified(case, wanted)
    assert solution.certificate is not None
    assert solution.error is not None
    return {
        "seed": seed,
        "light": type(case.light).__name__,
        "kind": case.medium.kind,
        "eta": case.medium.eta,
        "size": case.size,
        "albedo": case.albedo,
        "stated": {part: getattr(solution.error, part) for part in PARTS},
        "certificate": asdict(solution.certificate),
        "deviations": _deviations(case, solution, field, surface, wanted.walks),
    }


def _certified(case: UnseenCase, wanted: CertificateRun) -> tuple[Solution, SurfaceField, Surface]:
    assert not isinstance(case.light, SmoothSky)
    with tempfile.TemporaryDirectory(prefix="quadgraph-certificate-") as name:
        mesh, file = Path(name) / "body.ply", Path(name) / "body.qgraph"
        unseen_bodies.write(mesh, case.surface)
        bake(mesh, file, BakeOptions(unit="mm"))
        with Engine(file, device=wanted.device) as engine:
            engine.material = unseen_engine.material_of(case.medium)
            engine.lights = [case.light]
            solution, field = engine.solve(certify=wanted.seconds), engine.surface()
        level = core.load(file).levels[0]
        return solution, field, Surface(level.vertices.astype(np.float64), level.faces.astype(np.int64))


def _deviations(
    case: UnseenCase, solution: Solution, field: SurfaceField, surface: Surface, walks: int
) -> dict[str, float]:
    """By part whose power the truth can tell, what the certificate's is off by, in standard errors of both."""
    from quadgraph_validation.truth import mesh_walk

    q = field.q.sum(axis=1)
    unlit = q < UNLIT * np.average(q, weights=field.area)
    walker = mesh_walk.MeshWalker(surface, case.medium, case.light, unlit.astype(int))
    count = walks // BATCHES
    powers = np.array([walker.batch(count, number, case.seed).scattered for number in range(BATCHES)])
    solved = field.area * field.exitance[:, 0]
    parts = {"whole": (solved.sum(), powers.sum(axis=1))}
    if unlit.any() and powers.shape[1] > 1:
        parts["unlit"] = (solved[unlit].sum(), powers[:, 1])
    found = {}
    for name, (power, truth) in parts.items():
        noise = truth.std(ddof=1) / np.sqrt(BATCHES) / truth.mean()
        part = getattr(solution.certificate, name)
        expected = power / truth.mean() - 1
        if noise < TOLD and part.power_noise > 0:
            found[name] = float((part.power - expected) / np.hypot(part.power_noise, noise * (1 + expected)))
    return found


def summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Of even media and of mixed ones, whose tets have one value each: how many powers were compared, and shares within
    two and three standard errors. And by part the ratios of what is stated and what is measured, least, median and
    most, where the measured error is above three times its noise.
    """
    found: dict[str, Any] = {"deviations": {}, "ratios": {}}
    for name, even in (("even", True), ("mixed", False)):
        of = np.abs([d for row in rows if (row["kind"] == "even") == even for d in row["deviations"].values()])
        shares = [float((of < limit).mean()) for limit in (2, 3)] if of.size else []
        found["deviations"][name] = {"powers": int(of.size), "within": shares}
    for part in PARTS:
        told = [row for row in rows if row["certificate"][part]["error"] > 3 * row["certificate"][part]["error_noise"]]
        ratios = [row["stated"][part] / row["certificate"][part]["error"] for row in told]
        found["ratios"][part] = {"cases": len(told), "of": np.quantile(ratios, (0, 0.5, 1)).tolist() if told else []}
    return found


def tables(record: dict[str, Any]) -> list[Table]:
    """Each body's certificate, and all together."""
    title = "error of the exitance, %: stated; measured (power)"
    cases = Table("seed", "light", "material", *PARTS, "million walks", title=title)
    for row in record["rows"]:
        material = f"{row['kind']}, eta {row['eta']:.2f}, {row['size']:.0f} mfp, {row['albedo']:.3f}"
        shown = [_text(row["stated"][part], row["certificate"][part]) for part in PARTS]
        cases.add_row(str(row["seed"]), row["light"], material, *shown, f"{row['certificate']['walks'] / 1e6:.1f}")
    together = Table("", "powers", "within 2 and 3 standard errors of walks that share nothing")
    for name, of in record["summary"]["deviations"].items():
        together.add_row(name, str(of["powers"]), " / ".join(f"{100 * share:.0f}%" for share in of["within"]))
    ratios = Table("", "cases", "stated over measured: least / median / most")
    for part, of in record["summary"]["ratios"].items():
        ratios.add_row(part, str(of["cases"]), " / ".join(f"{value:.2f}" for value in of["of"]))
    return [cases, together, ratios]


def _text(stated: float, found: dict[str, float]) -> str:
    if found["power_noise"] == 0:
        return f"{100 * stated:.1f}; -"
    error, noise, power, power_noise = (100 * found[name] for name in ("error", "error_noise", "power", "power_noise"))
    return f"{100 * stated:.1f}; {error:.1f} ± {noise:.1f} ({power:+.2f} ± {power_noise:.2f})"
