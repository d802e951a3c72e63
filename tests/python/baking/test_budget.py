"""A bake for an error: what it measures, chooses and says, on bodies that nothing was fitted to."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from quadgraph import cli
from quadgraph.baking import pipeline
from quadgraph.baking.budget import displayed, plan, trials
from quadgraph.baking.budget import record as budget
from quadgraph.baking.budget.displayed import Reference
from quadgraph.baking.budget.trials import Setting, Trial
from quadgraph.baking.pipeline import BakeOptions
from quadgraph.baking.report import BakeReport
from quadgraph.base.errors import FormatError, InputError
from quadgraph.file import qgraph_file
from quadgraph_validation.accuracy import budget_study as study
from quadgraph_validation.bodies import level_chains

core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

SUN = "directional:0.3,-0.2,-0.9:1"
MATERIAL = "marble"  # of short paths, so that sweeps of the truth are cheap
ERROR = 0.08


def law(vertices: int, model: str = "sp3", cycles: int = 2, *, order: float = 0.8, floor: float = 0.0) -> Trial:
    """A trial whose error falls with the number of vertices down to a floor, and whose cost rises with it."""
    error = float(np.hypot(2 * vertices**-order, floor))
    cost = 100.0 * vertices * (1 + cycles)
    return Trial(vertices, 3, True, model, cycles, 0, cost, {"sun": {"whole": error / 2, "unlit": error}})


def test_a_forecast_follows_the_order_between_and_beyond_trials():
    known = [law(n) for n in (200, 800, 3200)]
    for wanted in (0.02, 0.006, 0.05):
        found = trials.forecast(known, wanted)
        assert found.surface_vertices == pytest.approx((wanted / 2) ** (-1 / 0.8), rel=1e-6)
        assert found.cost == pytest.approx(300 * found.surface_vertices, rel=1e-6)


def test_a_forecast_takes_the_cheapest_setting_and_none_that_never_gets_there():
    known = [law(n, model, cycles, floor=floor) for n in (200, 800, 3200) for model, cycles, floor in
             (("diffusion", 1, 0.03), ("sp3", 2, 0.0), ("sp3", 3, 0.0))]  # fmt: skip
    assert trials.forecast(known, 0.02).setting.model == "sp3"
    assert trials.forecast(known, 0.02).setting.cycles == 2
    assert trials.forecast(known, 0.06).setting.model == "diffusion"
    assert trials.forecast(known, 1e-3) is None


class Measured(plan.Bench):
    """A bench whose surfaces obey `law`, with the number of vertices in place of levels."""

    def __init__(self, *vertices: int) -> None:
        self.trials, self.candidates = [], {}
        for count in vertices:
            self.add(count)

    def add(self, levels: int) -> list[Trial]:
        """Measure a surface of so many vertices."""
        self.trials.append(law(levels))
        self.candidates[levels, 3] = levels
        return self.trials[-1:]


@pytest.mark.parametrize(("at", "tried"), [(0.9, [800]), (0.7, [800, 640]), (0.1, [800, 640, 512])])
def test_smaller_surfaces_are_measured_for_as_long_as_they_keep_the_error(monkeypatch, at, tried):
    monkeypatch.setattr(plan, "_levels", lambda whole, options, report: options.surface_vertices)
    bench = Measured(1000)
    wanted = law(round(1000 * at)).error / core.MEASURED_SHARE
    plan._descend(bench, None, BakeOptions(), wanted, BakeReport(""), lambda text: None)
    assert [count for count, _ in bench.candidates] == [1000, *tried]
    assert bench.kept(wanted).surface_vertices == min(c for c, _ in bench.candidates if c >= 1000 * at)


class Finer(Measured):
    """A bench whose truth finds another share of the errors."""

    def __init__(self, share: float) -> None:
        self.share, self.judged = share, []

    def judge(self, path: int, setting: Setting) -> Trial:
        self.judged.append(path)
        found = law(path, setting.model, setting.cycles)
        errors = {"sun": {part: self.share * error for part, error in found.errors["sun"].items()}}
        return replace(found, errors=errors, deep=setting.deep)


@pytest.mark.parametrize(
    ("finer", "kept", "judged"),
    [(0.97, 990, [990]), (0.975, 1000, [990, 1000]), (0.99, 1020, [990, 1000, 1020]), (1, 1080, [990, 1000, 1020])],
)
def test_what_is_cheaper_and_in_doubt_is_held_against_a_finer_truth(finer, kept, judged):
    """The cheapest first, until one keeps the error; what is plainly above it is left alone."""
    bench, other = Measured(900, 990, 1000, 1020, 1080, 2000), Finer(finer)
    bench._written = lambda levels, name: levels
    wanted = law(1000).error
    assert bench.kept(wanted).surface_vertices == 1080
    doubtful = bench.doubtful(wanted)
    assert [t.surface_vertices for t in doubtful] == [990, 1000, 1020]
    bench.settle(doubtful, wanted, other)
    assert other.judged == judged
    found = bench.kept(wanted)
    assert found.surface_vertices == kept
    assert found.share == (core.MEASURED_SHARE if kept == 1080 else plan._SURE)
    assert found.error <= found.share * wanted


@pytest.fixture(scope="module")
def mesh(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("budget") / "lobes.ply"
    level_chains.SHAPES["lobes"](3).export(path)
    return path


@pytest.fixture(scope="module")
def judged(mesh) -> dict:
    """A row of the study; its times, which nothing here asks for, are of two frames."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study, "ALTERNATIONS", 1)
        return study.judge(mesh, 8, study.BudgetCase("lobes", MATERIAL, "sun", ERROR), mesh.parent, "")


@pytest.fixture(scope="module")
def baked(mesh) -> Path:
    path = mesh.with_name("baked.qgraph")
    plan.bake_for(mesh, path, BakeOptions(height_mm=8), ERROR, MATERIAL, [SUN], "")
    return path


@pytest.fixture(scope="module")
def record(baked) -> dict:
    return qgraph_file.read(baked).metadata["budget"]


@pytest.mark.long
def test_the_true_error_is_kept(judged):
    """The study's truth is the mesh cut twice, of which the bake knows nothing unless that settled a doubt."""
    assert judged["reached"]
    assert judged["truth_vertices"] > 15 * judged["vertices"]
    true = max(judged["chosen"]["errors"].values())
    assert true <= ERROR
    assert true == pytest.approx(judged["measured"], rel=0.1)


@pytest.mark.long
def test_hardly_anything_is_cheaper(judged):
    assert judged["searched"] >= 8
    assert max(judged["cheapest"]["errors"].values()) <= ERROR
    assert judged["ratio"] <= 1.5
    table = study.tables({"rows": [judged]})[0]
    assert table.row_count == 1


def test_less_than_the_mesh_is_baked(record):
    found = record
    assert found["measured"] <= ERROR
    # Steps go down by a fifth: 0.64 of the mesh is off by half of what is allowed, and 0.51 of it may be the last.
    assert found["surface_vertices"] < 0.6 * found["mesh_vertices"]
    finer = [t for t in found["trials"] if t["surface_vertices"] > found["surface_vertices"]]
    assert finer
    # The next coarser surface tried does not do: nothing is left over.
    coarser = [t for t in found["trials"] if t["surface_vertices"] < 0.6 * found["surface_vertices"]]
    assert all(budget.worst(t) > ERROR for t in coarser if t["model"] == found["model"])


def test_the_file_tells_a_solve_what_keeps_the_error(baked, record):
    engine = core.Engine(baked)
    engine.set_material(MATERIAL)
    engine.set_lights([SUN])
    report = engine.solve(error=ERROR, correction=True)
    assert (report["model"], report["cycles"]) == (record["model"], record["cycles"])
    assert len(report["correction"]["sweeps"]) == record["sweeps"]
    assert report["levels"][-1]["iterations"] % record["cycles"] == 0  # as many again for every bounce
    assert "error 8%: kept, the bake measured" in report["budget"]
    assert not report["unmet"]


def test_words_of_a_record_that_no_bake_wrote_are_refused():
    with pytest.raises(FormatError, match="budget"):
        budget.sentences({"error": 0.02, "inter_reflection": True}, "x.qgraph")


def test_a_record_of_an_earlier_version_is_said_to_be_one():
    assert "bake again" in "".join(budget.sentences({"error": 0.02}, "x.qgraph"))


def test_what_was_left_out_is_said(record):
    text = "\n".join(budget.sentences(record, "x.qgraph"))
    for word in ("error 8%: kept", f"of {record['mesh_vertices']:,} vertices", "cycles", "model", "interior"):
        assert word in text


def test_info_says_what_was_left_out(baked, capsys):
    assert cli.main(["info", str(baked)]) == 0
    assert "error 8%: kept" in capsys.readouterr().out


def test_render_keeps_the_error_by_the_file(baked, tmp_path, capsys):
    out = tmp_path / "out.png"
    scene = ["--material", MATERIAL, "--light", SUN, "--error", "8%", "--size", "32x32"]
    assert cli.main(["render", str(baked), *scene, "-o", str(out)]) == 0
    assert "kept, the bake measured" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("given", "word"),
    [
        (["--error", "2%"], "--material"),
        (["--material", "skin1"], "--error"),
        (["--light", SUN], "--error"),
        (["--error", "2%", "--material", "skin1", "--surface-vertices", "500"], "surface_vertices"),
        (["--error", "2%", "--material", "skin1", "--levels", "2"], "levels"),
        (["--error", "2%", "--material", "chalk"], "chalk"),
        (["--error", "2%", "--material", "skin1", "--light", "ambient:0"], "nothing leaves"),
    ],
)
def test_a_wrong_use_is_refused_in_words(mesh, tmp_path, given, word, capsys):
    out = tmp_path / "out.qgraph"
    assert cli.main(["bake", str(mesh), "--height", "8mm", "-o", str(out), *given]) == 1
    assert word in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.long
def test_an_error_out_of_reach_is_said_to_be(tmp_path, capsys, monkeypatch):
    """All of so coarse a mesh is baked, with a warning, and with --strict the exit status tells."""
    monkeypatch.setattr(displayed, "_MOST_SEEDS", 1)  # the truth need not be known as well as that
    source, out, reports = tmp_path / "lobes.ply", tmp_path / "out.qgraph", []
    level_chains.SHAPES["lobes"](2).export(source)
    bake_for = plan.bake_for
    monkeypatch.setattr(plan, "bake_for", lambda *given, **more: reports.append(bake_for(*given, **more)) or reports[0])
    options = ["--height", "20mm", "--material", "marble", "--light", SUN, "--error", "0.2%"]
    assert cli.main(["bake", str(source), "-o", str(out), *options]) == 0
    assert "warning: error 0.2%: out of this mesh's reach" in capsys.readouterr().out
    record = qgraph_file.read(out).metadata["budget"]
    assert not record["reached"]
    assert record["measured"] > 0.002
    assert record["surface_vertices"] == record["mesh_vertices"]
    monkeypatch.setattr(plan, "bake_for", lambda *given, **more: reports[0])
    assert cli.main(["bake", str(source), "-o", str(out), *options, "--strict"]) == 3


def test_a_file_without_coarser_levels_is_measured_too(tmp_path):
    """Its steps of conjugate gradients bring in less than a cycle: enough of them are tried."""
    source, path = tmp_path / "lobes.ply", tmp_path / "one.qgraph"
    level_chains.SHAPES["lobes"](2).export(source)
    pipeline.bake(source, path, BakeOptions(height_mm=5, levels=1, visibility_rays=0))
    reference = Reference(path, 1, tmp_path)
    truth = reference.truth("ketchup", [SUN], 1)
    truths = {"given": replace(truth, exitance=truth.plain)}  # of SP3 alone, for no sweep is tried
    scene = trials.BudgetScene("ketchup", {"given": [SUN]}, True)
    found = trials.measure(path, scene, truths, reference.surface_vertices, "", ("sp3",))
    assert found[-1].error < 0.1
    assert found[-1].error > 0.97 * found[-2].error


def test_errors_that_are_none_are_refused(mesh, tmp_path):
    for error in (0.0, 1.0, float("nan")):
        with pytest.raises(InputError, match="error"):
            plan.bake_for(mesh, tmp_path / "x.qgraph", BakeOptions(height_mm=8), error, "skin1")


@pytest.mark.parametrize(("arguments", "word"), [(["--scene", "teapot"], "lobes"), (["--reference"], "is baked for")])
def test_a_wrong_use_of_the_study_is_refused_in_words(arguments, word, capsys):
    assert cli.main(["accuracy", "budget", *arguments]) == 1
    assert word in capsys.readouterr().err


@pytest.mark.long
def test_every_error_is_kept_at_little_more_than_the_least_cost(shared):
    rows = study.run("", shared / "meshes", [])["rows"]
    assert len(rows) == len(study.CASES)
    assert [row["subject"] for row in rows if not row["reached"]] == ["coarse torus"]
    for row in rows:
        kept = max(row["chosen"]["errors"].values()) <= row["error"]
        assert kept == row["reached"], row  # what is refused is out of reach
        assert row["ratio"] <= 1.5 if kept else row["cheapest"] is None, row
