"""Studies that the engine or its reference solves, over workers: case by case what one process finds."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest

from quadgraph import cli
from quadgraph.work.schedulers import Scheduler
from quadgraph_validation.accuracy import (
    case_tasks,
    coarse_study,
    half_space_study,
    orders_study,
    radiance_study,
    slab_study,
    sphere_study,
)
from quadgraph_validation.truth import schemes

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
TWO = Scheduler("processes", 2)
STUDIES = {
    "slab": slab_study,
    "sphere": sphere_study,
    "half-space": half_space_study,
    "orders": orders_study,
    "coarse": coarse_study,
    "radiance": radiance_study,
}
SMALL = {
    "slab": {"ETAS": (1.3,), "LIGHTS": ("collimated",)},
    "sphere": {"WALKS": 20_000, "REFINEMENTS": (0, 1)},
    "half-space": {"WALKS": 2000, "WAVELENGTHS": {half_space_study.CASES[1]: (float("inf"), 30.0)}},
    "radiance": {"WALKS": (1000,) * 3, "CASES": radiance_study.CASES[-1:]},
}
FEW = ((3,), (5,))  # layers of coarse
ALONE = (  # as the command runs where it has not to share
    "import sys; from quadgraph import cli; from quadgraph_validation.accuracy import coarse_study;"
    f"coarse_study.CASES = {FEW}; sys.exit(cli.main(sys.argv[1:]))"
)


@pytest.fixture
def here(monkeypatch):
    """Tasks run in this process; their names are noted."""
    asked = []

    def run_tasks(tasks, scheduler, ledger):
        asked.extend(task.name for task in tasks)
        values = [case_tasks.solved_rows(**json.loads(json.dumps(task.arguments))) for task in tasks]
        return json.loads(json.dumps(values))

    monkeypatch.setattr(case_tasks, "run_tasks", run_tasks)
    return asked


@pytest.mark.parametrize(("reference", "by"), [(True, "reference"), (False, "engine on cpu")])
@pytest.mark.parametrize("study", STUDIES)
def test_cases_are_tasks_by_whoever_solves_them(study, reference, by, here, monkeypatch):
    monkeypatch.setattr(schemes, "on_engine", lambda device: f"engine on {device}")
    monkeypatch.setattr(schemes, "on_reference", "reference")
    module = STUDIES[study]
    monkeypatch.setattr(module, "rows_of", lambda case, body_of: [{"case": list(case), "by": body_of, "third": 1 / 3}])
    spread = case_tasks.of_solved_cases(study, "cpu", reference, TWO)
    rows = spread["cases" if study == "orders" else "rows"]
    assert [row["case"] for row in rows] == [list(case) for case in module.CASES]
    assert {row["by"] for row in rows} == {by}
    assert json.dumps(spread) == json.dumps(module.run(by))
    assert len(here) == len(set(here)) == len(module.CASES)
    assert all(name.startswith(f"{study} ") for name in here)


@pytest.mark.parametrize("study", STUDIES)
def test_a_case_is_the_same_after_its_journey(study, here, monkeypatch):
    """Everything it is known by is in what a task is given, and its table takes what comes back."""
    module = STUDIES[study]
    for name, value in {"CASES": module.CASES[1:2], **SMALL.get(study, {})}.items():
        monkeypatch.setattr(module, name, value)
    spread = case_tasks.of_solved_cases(study, "cpu", False, TWO)
    assert json.dumps(spread) == json.dumps(module.run(schemes.on_engine("cpu")))
    assert sum(table.row_count for table in module.tables(spread))


def test_workers_find_what_one_process_finds_whatever_threads_linear_algebra_has(tmp_path, monkeypatch, capfd):
    monkeypatch.setattr(coarse_study, "CASES", FEW)
    common = ["accuracy", "coarse", "--reference", "--json"]
    alone = tmp_path / "alone.json"
    program = [sys.executable, "-c", ALONE, *common, str(alone)]
    subprocess.run(program, env={**os.environ, "OPENBLAS_NUM_THREADS": "2"}, check=True, capture_output=True)
    for count, finished in ((1, False), (2, False), (2, True)):
        monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / f"{count}"))
        file = tmp_path / "spread.json"
        assert cli.main([*common, str(file), "--scheduler", f"processes:{count}"]) == 0
        assert file.read_bytes() == alone.read_bytes()
        said = capfd.readouterr().err
        assert ("2 of 2 are finished already" in said) == finished
        assert ("coarse 3: done" in said) == (not finished)
