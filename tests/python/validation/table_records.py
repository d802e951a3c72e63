"""Records of `quadgraph tables` that nobody measured, for tests of what is drawn from them."""

from __future__ import annotations

from quadgraph_validation.tables import grading, published, table_bodies
from quadgraph_validation.tables.table_convergence import WAYS
from quadgraph_validation.tables.table_record import FORMAT
from quadgraph_validation.tables.table_ways import NAMES

MACHINE = {"device": "a device (256 bits)", "driver": "1.0", "cores": 2, "load": 0.1, "commit": "0123456789ab"}


def _way(number: int, tets: int) -> dict:
    number = min(number, 2)
    error = {"whole": 0.02 / 10**number, "unlit": 0.08 / 10**number}
    stages = {"light": 1.0, "source": 2.0, "solve": tets / 1e3, "exitance": 1.0, "picture": 5.0}
    least = {"iterations": (200, 3, 3)[number], "work": (240.0, 12.0, 14.0)[number], "whole": 0.004, "unlit": 0.009}
    return {
        "method": "a method",
        "iterations": (50, 50) if number == 0 else (3, 4),
        "work": 60.0,
        "ms": sum(stages.values()),
        "stages": stages,
        "frames_per_s": 1e3 / sum(stages.values()),
        "solve_bytes": 90 * tets,
        "error": error,
        "least": least | {"ms": (4.0, 0.3, 0.5)[number] * tets / 1e3},
    }


def _row(subject: table_bodies.Subject, tets: int) -> dict:
    nodes = [{"surface": tets // 4 // 4**level, "inner": tets // 4**level} for level in range(2)]
    told = {"body": subject.name, "paper": subject.paper, "other": subject.other, "grading": 0.4, "nodes": nodes}
    ways = {name: _way(number, tets) for number, name in enumerate(NAMES)}
    return told | {"bake_s": 9.5, "published_iterations": 50, "load": 0.4, "ways": ways}


def _graded(name: str) -> dict:
    found = []
    for k in grading.GRADINGS:
        errors = {"whole": 0.05 * k, "unlit": 0.2 * k}
        nodes = [{"surface": 2000, "inner": round(6000 / k)}]
        ways = {way: {"picture": errors, "mesh": {"whole": 0.02 * k}} for way in NAMES}
        found.append({"K": k, "grading": k, "nodes": nodes, "errors": ways})
    return {"body": name, "load": 0.4, "gradings": found}


def _curves(name: str) -> dict:
    curves = {}
    for number, way in enumerate(WAYS):
        points = [(n, 10.0 * n / (number + 1), 0.5 / n ** (number + 1)) for n in (1, 3, 10, 30, 100)]
        curves[way] = [{"iterations": n, "work": ms, "ms": ms, "whole": e / 3, "unlit": e} for n, ms, e in points]
    return {"body": name, "load": 0.4, "curves": curves, "nodes": [{"surface": 2000, "inner": 6000}]}


def record() -> dict:
    """All tables, with one body left out of Table 1."""
    rows = {
        "1": {subject.name: _row(subject, 10_000 * (i + 1)) for i, subject in enumerate(table_bodies.TABLE_1[:-1])},
        "12": {
            f"{b.name}-{n}": _row(b, n)
            for b in (table_bodies.BUNNY, table_bodies.DONUT)
            for n in (25_000, 50_000, 100_000)
        },
        "13": {name: _graded(name) for name in ("sphere", "skin")},
        "14": {name: _curves(name) for name in ("bunny", "donut")},
        "packing": {
            name: {
                "body": name,
                "load": 0.4,
                "nodes": [{"surface": 2000, "inner": 6000}],
                "ways": {way: {"ms": {"blocks": 10.0, "random": 13.0}, "gain": 0.3} for way in NAMES},
            }
            for name in ("bunny", "donut")
        },
    }
    tables = {name: {"machine": MACHINE, "complete": True, "rows": of, "left_out": {}} for name, of in rows.items()}
    tables["1"]["left_out"]["lucy"] = "lucy.ply: no such file"
    assert published.TABLE_1[-1].name == "Lucy"
    return {"format": FORMAT, "settings": {"scale": 0.1, "repeats": 2, "pixels": 256}, "tables": tables}
