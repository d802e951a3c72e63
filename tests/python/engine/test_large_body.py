"""A body of two million tets: solved, drawn and told about within stated memory, and given up at once on a signal."""

from __future__ import annotations

import json
import signal
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

from attack import runner
from attack.bodies import Bodies
from attack.case import GIGABYTE, Case, Place
from attack.physics import wrong_report
from quadgraph.baking.pipeline import BakeOptions, bake
from shapes import icosphere, write_obj

TETS = 2_000_000
COMMANDS = {
    "info": ("quadgraph", "info", "body.qgraph", "--json"),
    "solve": ("quadgraph", "solve", "body.qgraph", "--device", "cpu", "--material", "skin1", "--json", "out.json"),
    "render": ("quadgraph", "render", "body.qgraph", "--device", "cpu", "--material", "skin1", "-o", "out.png"),
}
SECONDS = 900  # of processor time


@pytest.fixture(scope="module")
def body(tmp_path_factory):
    """A bumpy ball, baked once."""
    folder = tmp_path_factory.mktemp("large")
    ball = icosphere(6, 40)
    way = ball.vertices / np.linalg.norm(ball.vertices, axis=1, keepdims=True)
    bumps = 1 + 0.15 * np.sin(5 * way[:, :1]) * np.sin(4 * way[:, 1:2] + 1) * np.cos(3 * way[:, 2:])
    mesh = write_obj(replace(ball, vertices=ball.vertices * bumps), folder / "ball.obj")
    options = BakeOptions(unit="mm", interior=1.3, time_limit_s=3600)
    report = bake(mesh, folder / "body.qgraph", options)
    print(f"{report.levels[0]['tets']:,} tets, {report.seconds['total']:.0f} s, memory {report.peak_memory}")
    assert report.levels[0]["tets"] > 0.9 * TETS
    return folder / "body.qgraph"


def run(body, folder, case: Case):
    """Run a case beside a link to the body."""
    linked = replace(case, prepare=lambda place: (place.folder / "body.qgraph").hardlink_to(body))
    kind, message, outcome = runner.run_case(linked, folder, Bodies(folder))
    print(f"{case.name}: {kind}, {outcome.seconds:.0f} s, {outcome.peak / 1e6:.0f} MB, after a signal {outcome.after}")
    return kind, message


def balanced(place: Place, outcome) -> str:
    """What is wrong with a report, if one was written."""
    path = place.folder / "out.json"
    return wrong_report(json.loads(path.read_text())) if path.is_file() else ""


@pytest.mark.long
@pytest.mark.parametrize("name", COMMANDS)
def test_a_large_body_is_answered_within_memory(body, tmp_path, name):
    case = Case(name, COMMANDS[name], (), outputs=("out.*",), judge=balanced, expect="fine", seconds=SECONDS)
    assert run(body, tmp_path / name, replace(case, memory=2 * GIGABYTE)) == ("fine", "")


@pytest.mark.long
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP], ids=lambda number: number.name)
@pytest.mark.parametrize("delay", [0.5, 7.0, 15.0])
def test_a_large_solve_ends_at_once_on_a_signal(body, tmp_path, number, delay):
    case = Case("solve", COMMANDS["solve"], (), outputs=("out.*",), partial=True, seconds=SECONDS)
    case = replace(case, signals=((delay, int(number)),))
    assert run(body, tmp_path / "solve", case)[0] in ("fine", "refused")
