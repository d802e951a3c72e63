"""Figure 14: error against time with and without coarser levels, of the published relaxation and of ours."""

from __future__ import annotations

import os
from collections.abc import Iterator
from functools import partial
from typing import Any

from quadgraph.base.progress import ProgressCallback
from quadgraph_validation.benchmark.algebraic_error import judge
from quadgraph_validation.benchmark.bench_scene import LIGHT, Device
from quadgraph_validation.benchmark.solver_convergence import COARSE_TOLERANCES, PUBLISHED, SolverRunner, SolverWay
from quadgraph_validation.tables.table_bodies import BUNNY, DONUT, Baked, TableSubject
from quadgraph_validation.tables.table_row import TableRow, TableSetting
from quadgraph_validation.tables.table_ways import MATERIAL

_ROUNDS = 3  # for each of the setting's: solves are short
_FACES = 80_000  # surface nodes at scale 1

_FDM: dict[str, Any] = {"method": PUBLISHED.method, "source": PUBLISHED.source}
# Name to a way and whether it runs on a file of all levels, or of the finest alone.
WAYS = {
    "published, with levels": (PUBLISHED, True),
    "published, without": (SolverWay("jacobi", **_FDM), False),
    "ours, with levels": (SolverWay("fmg-pcg", model="sp3"), True),
    "ours, without": (SolverWay("dpcg", coarse_tolerances=COARSE_TOLERANCES[:1], model="sp3"), False),
}


def rows(setting: TableSetting) -> Iterator[TableRow]:
    """One per body."""
    for subject in (BUNNY, DONUT):
        yield TableRow(subject.name, subject.name, "", partial(_measure, subject, setting))


def _measure(subject: TableSubject, setting: TableSetting, tell: ProgressCallback) -> dict[str, Any]:
    faces = setting.nodes(_FACES)
    baked = {True: setting.store.body(subject, faces, tell), False: setting.store.body(subject, faces, tell, levels=1)}
    runners = {}
    for name, (way, levels) in WAYS.items():
        tell(f"{subject.name}: {name}")
        engine = Device(setting.device).open(baked[levels].path, MATERIAL, [LIGHT])
        runners[name] = SolverRunner(engine, way, judge(engine, **way.system))
        runners[name].explore()
    rounds = _ROUNDS * setting.repeats
    for number in range(rounds):
        tell(f"{subject.name}: times, round {number + 1} of {rounds}")
        for runner in runners.values():
            for point in runner.curve():
                runner.time(point)
    return _record(subject, baked[True], runners)


def _record(subject: TableSubject, baked: Baked, runners: dict[str, SolverRunner]) -> dict[str, Any]:
    curves = {
        name: [
            {"iterations": p.iterations, "work": round(p.work, 3), "whole": p.whole, "unlit": p.unlit}
            | {"ms": round(min(p.time_ms), 4)}
            for p in runner.curve()
        ]
        for name, runner in runners.items()
    }
    return {"body": subject.name, "load": round(os.getloadavg()[0], 2), "curves": curves} | baked.report
