"""Whether an answer can be right: finite, in balance within what is printed, and that of the undamaged body."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from attack.bodies import SOLVED
from attack.case import Outcome, Place

Judge = Callable[[Place, Outcome], str]
LEAST_BALANCE = 5e-4  # of the light that enters, which is never held against an answer (docs/limits.md)
SAME = 0.01  # relative RMS error between two solves of one system
PICTURED = ("--size", "48x48", "--device", "cpu", "--background", "black", "--radiance", "lambertian", *SOLVED)
DEVICE = ("--device", "cpu")


def solve(body: str = "body.qgraph", *more: str) -> tuple[str, ...]:
    """A solve that writes report.json and field.npz."""
    options = more or SOLVED
    return ("quadgraph", "solve", body, *DEVICE, "--json", "report.json", "--field", "field.npz", *options)


SOLVE_OUTPUTS = ("report.json", "field.npz")


def engine(file: str = "body.qgraph", *more: str) -> tuple[str, ...]:
    """A picture by the executable, out.png, whose report is on standard output."""
    return ("quadgraph-engine", file, "--headless", *DEVICE, "--json", "-o", "out.png", "--size", "32x32", *more)


def numbers(value: Any) -> Iterator[float]:
    """All numbers in a JSON value."""
    if isinstance(value, dict):
        for each in value.values():
            yield from numbers(each)
    elif isinstance(value, list):
        for each in value:
            yield from numbers(each)
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield float(value)


def _error(report: dict[str, Any]) -> float:
    """The error that is printed of the whole surface: all of it, or the solver's and the model's where that is all."""
    wholes = {name: (report.get(name) or {}).get("whole") for name in ("error", "algebraic", "model_error")}
    if wholes["error"] is not None:
        return float(wholes["error"])
    return math.hypot(wholes["algebraic"] or 0.0, wholes["model_error"] or 0.0)


def wrong_report(report: dict[str, Any], lit: bool = True) -> str:
    """What cannot be true in the report of a solve that says to be converged; lit: light has to enter."""
    if report.get("stopped") or not all(level.get("converged", True) for level in report.get("levels", [])):
        return ""
    parts = {key: value for key, value in report.items() if key not in ("passes", "budget")}
    if not all(map(math.isfinite, numbers(parts))):
        return "converged, and not all numbers are finite"
    energy = {name.removesuffix("_W"): values for name, values in (report.get("energy") or {}).items()}
    if report.get("path") or not energy:
        return ""
    entered = np.array(energy["entered"], float)
    if lit and not entered.max() > 0:
        return "converged, and no light enters"
    counted = entered > 1e-6 * max(entered.max(), 1e-30)
    missing = float(np.abs(np.array(energy["balance"], float)[counted]).max(initial=0))
    allowed = max(LEAST_BALANCE, _error(report))
    return f"converged, balance {missing:.2%}, printed error {allowed:.2%}" if missing > 1.05 * allowed else ""


def _report(place: Place) -> dict[str, Any]:
    return json.loads((place.folder / "report.json").read_text())


def relative_rms(found: np.ndarray, truth: np.ndarray, area: np.ndarray) -> float:
    """Relative RMS difference of two exitances (n, 3), weighted by area (n,)."""
    weight = area[:, None]
    return float(np.sqrt((weight * (found - truth) ** 2).sum() / max((weight * truth**2).sum(), 1e-300)))


def solved(lit: bool = True) -> Judge:
    """Judge a solve by its own report and field."""

    def judge(place: Place, outcome: Outcome) -> str:
        if wrong := wrong_report(_report(place), lit):
            return wrong
        path = place.folder / "field.npz"
        if not path.exists():
            return ""
        with np.load(path) as arrays:
            finite = all(np.isfinite(arrays[name]).all() for name in arrays.files)
        return "" if finite else "converged, and not all of the field is finite"

    return judge


def solved_as(name: str, options: tuple[str, ...] = SOLVED, allowed: float = SAME) -> Judge:
    """Judge a solve as `solved`, and by the exitance of the undamaged body with the same options.

    allowed: relative RMS error; what is printed as error is allowed too.
    """
    alone = solved()

    def judge(place: Place, outcome: Outcome) -> str:
        if wrong := alone(place, outcome):
            return wrong
        if _report(place).get("stopped"):
            return ""
        truth = place.bodies.field(name, ("--device", "cpu", *options))
        with np.load(place.folder / "field.npz") as arrays:
            found = arrays["exitance"]
        if found.shape != truth["exitance"].shape:
            return f"{len(found)} faces instead of {len(truth['exitance'])}"
        error, printed = relative_rms(found, truth["exitance"], truth["area"]), _error(_report(place))
        limit = max(allowed, printed)
        return f"exitance {error:.1%} off the undamaged body's, printed {printed:.1%}" if error > limit else ""

    return judge


def pixels(path: Path) -> np.ndarray:
    """A PNG as numbers from 0 to 1 (height, width, channels)."""
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB"), float) / 255


def pictured_as(name: str, file: str = "out.png", allowed: float = 0.1) -> Judge:
    """Judge a picture with the options PICTURED by the undamaged body's: relative RMS difference of its pixels."""

    def judge(place: Place, outcome: Outcome) -> str:
        truth, found = pixels(place.bodies.picture(name, PICTURED)), pixels(place.folder / file)
        error = float(np.sqrt(((found - truth) ** 2).sum() / (truth**2).sum()))
        return f"picture {error:.0%} off the undamaged body's" if error > allowed else ""

    return judge


def rendered(file: str = "out.png", size: tuple[int, int] | None = (32, 32), lit: bool = False) -> Judge:
    """Judge a picture by its size, and by the engine's report where one is on standard output."""

    def judge(place: Place, outcome: Outcome) -> str:
        path = place.folder / file
        if not path.exists():
            return f"{file} is not there"
        if path.suffix == ".png":
            with Image.open(path) as image:
                image.load()
                if size and image.size != size:
                    return f"picture of {image.size} pixels"
        text = outcome.stdout.strip()
        return wrong_report(json.loads(text).get("solve", {}), lit) if text.startswith("{") else ""

    return judge
