"""`quadgraph chart` as a user runs it: what it measures and records, and what it asks for."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import dataclass, replace

import pytest

from baked import write_levels
from chart_records import record
from quadgraph import cli
from quadgraph_validation.bodies.scenes import SCENES
from quadgraph_validation.chart import chart_record as records
from quadgraph_validation.chart import chart_truths
from quadgraph_validation.chart.chart_body import ChartBody
from quadgraph_validation.chart.chart_judge import ChartJudge
from quadgraph_validation.chart.engine_methods import EngineMethod
from shapes import icosphere

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

SPHERE = SCENES["sphere"]
METHODS = [
    EngineMethod(level=1),
    EngineMethod(level=1, cycles=1),
    EngineMethod(method="quadgraph-fdm", source="diffuse"),
]


class KnownTruth:
    """An exitance of zero, of which the error is the mean over the faces."""

    noise = {"whole": 1e-3, "unlit": 2e-3}  # noqa: RUF012

    def error(self, level, exitance):
        return {"whole": float(exitance.mean()), "unlit": 2 * float(exitance.mean())}


@pytest.fixture
def small(tmp_path, monkeypatch):
    """The scene `sphere` on a small chain, under a truth that nobody has to make."""
    path = write_levels(tmp_path / "sphere.qgraph", [icosphere(3, 10), icosphere(2, 10)])

    def subject(scene, where, against, wanted, working, device, pixels, tell):
        body = ChartBody(scene, path, working, device, pixels)
        pde = {(model, source): KnownTruth() for model in ("sp3", "diffusion") for source in ("buried", "diffuse")}
        return body, ChartJudge(body, pde, {}), [replace(method) for method in METHODS]

    monkeypatch.setattr(chart_truths, "subject", subject)


def test_the_record_tells_machine_frame_levels_stages_and_errors(small, tmp_path, capsys):
    path, drawn = tmp_path / "chart.json", tmp_path / "drawn"
    arguments = ["--scene", "sphere", "--repeats", "2", "--pixels", "64", "--json", str(path), "--output", str(drawn)]
    assert cli.main(["chart", *arguments]) == 0
    assert {file.name for file in drawn.iterdir()} == {"chart-sphere.png", "chart-sphere.svg", "chart.html"}
    found = records.read(path)
    (scene,) = found["scenes"]
    run = scene["run"]
    assert all(run[key] for key in ("device", "driver", "commit", "version", "cores"))
    turns = {"light_turns_degrees": 5.0, "light_turns_degrees_in_motion": 3.0}
    assert run["frame"] == {"pixels": 64, "even_light_dims": 0.05} | turns
    assert [level["faces"] for level in scene["levels"]] == [1280, 320]
    assert [point["name"] for point in scene["points"]] == [method.name for method in METHODS]
    for point in scene["points"]:
        assert point["ms_range"][0] <= point["ms"] <= point["ms_range"][1]
        assert sum(point["stages"].values()) == pytest.approx(sum(point["passes"].values()), abs=0.01)
        assert point["stages"]["solve"] > 0
        assert point["errors"]["pde"]["unlit"] == pytest.approx(2 * point["errors"]["pde"]["whole"])
    # What leaves the ball is what enters it, nearly: a quarter of the light's 1 W/mm^2 on average.
    assert scene["points"][0]["errors"]["pde"]["whole"] == pytest.approx(0.2, abs=0.05)
    assert "chart-sphere.png" in capsys.readouterr().out
    again = tmp_path / "again"
    assert cli.main(["chart", "--from", str(path), "--output", str(again)]) == 0
    for file in drawn.iterdir():
        assert file.read_bytes() == (again / file.name).read_bytes(), file.name


def test_all_methods_are_on_the_chart_of_a_fresh_process():
    """Whatever other tests import: `quadgraph chart` alone imports the modules whose methods it measures."""
    asked = (
        "from quadgraph_validation.chart import chart_method, chart_truths\n"
        "chain = chart_method.MethodChain((900,), None)\n"
        "print(*{method.settings['method'] for method in chart_truths.methods(chain)})"
    )
    found = subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True, check=True).stdout.split()
    assert {"fem", "quadgraph-fv", "quadgraph-fdm", "dipole", "shortest-path"} <= set(found)


def test_a_truth_that_is_not_there_is_asked_for_by_its_command(tmp_path, capsys):
    base = ["chart", "--scene", "sphere", "--truth", str(tmp_path)]
    assert cli.main([*base, "--against", "transport"]) == 1
    said = " ".join(capsys.readouterr().err.split())
    assert "sphere-A.npz: not there" in said
    assert "quadgraph reference sphere --kind transport" in said
    assert cli.main(["chart", "--scene", "teapot"]) == 1
    assert "allowed are bunny" in capsys.readouterr().err


def test_scenes_are_added_to_a_record_and_replaced_in_it(small, tmp_path, capsys):
    """One scene is one run, so a record may hold scenes of several."""
    path = tmp_path / "chart.json"
    path.write_text(json.dumps(record()))
    measured = ["chart", "--scene", "sphere", "--repeats", "1", "--pixels", "64", "--add"]
    assert cli.main([*measured, "--json", str(path)]) == 0
    bunny, sphere = records.read(path)["scenes"]
    assert bunny == record()["scenes"][0]
    assert sphere["run"]["frame"]["pixels"] == 64
    assert [point["name"] for point in sphere["points"]] == [method.name for method in METHODS]
    assert cli.main(measured) == 1
    assert "--add: needs --json" in capsys.readouterr().err


def test_engines_of_a_scene_are_gone_before_the_next_scene(small, monkeypatch):
    first, there = _core.devices_opened(), []

    @dataclass
    class Looking(EngineMethod):
        def prepare(self, body):
            there.append(_core.live_objects(first))
            super().prepare(body)

    monkeypatch.setattr(f"{__name__}.METHODS", [Looking(level=1, model="diffusion")])
    scenes = ["--scene", "sphere", "--scene", "bunny"]
    assert cli.main(["chart", *scenes, "--repeats", "1", "--pixels", "16"]) == 0
    assert there == [{}, {}]


@pytest.mark.long
def test_the_sphere_against_its_pde_truth(tmp_path):
    """Truth made for the occasion: linear elements come closer with every level, the published differences do not."""
    base = ["--truth", str(tmp_path)]
    assert cli.main(["reference", "sphere", "--kind", "pde", "--source", "buried", "--source", "diffuse", *base]) == 0
    path = tmp_path / "chart.json"
    options = ["--scene", "sphere", "--against", "pde", "--repeats", "1", "--json", str(path)]
    assert cli.main(["chart", *options, *base]) == 0
    errors = {
        (point["family"], point["settings"]["level"]): point["errors"]["pde"]["unlit"]
        for point in json.loads(path.read_text())["scenes"][0]["points"]
        if point["settings"]["cycles"] == 0 and point["errors"]["pde"]
    }
    for family in ("fem, SP₃", "fem, diffusion"):
        assert errors[family, 0] < 0.6 * errors[family, 1] < 0.6**2 * errors[family, 2]
    published = "quadgraph-fdm, as published"
    assert errors[published, 0] > 0.6 * errors[published, 1]
