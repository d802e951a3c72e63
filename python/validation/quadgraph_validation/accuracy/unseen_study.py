"""Bodies, materials and lights that nobody tuned for: the engine's true error beside the one that it prints."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from quadgraph.base.errors import InputError
from quadgraph_validation.accuracy import unseen_engine
from quadgraph_validation.accuracy.unseen_engine import UnseenAnswer, UnseenSetting
from quadgraph_validation.accuracy.unseen_motion import UnseenMotion
from quadgraph_validation.accuracy.unseen_tables import motion_summary, summary, tables  # noqa: F401  as every study has
from quadgraph_validation.base import extra_module
from quadgraph_validation.bodies import unseen_bodies, unseen_cases

if TYPE_CHECKING:
    from quadgraph_validation.truth.kept_walks import KeptWalks

_UNLIT = 0.1  # of the mean q: below it a patch is unlit, as a face is in the engine's report
# Of a run, in its record.
_ASKED = ("seed", "lights", "inter_reflection", "walks", "for_material", "carry", "mean_free_paths")
_FEW = 5  # patches: a part with fewer is not judged


@dataclass(frozen=True)
class UnseenRun:
    """What is judged. count: of seeds from the first; walks: of the truth of each; truths: folder where these are kept;
    sweeps: what solves are asked for, None for the engine's own choice; device: as Engine takes it; lights: beams or
    sky; inter_reflection: in the engine and in the truth; motion: also in frames whose light and material change;
    carry: frames from one with sweeps to the next; for_material: bake for the case's own material in place of for none;
    mean_free_paths: least and most of them across a body's longest side.
    """

    seed: int
    count: int
    walks: int
    truths: Path
    sweeps: Sequence[int | None] = (None,)
    device: str = ""
    lights: str = "beams"
    inter_reflection: bool = True
    motion: bool = False
    carry: int = 1
    for_material: bool = False
    mean_free_paths: tuple[float, float] = unseen_cases.MEAN_FREE_PATHS


def run(wanted: UnseenRun) -> dict[str, Any]:
    """Judge all cases. After Ctrl-C the record has those that were finished.

    Raises InputError, what bakes and solves raise, and KeyboardInterrupt where nothing was finished.
    """
    check(wanted)
    rows: list[dict[str, Any]] = []
    shown = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.percentage:.0f}%"), TimeRemainingColumn())
    with Progress(*shown, console=Console(stderr=True)) as progress:
        bar = progress.add_task("unseen", total=wanted.count * wanted.walks)

        def tell(what: str, walks: int) -> None:
            seed, done = wanted.seed + len(rows), len(rows) * wanted.walks + min(walks, wanted.walks)
            progress.update(bar, description=f"seed {seed}: {what}", completed=done)

        try:
            while len(rows) < wanted.count:
                rows.append(judged(wanted.seed + len(rows), wanted, tell))
        except KeyboardInterrupt:
            if not rows:
                raise
    return record_of(wanted, rows)


def check(wanted: UnseenRun) -> None:
    """Raise InputError for what cannot be judged here."""
    extra_module.load("numba", "walks")
    least, most = wanted.mean_free_paths
    if least > most:
        raise InputError(f"--mean-free-paths: {least:g} {most:g} found; give the smaller number first")
    if wanted.carry > 1 and not wanted.motion:
        raise InputError("--carry: without --motion, of whose frames it is; give both")
    if wanted.motion and wanted.lights != "beams":
        raise InputError(f"--motion: with --lights {wanted.lights}, which does not turn; take --lights beams")


def record_of(wanted: UnseenRun, rows: list[dict[str, Any]]) -> dict[str, Any]:
    """The record of a run with these rows."""
    asked = {key: getattr(wanted, key) for key in _ASKED}
    record = asked | {"rows": rows, "summary": summary(rows)}
    return record | {"motion": motion_summary(rows)} if wanted.motion else record


def judged(seed: int, wanted: UnseenRun, tell: Callable[[str, int], None]) -> dict[str, Any]:
    """One case: what it is, its truth's noise, and what each solve is off. tell: is told what is done, and walks."""
    from quadgraph_validation.truth import kept_walks, unseen_truth

    tell("body", 0)
    low, high = wanted.mean_free_paths
    case = unseen_cases.drawn(seed, unseen_bodies.surface_of(seed), wanted.lights, (low, high))
    case = replace(case, inter_reflection=wanted.inter_reflection)
    truth = unseen_truth.make(case, wanted.walks, wanted.truths, lambda walks: tell("random walks", walks))
    tell("engine", wanted.walks)
    with tempfile.TemporaryDirectory(prefix="quadgraph-unseen-") as folder:
        how = UnseenSetting(wanted.sweeps, wanted.device, wanted.motion, wanted.carry, wanted.for_material)
        found = unseen_engine.answers(case, truth.patch, how, Path(folder))
    parts = parts_of(truth, found.answers[-1].exitance)
    row = {
        "seed": seed,
        "triangles": len(case.surface.triangles),
        "length": float(np.ptp(case.surface.vertices, axis=0).max()),
        "size": case.size,
        "albedo": case.albedo,
        "kind": case.medium.kind,
        "eta": case.medium.eta,
        "light": case.light.text,
        "tets": found.tets,
        "apart": found.apart,
        "walks": truth.batches * kept_walks.BATCH,
        "balance": truth.balance,
        "again": float(truth.again.sum() / truth.scattered.sum()),
        "noise": {name: _rms(truth, part, truth.error) for name, part in parts.items()},
        "solves": [errors(truth, parts, answer) for answer in found.answers],
    }
    return row if found.motion is None else row | {"motion": errors_in_motion(truth, parts, found.motion)}


def parts_of(truth: KeptWalks, exitance: np.ndarray) -> dict[str, np.ndarray]:
    """(n,) bool by name: the patches that count. Those of too few patches, or no brighter than noise, are left out.

    exitance (n,): of the engine, which says what is dimmest: walks would take what their noise makes dim.
    """
    lit = truth.irradiance >= _UNLIT * np.average(truth.irradiance, weights=truth.area)
    order = np.argsort(exitance)
    dimmest = np.zeros(len(order), bool)
    dimmest[order[: len(order) // 3]] = True
    parts = {"whole": np.ones(len(order), bool), "lit": lit, "unlit": ~lit, "dimmest": dimmest}
    return {name: part for name, part in parts.items() if part.sum() >= _FEW and _square(truth, part) > 0}


def errors(truth: KeptWalks, parts: dict[str, np.ndarray], answer: UnseenAnswer) -> dict[str, Any]:
    """What one solve is off, and what it says that it is off, by part."""
    return {
        "sweeps": answer.sweeps,
        "model": answer.model,
        "true": _true(truth, parts, answer.exitance),
        "printed": answer.printed,
        "ratio": float(truth.area @ answer.exitance / (truth.area @ truth.exitance)),
        "seconds": answer.seconds,
    }


def errors_in_motion(truth: KeptWalks, parts: dict[str, np.ndarray], found: UnseenMotion) -> dict[str, Any]:
    """What the last frame is off, what it flickers, and what is left of it after a second in which nothing changes."""
    return {
        "true": _true(truth, parts, found.moving),
        "still": _true(truth, parts, found.still),
        "flicker": {name: _rms(truth, part, found.flicker) for name, part in parts.items()},
        "printed": found.printed,
        "segments": found.segments,
        "seconds": found.seconds,
        "plain": found.plain,
    }


def _true(truth: KeptWalks, parts: dict[str, np.ndarray], exitance: np.ndarray) -> dict[str, float]:
    """By part, without the truth's noise."""
    found = {name: _rms(truth, part, exitance - truth.exitance) for name, part in parts.items()}
    noise = {name: _rms(truth, part, truth.error) for name, part in parts.items()}
    return {name: float(np.sqrt(max(found[name] ** 2 - noise[name] ** 2, 0))) for name in parts}


def _rms(truth: KeptWalks, part: np.ndarray, difference: np.ndarray) -> float:
    """Over a part, weighted by area, relative to the truth without its noise."""
    return float(np.sqrt(truth.area[part] @ difference[part] ** 2 / _square(truth, part)))


def _square(truth: KeptWalks, part: np.ndarray) -> float:
    """Of the exitance of a part, weighted by area, without its noise."""
    return float(truth.area[part] @ (truth.exitance[part] ** 2 - truth.error[part] ** 2))
