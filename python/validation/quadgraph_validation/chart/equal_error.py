"""How long methods take for the same error: pictures that converge beside path tracing, and random walks by kinds.

Of what is random the time for an error lies between measured ones, or beyond them: noise falls with the root of time.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import log
from typing import Any

from rich.table import Table

from quadgraph_validation.chart import chart_record as records

WANTED = 0.01
_CONVERGING, _TRACED, _CORRECTED = "converging picture", "path tracing", ", corrected"
_PLAIN, _GUIDED = "random walks, plain", "random walks, guided"
_Point = dict[str, Any]


@dataclass(frozen=True)
class EqualError:
    """Two methods on a scene by what judges both: seconds to the same relative RMS error over the whole.

    The error is WANTED or, where the first method does not come so close, the least that it has. processor: whether
    seconds are the processor's, over all threads, which other programs do not lengthen; else by the clock on the wall.
    """

    scene: str
    judge: str
    error: float
    processor: bool
    method: str
    seconds: float
    other: str
    other_seconds: float

    @property
    def times(self) -> float:
        """As long as the first the other takes."""
        return self.other_seconds / self.seconds


@dataclass(frozen=True)
class _Timed:
    """A point by its seconds and error; kind: what it is but for time, as variants of Mitsuba are."""

    name: str
    kind: str
    seconds: float
    error: float


def of(scene: dict[str, Any]) -> list[EqualError]:
    """All that a scene of a record has the points for."""
    done = [point for point in scene["points"] if not point.get("failed")]

    def chosen(truth: str, wanted: Callable[[_Point], bool]) -> list[_Point]:
        return [point for point in done if records.errors_of(point, truth).get("whole") and wanted(point)]

    traced = chosen("transport", lambda point: point["family"] == _TRACED)
    converging = chosen("transport", lambda point: point["family"] == _CONVERGING)
    corrected = chosen("walks", lambda p: p["family"].endswith(_CORRECTED) and not p["settings"]["motion"])
    plain = chosen("walks", lambda point: point["family"] == _PLAIN)
    guided = chosen("walks", lambda point: point["family"] == _GUIDED)
    pairs = (("transport", converging, traced), ("walks", corrected, plain), ("walks", guided, plain))
    return [_beside(scene["name"], *pair) for pair in pairs if pair[1] and pair[2]]


def table(record: dict[str, Any]) -> Table | None:
    """All scenes; None where there is nothing to compare."""
    rows = [row for scene in record["scenes"] for row in of(scene)]
    if not rows:
        return None
    names = ("method", "s", "beside", "s", "times as long", "seconds")
    found = Table("scene", "judged by", "error", *names, title="at equal error")
    for row in rows:
        compared = (row.method, f"{row.seconds:.3g}", row.other, f"{row.other_seconds:.3g}", f"{row.times:.2g}")
        clock = "of the processor" if row.processor else "by the clock"
        found.add_row(row.scene, records.TRUTHS[row.judge].split(":")[0], f"{100 * row.error:.3g}%", *compared, clock)
    return found


def _beside(scene: str, truth: str, ours: Sequence[_Point], other: Sequence[_Point]) -> EqualError:
    """The quickest of ours that comes close enough, beside the quickest of the others, both to one error."""
    processor = truth == "transport" and all(point.get("processor_s") for point in (*ours, *other))
    first, second = (_timed(points, truth, processor) for points in (ours, other))
    if ours[0]["family"] == _GUIDED:
        error = WANTED
        name, seconds = _quickest(first, error)
    else:
        close = [one for one in first if one.error <= WANTED]
        best = min(close, key=lambda one: one.seconds) if close else min(first, key=lambda one: one.error)
        error, name, seconds = max(WANTED, best.error), best.name, best.seconds
    return EqualError(scene, truth, error, processor, name, seconds, *_quickest(second, error))


def _timed(points: Sequence[_Point], truth: str, processor: bool) -> list[_Timed]:
    """By time."""
    found = []
    for point in points:
        variant = point["settings"].get("variant")
        kind = point["family"] + (f", {variant}" if variant else "")
        ms = point["ms"] if truth == "transport" else records.without_picture(point)
        seconds = point["processor_s"] if processor else ms / 1e3
        found.append(_Timed(point["name"], kind, seconds, records.errors_of(point, truth)["whole"]))
    return sorted(found, key=lambda one: one.seconds)


def _quickest(points: Sequence[_Timed], error: float) -> tuple[str, float]:
    """The kind that takes least for an error, and its seconds."""
    by_kind: dict[str, list[_Timed]] = {}
    for one in points:
        by_kind.setdefault(one.kind, []).append(one)
    seconds, name = min((_seconds_to(kind, error), name) for name, kind in by_kind.items())
    return name, seconds


def _seconds_to(points: Sequence[_Timed], error: float) -> float:
    """Between two measured points along the line in logarithms, beyond them as the root of time."""
    for before, after in pairwise(points):
        if before.error >= error >= after.error and before.error > after.error:
            share = log(before.error / error) / log(before.error / after.error)
            return before.seconds ** (1 - share) * after.seconds**share
    nearest = points[-1] if points[-1].error > error else points[0]
    return nearest.seconds * (nearest.error / error) ** 2
