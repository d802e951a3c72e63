"""The figures of a benchmark under flat names like "frame/light/ms", in one line of JSON that `bench --compare` reads.

Less is better in all of them. A figure is {"value", "unit", "spread", "runs"}: the median over its runs, and their
standard deviation in the same unit, None for a time that was taken once. Counts repeat exactly: spread 0.
"""

from __future__ import annotations

import json
import re
import statistics
from collections.abc import Iterator, Sequence
from typing import Any

SCHEMA = "quadgraph-bench/1"
UNITS = ("ms", "applications", "cycles")  # applications: of the finest operator

Figure = dict[str, Any]
_Named = Iterator[tuple[str, Figure]]


def times(ms: Sequence[float]) -> Figure:
    """The figure of times in milliseconds, at least one."""
    spread = statistics.stdev(ms) if len(ms) > 1 else None
    return {"value": statistics.median(ms), "unit": "ms", "spread": spread, "runs": len(ms)}


def count(value: float, unit: str) -> Figure:
    """The figure of something counted."""
    return {"value": value, "unit": unit, "spread": 0.0, "runs": 1}


def line(record: dict[str, Any]) -> str:
    """The line that a run ends with, of a record as `bench --json` writes it."""
    keys = ("schema", "commit", "version", "device", "driver", "cores", "load", "figures")
    return json.dumps({key: record[key] for key in keys})


def of(record: dict[str, Any]) -> dict[str, Figure]:
    """All figures of the parts that the record has, rounded to five digits."""
    named = dict(_all(record))
    return {name: {key: _rounded(value) for key, value in figure.items()} for name, figure in named.items()}


def _all(record: dict[str, Any]) -> _Named:
    for entry in record.get("passes", []):
        yield from _of_passes(entry)
    for kind in record.get("live", {}).get("kinds", []):
        yield from _of_frames(f"frame/{_slug(kind['changes'])}", kind["frames"])
    for scene in record.get("solvers", []):
        yield from _of_solvers(scene)
    for scene in record.get("rivals", []):
        yield from _of_rivals(scene)
    for body in record.get("scaling", {}).get("bodies", []):
        yield from _of_scaling(body)


def _of_passes(entry: dict[str, Any]) -> _Named:
    prefix = "/".join(["passes", *(entry[key] for key in ("method", "model", "source", "solver"))])
    yield f"{prefix}/work", count(entry["work"], "applications")
    yield from _of_frames(prefix, entry["frames"])
    yield from _of_frames(f"{prefix}/random-order", entry.get("random_order_frames", {}))


def _of_frames(prefix: str, frames: dict[str, Figure]) -> _Named:
    """Whole frames under the name "", and their passes."""
    for name, figure in frames.items():
        yield f"{prefix}/{_slug(name)}/ms" if name else f"{prefix}/ms", figure


def _of_solvers(scene: dict[str, Any]) -> _Named:
    for way in scene["ways"]:
        for target in way["targets"]:
            if target["reached"]:
                prefix = f"solvers/{_slug(scene['name'])}/{_slug(way['name'])}/{100 * target['unlit']:g}%"
                yield from _of_point(prefix, target["reached"])


def _of_rivals(scene: dict[str, Any]) -> _Named:
    for target in scene["targets"]:
        prefix = f"rivals/{_slug(scene['name'])}/{100 * target['unlit']:g}%"
        for name, point in target["ours"].items():
            yield from _of_point(f"{prefix}/ours/{_slug(name)}", point)
        for name, goals in target["rivals"].items():
            for goal, found in goals.items():
                yield f"{prefix}/{_slug(name)}/{goal}/ms", found["time"]


def _of_scaling(body: dict[str, Any]) -> _Named:
    for model, found in body["models"].items():
        if found["cycles"] is not None:
            prefix = f"scaling/{model}/{body['surface_vertices']}"
            yield f"{prefix}/cycles", count(found["cycles"], "cycles")
            yield from _of_point(prefix, found)


def _of_point(prefix: str, point: dict[str, Any]) -> _Named:
    yield f"{prefix}/work", count(point["work"], "applications")
    yield f"{prefix}/ms", point["time"]
    yield f"{prefix}/wall/ms", point["wall"]


def _slug(name: str) -> str:
    """Words for the part of a figure's name between two slashes."""
    return re.sub(r"[^a-z0-9.%+]+", "-", name.lower()).strip("-")


def _rounded(value: Any) -> Any:
    return float(f"{value:.5g}") if isinstance(value, float) else value
