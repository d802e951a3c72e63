"""Studies by rows, bodies and numbers, and cross-checks, over workers: what one process makes, and nothing twice."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from quadgraph import cli
from quadgraph.base.errors import InputError
from quadgraph.work.schedulers import Scheduler
from quadgraph_validation.accuracy import (
    budget_study,
    case_tasks,
    certificate_study,
    converging_study,
    cutoff_study,
    dense_study,
    dense_tasks,
    estimate_study,
    forward_study,
    kept_rows,
    light_study,
    pictures_study,
    row_tasks,
    scenes_study,
    similarity_study,
    target_study,
)
from quadgraph_validation.bodies.scenes import SCENES, StudyScene
from quadgraph_validation.truth import check_tasks, cross_checks, walk_truth
from quadgraph_validation.truth.monte_carlo import Estimate

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
TWO, QUIET = Scheduler("processes", 2), Console(quiet=True)
MODULES = {module.__name__: module for module in (row_tasks, dense_tasks, case_tasks, check_tasks)}
BY_SEED = {
    "certificate": (certificate_study, certificate_study.CertificateRun(401, 2, 1.5, 1000, "cpu")),
    "light": (light_study, light_study.LightRun(401, 2, "cpu")),
    "pictures": (pictures_study, pictures_study.PicturesRun(401, 2, 10, "cpu")),
    "converging": (converging_study, converging_study.ConvergingRun(401, 2, 10, 0.01, 9.0, "cpu")),
}


@pytest.fixture
def here(monkeypatch):
    """Tasks run in this process; the names of those that are asked for together are noted."""
    asked = []

    def run_tasks(tasks, scheduler, ledger):
        asked.append([task.name for task in tasks])
        values = []
        for task in tasks:
            module, _, name = task.function.partition(":")
            task.content()  # everything that it reads is there
            values.append(getattr(MODULES[module], name)(**json.loads(json.dumps(task.arguments))))
            assert all(path.exists() for path in task.writes)
        return json.loads(json.dumps(values))

    for module in MODULES.values():
        monkeypatch.setattr(module, "run_tasks", run_tasks)
    return asked


@pytest.mark.parametrize("study", BY_SEED)
def test_rows_by_seed_are_tasks(study, here, monkeypatch):
    module, wanted = BY_SEED[study]
    pytest.importorskip("numba", reason="needs the extra walks")
    monkeypatch.setattr(module, "_row", lambda seed, *of: {"seed": seed, "third": seed / 3})
    monkeypatch.setattr(module, "summary", len, raising=False)
    spread = module.run(wanted, kept_rows.KeptRows(spread=row_tasks.named(study, wanted, TWO)))
    seeds = [402, 404] if study == "converging" else [401, 402]  # of those in even light alone
    assert here == [[f"{study} {seed}" for seed in seeds]]
    assert [row["seed"] for row in spread["rows"]] == seeds
    assert spread == module.run(wanted)


def test_a_row_by_seed_is_known_again_whatever_else_is_asked_for():
    first, more = (
        row_tasks.row_task("pictures", pictures_study.PicturesRun(seed, count, 10), "402").content()
        for seed, count in ((401, 2), (402, 9))
    )
    assert first == more
    assert first != row_tasks.row_task("pictures", pictures_study.PicturesRun(401, 2, 11), "402").content()


def test_balls_are_baked_once_for_all_materials(here, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    for name, value in (("DETAIL", 2), ("FINER", 3), ("CASES", dense_study.CASES[:2])):
        monkeypatch.setattr(dense_study, name, value)
    monkeypatch.setattr(dense_tasks, "CASES", dense_study.CASES)
    wanted = dense_study.DenseRun("cpu")
    spread = dense_study.run(wanted, kept_rows.KeptRows(spread=dense_tasks.named(wanted, TWO)))
    assert here == [
        ["dense ball of 40 mm", "dense ball of 40 mm, finer"],
        ["dense wholemilk", "dense marble"],
    ]
    baked = []
    bake = dense_study.bake_ball
    monkeypatch.setattr(dense_study, "bake_ball", lambda *given: baked.append(given[:2]) or bake(*given))
    assert spread == dense_study.run(wanted)
    assert len(baked) == len(set(baked)) == 2


@pytest.mark.long
def test_the_command_spreads_bodies_and_finds_what_is_finished(tmp_path, monkeypatch, capfd):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    records = []
    for how in ([], ["--scheduler", "processes:2"], ["--scheduler", "processes:1"]):
        file = tmp_path / f"{len(records)}.json"
        common = ["accuracy", "light", "--seed", "61", "--count", "1", "--device", "cpu", "--json", str(file)]
        assert cli.main([*common, *how]) == 0
        records.append(file.read_bytes())
        said = capfd.readouterr().err
        assert ("light 61: done (1 of 1)" in said) == (len(records) == 2)
        assert ("1 of 1 are finished already" in said) == (len(records) == 3)
    assert records[0] == records[1] == records[2]


def test_errors_are_the_same_whatever_threads_linear_algebra_has():
    """Those of a task have one."""
    program = (
        "import numpy as np; from quadgraph.base.relative_error import relative_rms; dice = np.random.default_rng(1);"
        "print([relative_rms(*(dice.random(size) for size in (40_000, (40_000, 3), (40_000, 3)))) for _ in range(20)])"
    )
    said = {
        subprocess.run(
            [sys.executable, "-c", program],
            env={**os.environ, "OPENBLAS_NUM_THREADS": str(threads)},
            check=True,
            capture_output=True,
        ).stdout
        for threads in (1, 2)
    }
    assert len(said) == 1


@pytest.mark.parametrize("study", [estimate_study, target_study, budget_study])
def test_bodies_are_tasks_by_their_names(study, here, tmp_path, monkeypatch):
    names = [subject.name for subject in study.SUBJECTS[:2]]
    for name, value in (
        ("judged", lambda subjects, *of: [{"subject": one.name, "third": n / 3} for one in subjects for n in (1, 2)]),
        ("original", lambda subject, *of: None),
        ("judge", lambda mesh, height, case, *of: {"subject": case.subject, "third": case.error / 3}),
        ("statistics", len),
    ):
        monkeypatch.setattr(study, name, value, raising=False)
    (tmp_path / study.SUBJECTS[0].mesh).touch()  # is read, and the other one is not there
    name = study.__name__.split(".")[-1].removesuffix("_study")
    spread = case_tasks.of_bodies(name, "cpu", tmp_path, names, TWO)
    assert here == [[f"{name} {one}" for one in names]]
    assert spread == study.run("cpu", tmp_path, names)
    assert {row["subject"] for row in spread["rows"]} == set(names)
    with pytest.raises(InputError, match="scene 'nobody': allowed are "):
        case_tasks.of_bodies(name, "cpu", tmp_path, ["nobody"], TWO)


@pytest.mark.parametrize("study", [forward_study, similarity_study, cutoff_study])
def test_cases_of_numbers_are_tasks(study, here, monkeypatch):

    def rows_of(case, *of, **options):
        return [dict(zip(("thickness", "albedo", "eta", "g"), (*case, g), strict=True)) for g in (0.1, 0.2)]

    monkeypatch.setattr(study, "rows_of", rows_of)
    monkeypatch.setattr(study, "_exact", lambda *of: {}, raising=False)
    name = study.__name__.split(".")[-1].removesuffix("_study")
    options = {"device": "cpu"} if study is forward_study else {}
    spread = case_tasks.of_cases(name, TWO, **options)
    assert spread == (study.run("cpu", Path(), ()) if options else study.run(None))
    assert [row["thickness"] for row in spread["rows"]] == [case[0] for case in study.CASES for _ in range(2)]
    assert len(here[0]) == len(set(here[0])) == len(study.CASES)


def test_the_command_spreads_slabs_and_says_the_same_of_what_is_exact(tmp_path, monkeypatch, capfd):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(cutoff_study, "CASES", ((3.0, 0.99, 1.4),))
    records = []
    for how in ([], ["--scheduler", "processes:1"]):
        assert cli.main(["accuracy", "cutoff", "--json", str(tmp_path / "record.json"), *how]) == 0
        records.append((tmp_path / "record.json").read_bytes())
    assert records[0] == records[1]
    assert "cutoff 3 0.99 1.4: done (1 of 1)" in capfd.readouterr().err


@dataclass(frozen=True)
class Subject:
    """A scene with its mesh; of its pictures only where they are."""

    scene: StudyScene
    mesh: Path

    def path(self, folder, image):
        return folder / f"{self.scene.name}-{image}.npz"


def test_scenes_are_tasks_that_draw_their_figures(here, tmp_path, monkeypatch):
    figures = pytest.importorskip("quadgraph_validation.accuracy.scene_figures", reason="no matplotlib")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    (tmp_path / "mesh.ply").touch()
    monkeypatch.setattr(
        scenes_study,
        "subjects",
        lambda meshes, names: [Subject(SCENES[name], tmp_path / "mesh.ply") for name in names],
    )
    monkeypatch.setattr(scenes_study, "stored", lambda found, truths: dict.fromkeys(found.scene.images))
    monkeypatch.setattr(scenes_study, "compare", lambda found, pictures, device: dict.fromkeys(pictures, found.scene))
    monkeypatch.setattr(scenes_study, "measured", lambda compared: {"height": compared.height})
    monkeypatch.setattr(figures, "write", lambda path, *of: path.write_text("drawn"))
    for name in ("spot", "skin"):
        for image in SCENES[name].images:
            (tmp_path / f"{name}-{image}.npz").touch()
    given = ("cpu", tmp_path, tmp_path, ["spot", "skin"])
    spread = case_tasks.of_scenes(*given, tmp_path, TWO)
    assert here == [["scenes spot", "scenes skin"]]
    assert sorted(path.name for path in tmp_path.glob("*.png")) == ["scenes-skin.png", "scenes-spot.png"]
    assert spread == scenes_study.run(*given)
    assert spread == case_tasks.of_scenes(*given, None, TWO)


WALKS = 11 * walk_truth.BATCH  # a task of ten batches, and one more
SAID = [f"walks sphere, to {count:,}" for count in (10 * walk_truth.BATCH, WALKS)]


@pytest.fixture
def pictures(request):
    """The folder of path-traced pictures."""
    return request.config.rootpath / "docs" / "benchmarks" / "truth"


def checked(pictures, folder, walks, *more):
    """Cross-checks by the command, in a folder with the pictures of the sphere."""
    for view in "AB":
        shutil.copy(pictures / f"sphere-{view}.npz", folder)
    base = ["reference", "--kind", "walk", "--walks", str(walks), "--truth", str(folder)]
    assert cli.main([*base, *more]) == 0
    return (folder / "sphere-walks.npz").read_bytes()


@pytest.mark.long
def test_walks_of_cross_checks_are_the_same_to_the_byte(pictures, tmp_path, monkeypatch, capfd):
    monkeypatch.setattr(cross_checks, "SLABS", (("ketchup", 2, 1.0),))
    monkeypatch.setattr(cross_checks, "why_no_pmmc", lambda: "pmmc is not there")
    found = []
    for name, how in (("alone", []), ("spread", ["--scheduler", "processes:2"])):
        (tmp_path / name).mkdir()
        kept = checked(pictures, tmp_path / name, WALKS, *how)
        said = capfd.readouterr()
        found.append((kept, said.out))
    assert found[0] == found[1]
    assert "ordinates" in said.out
    for name in (*SAID, "walks slab, ketchup B, eta 1"):
        assert f"{name}: done" in said.err


def test_walks_that_are_stored_are_gone_on_with(here, pictures, tmp_path):
    scene = SCENES["sphere"]
    walk_truth.extend(scene, tmp_path, [walk_truth.counts(scene, 0, 1), walk_truth.counts(scene, 1, 1)])
    for view in scene.views:
        shutil.copy(pictures / f"sphere-{view}.npz", tmp_path)
    rows = check_tasks.rows(["sphere"], 3 * walk_truth.BATCH, tmp_path, tmp_path, False, TWO)
    assert here == [["walks sphere, to 150,000"]]
    (tmp_path / "alone").mkdir()
    walk_truth.make(scene, 3 * walk_truth.BATCH, tmp_path / "alone", QUIET)
    alone, spread = (folder / "sphere-walks.npz" for folder in (tmp_path / "alone", tmp_path))
    assert alone.read_bytes() == spread.read_bytes()
    assert rows == cross_checks.sphere(1, tmp_path, tmp_path, QUIET)


def test_walks_that_others_have_walked_meanwhile_are_not_counted_twice(tmp_path):
    scene = SCENES["sphere"]
    part = walk_truth.counts(scene, 0, 1)
    walk_truth.extend(scene, tmp_path, [part])
    with pytest.raises(InputError, match="1 batches found, 0 expected: others have walked on meanwhile"):
        walk_truth.extend(scene, tmp_path, [part])
    assert walk_truth.stored(scene, tmp_path).batches == 1


def test_what_pmmc_says_is_a_task_of_its_own(here, pictures, tmp_path, monkeypatch):
    monkeypatch.setattr(cross_checks, "SLABS", (("ketchup", 2, 1.0),))
    zones = np.linspace(0.1, 0.2, walk_truth.ZONES)
    monkeypatch.setattr(cross_checks, "sphere_by_pmmc", lambda walks: Estimate(zones, zones / walks))
    monkeypatch.setattr(cross_checks.pmmc_walk, "slab", lambda *of: Estimate(np.full(4, 0.25), np.full(4, 0.01)))
    for view in "AB":
        shutil.copy(pictures / f"sphere-{view}.npz", tmp_path)
    given = (cross_checks.BODIES, 1000, tmp_path, tmp_path, True)
    spread = check_tasks.rows(*given, TWO)
    assert here == [["walks sphere, to 50,000", "walks sphere, pmmc", "walks slab, ketchup B, eta 1"]]
    assert spread == cross_checks.rows(*given, QUIET)
    assert sum("pmmc" in row.others for row in spread) == 4
