"""Studies that spread their cases over workers: the same records as one case after the other."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from quadgraph import cli
from quadgraph.work import finished_tasks
from quadgraph.work.schedulers import Scheduler
from quadgraph_validation.accuracy import row_tasks, unseen_study
from quadgraph_validation.accuracy.kept_rows import KeptRows
from quadgraph_validation.accuracy.unseen_study import UnseenRun
from quadgraph_validation.bodies import scene_meshes, scenes
from quadgraph_validation.chart import scene_measure
from quadgraph_validation.truth import pde_truth, truth_run, truth_tasks

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
TWO = Scheduler("processes", 2)


@pytest.fixture
def here(monkeypatch):
    """Tasks run in this process; what is asked of whom is noted."""
    asked = []

    def run_tasks(tasks, scheduler, ledger):
        asked.append((ledger, [task.name for task in tasks]))
        values = []
        for task in tasks:
            module, _, name = task.function.partition(":")
            values.append(getattr(MODULES[module], name)(**json.loads(json.dumps(task.arguments))))
        return json.loads(json.dumps(values))

    for module in MODULES.values():
        monkeypatch.setattr(module, "run_tasks", run_tasks)
    return asked


MODULES = {module.__name__: module for module in (row_tasks, scene_measure, truth_tasks)}


def test_unseen_cases_are_tasks_by_their_seeds(here, tmp_path, monkeypatch):
    monkeypatch.setattr(unseen_study, "check", lambda wanted: None)
    monkeypatch.setattr(unseen_study, "summary", len)
    monkeypatch.setattr(
        unseen_study, "judged", lambda seed, wanted, tell: {"seed": seed, "of": [wanted.walks, str(wanted.truths)]}
    )
    wanted = UnseenRun(61, 3, 500, tmp_path / "truths", (None, 2), "cpu")
    record = row_tasks.unseen(wanted, TWO)
    assert here == [(tmp_path / "truths" / finished_tasks.LEDGER, ["unseen 61", "unseen 62", "unseen 63"])]
    one_by_one = unseen_study.run(wanted)
    assert record == one_by_one
    assert [row["seed"] for row in record["rows"]] == [61, 62, 63]


def test_more_seeds_leave_the_tasks_of_the_first_as_they_were(here, tmp_path, monkeypatch):
    """What was judged for a few is found when more are asked for."""
    made = []
    monkeypatch.setattr(row_tasks, "run_tasks", lambda tasks, *rest: made.append(tasks) or [])
    for count in (1, 2):
        monkeypatch.setattr(unseen_study, "summary", len)
        row_tasks.unseen(UnseenRun(61, count, 500, tmp_path), TWO)
    assert made[0][0].content() == made[1][0].content()


def test_rows_are_made_by_their_names(here, monkeypatch):
    from quadgraph_validation.accuracy import veined_study

    monkeypatch.setattr(veined_study, "_row", lambda seed, wanted: {"twice": 2 * seed})
    wanted = veined_study.VeinedRun(3, 2, 10)
    written = []
    spread = row_tasks.named("veined", wanted, TWO)
    kept = KeptRows((), [{"name": "veins 3", "twice": 7}], written.append, spread=spread)
    record = veined_study.run(wanted, kept)
    assert [names for _, names in here] == [["veined veins 4"]]
    assert [row["twice"] for row in record["rows"]] == [7, 8]
    assert written == [record["rows"]]


def test_panels_are_those_that_are_solved_one_after_the_other(tmp_path):
    common = ["stability", "--axis", "albedo", "--method", "fem", "--thin", "2"]
    common += ["--device", "cpu", "--truth", str(tmp_path / "truths")]
    records = []
    for name, how in (("turn", []), ("spread", ["--scheduler", "processes:2"])):
        cli.main([*common, "--json", str(tmp_path / name), *how])
        records.append(json.loads((tmp_path / name).read_text()))
    assert records[0]["maps"] == records[1]["maps"]
    assert records[0]["maps"]
    assert len(list((tmp_path / "truths" / finished_tasks.LEDGER).iterdir())) == sum(
        len(each["panels"]) for each in records[1]["maps"]
    )


def _one_scene(names, wanted, tell):
    return [{"name": names[0], "run": wanted.pixels}]


def test_scenes_of_the_chart_are_tasks(here, tmp_path, monkeypatch):
    monkeypatch.setattr(scene_measure, "measured", _one_scene)
    wanted = scene_measure.ChartRun("meshes", str(tmp_path), ["pde"], [], "cpu", 64, 1, None)
    assert scene_measure.spread(["bunny", "spot"], wanted, TWO) == [
        {"name": "bunny", "run": 64},
        {"name": "spot", "run": 64},
    ]
    assert here == [(tmp_path / finished_tasks.LEDGER, ["chart bunny", "chart spot"])]


def test_truths_are_tasks_by_image_and_by_equations(here, tmp_path, monkeypatch):
    mesh = tmp_path / "mesh.obj"
    monkeypatch.setattr(scene_meshes, "file", lambda scene, meshes: mesh)
    made = []
    monkeypatch.setattr(
        truth_run, "render", lambda found, folder, samples, console, images: made.append((samples, images))
    )
    (scene,) = scenes.chosen(["spot"])
    subject = truth_run.TracedSubject(scene, mesh, None, (), "")
    monkeypatch.setattr(truth_run, "subject", lambda one, path: subject)
    truth_tasks.path_traced([subject], tmp_path, 32, TWO)
    assert made == [(32, [image]) for image in scene.images]
    stub = type("Truth", (), {"steps": [{"whole": 0.1}], "noise": {"whole": 0.01}})
    monkeypatch.setattr(pde_truth, "make", lambda *given: stub)
    found = truth_tasks.of_equations([(scene, "sp3", "buried")], Path("meshes"), tmp_path, TWO)
    assert found == [{"steps": [{"whole": 0.1}], "noise": {"whole": 0.01}}]
    assert here[1] == (tmp_path / finished_tasks.LEDGER, ["truth spot sp3 buried"])
