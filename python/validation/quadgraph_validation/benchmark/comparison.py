"""Two runs of the benchmark held against each other: which figures changed by more than the noise of their runs."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.box import MARKDOWN
from rich.table import Table
from scipy.special import stdtrit

from quadgraph.base.errors import InputError
from quadgraph_validation.benchmark.figures import SCHEMA, UNITS, Figure

LEAST = 0.02  # share of the old value below which no change counts
CHANCE = 0.01  # that a table of figures that did not change names one all the same
_MEDIAN = 1.2533  # standard error of a median of normal samples over that of their mean, sqrt(pi / 2)
_MOST_BYTES = 64 << 20
_MOST_FIGURES = 10_000
_MOST_RUNS = 1_000_000
_SHOWN = 5  # names in a message
_LONGEST = 120  # characters of a name or a text
_ABOUT = ("commit", "driver", "cores", "load")


@dataclass(frozen=True)
class Change:
    """A figure before and after; `noise`: how far the medians may differ by the scatter of the runs, None: unknown."""

    name: str
    old: Figure
    new: Figure
    noise: float | None

    @property
    def verdict(self) -> str:
        """What is to be said of it: slower, faster, not judged (a time taken once), or nothing."""
        if self.noise is None:
            return "not judged"
        difference = self.new["value"] - self.old["value"]
        if abs(difference) <= max(LEAST * self.old["value"], self.noise):
            return ""
        return "slower" if difference > 0 else "faster"


@dataclass(frozen=True)
class Comparison:
    """What both runs have, in the old one's order, and the names of figures that only one of them has."""

    old: dict[str, Any]
    new: dict[str, Any]
    changes: list[Change]
    missing: list[str]
    added: list[str]

    def names(self, verdict: str) -> list[str]:
        """The figures with that verdict."""
        return [change.name for change in self.changes if change.verdict == verdict]


def read(path: Path) -> dict[str, Any]:
    """Read what `bench` printed, whose last line counts, or what its --json wrote.

    Raises InputError, naming file and field, if that is not a record of this schema.
    """
    try:
        with path.open("rb") as stream:
            data = stream.read(_MOST_BYTES + 1)
        if len(data) > _MOST_BYTES:
            raise InputError(f"{path}: more than {_MOST_BYTES >> 20} MiB, which no record has")
        record = _parsed(data.decode())
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: neither the file nor its last line is JSON ({error})") from error
    _check(path, record)
    return record


def _parsed(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return json.loads(text.rstrip().rpartition("\n")[2])


def _check(path: Path, record: Any) -> None:
    found = record.get("schema") if isinstance(record, dict) else None
    if found != SCHEMA:
        raise InputError(f"{path}: schema: {_text(found)} found, {SCHEMA} allowed")
    if not isinstance(record.get("device"), str):
        raise InputError(f"{path}: device: a text is wanted")
    figures = record.get("figures")
    if not isinstance(figures, dict) or not 1 <= len(figures) <= _MOST_FIGURES:
        raise InputError(f"{path}: figures: 1 to {_MOST_FIGURES} by their names are wanted")
    for name, figure in figures.items():
        wrong = _wrong(figure)
        if wrong:
            raise InputError(f"{path}: figures: {_text(name)}: {wrong}")


def _wrong(figure: Any) -> str:
    """What is wrong with a figure, "" if nothing."""
    if not isinstance(figure, dict):
        return "value, unit, spread and runs are wanted"
    if not _is_amount(figure.get("value")):
        return "value: a finite number of at least 0 is wanted"
    if figure.get("unit") not in UNITS:
        return f"unit: one of {', '.join(UNITS)} is wanted"
    if "spread" not in figure or not (figure["spread"] is None or _is_amount(figure["spread"])):
        return "spread: a finite number of at least 0, or null, is wanted"
    runs = figure.get("runs")
    if not isinstance(runs, int) or isinstance(runs, bool) or not 1 <= runs <= _MOST_RUNS:
        return f"runs: an integer from 1 to {_MOST_RUNS} is wanted"
    return ""


def _is_amount(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and 0 <= value <= 1e300


def compare(old: dict[str, Any], new: dict[str, Any]) -> Comparison:
    """Hold every figure that both have against its like.

    Raises InputError if they are of two devices, or have a figure in two units or none in common.
    """
    if old["device"] != new["device"]:
        devices = [_text(record["device"]) for record in (old, new)]
        raise InputError(f"devices: {devices[0]} before, {devices[1]} after: their times cannot be compared")
    before, after = old["figures"], new["figures"]
    common = [name for name in before if name in after]
    if not common:
        raise InputError(f"no figure in common: {_list(list(before))} before, {_list(list(after))} after")
    for name in common:
        units = before[name]["unit"], after[name]["unit"]
        if units[0] != units[1]:
            raise InputError(f"figures: {_text(name)}: unit {units[0]} before, {units[1]} after")
    chance = CHANCE / len(common)
    changes = [Change(name, before[name], after[name], noise(before[name], after[name], chance)) for name in common]
    missing, added = [name for name in before if name not in after], [name for name in after if name not in before]
    return Comparison(old, new, changes, missing, added)


def noise(old: Figure, new: Figure, chance: float) -> float | None:
    """What two medians of the same quantity differ by, in one direction, no oftener than `chance`; None: unknown.

    Student's t of the pooled spread, with the standard error that medians of normal samples have.
    """
    if old["spread"] is None or new["spread"] is None:
        return None
    free = [figure["runs"] - 1 for figure in (old, new)]
    if sum(free) == 0 or old["spread"] == new["spread"] == 0:
        return 0.0
    pooled = math.hypot(*(f["spread"] * math.sqrt(n / sum(free)) for f, n in zip((old, new), free, strict=True)))
    error = _MEDIAN * pooled * math.sqrt(1 / old["runs"] + 1 / new["runs"])
    return float(stdtrit(sum(free), 1 - chance)) * error


def table(found: Comparison) -> Table:
    """Every figure of both runs, with what was allowed."""
    shown = Table("", "old", "new", "unit", "change", "allowed", "", box=MARKDOWN)
    shown.columns[0].no_wrap = True
    for column in shown.columns[1:6]:
        column.justify = "right"
    for change in found.changes:
        old, new = change.old["value"], change.new["value"]
        allowed = "" if change.noise is None else f"{100 * max(LEAST, _share(change.noise, old)):.1f}%"
        difference = f"{100 * _share(new - old, old):+.1f}%"
        cells = (f"{old:.5g}", f"{new:.5g}", change.old["unit"], difference, allowed, change.verdict)
        shown.add_row(_text(change.name), *cells)
    return shown


def _share(part: float, whole: float) -> float:
    return part / whole if whole > 0 else math.copysign(math.inf, part) if part else 0.0


def summary(found: Comparison) -> list[str]:
    """Lines that say what the runs were made on, what got slower, what faster, and what cannot be told."""
    lines = []
    for key in _ABOUT:
        before, after = (_text(record.get(key, "unknown")) for record in (found.old, found.new))
        lines.append(f"{key}: {before}" + (f" before, {after} after" if before != after else ""))
    for verdict in ("slower", "faster"):
        lines += [f"{verdict}: {_text(name)}" for name in found.names(verdict)]
    unknown = found.names("not judged")
    if unknown:
        lines.append(f"not judged, taken once: {_list(unknown)}; --repeats 2 or more")
    if found.added:
        lines.append(f"only in the new run: {_list(found.added)}")
    counts = [f"{len(found.names(verdict))} {verdict}" for verdict in ("slower", "faster")]
    return [*lines, f"{len(found.changes)} figures: {', '.join(counts)}"]


def check_complete(found: Comparison) -> None:
    """Raise InputError if the new run lacks figures of the old one."""
    if found.missing:
        raise InputError(f"the new run lacks {len(found.missing)} figures of the old one: {_list(found.missing)}")


def _list(names: list[str]) -> str:
    more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
    return ", ".join(_text(name) for name in names[:_SHOWN]) + more


def _text(value: Any) -> str:
    """Something of a file, short enough for a message and without control characters."""
    text = str(value)[:_LONGEST]
    return text if text.isprintable() else ascii(text)
