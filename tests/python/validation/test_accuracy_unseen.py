"""`quadgraph accuracy unseen`: what it draws, what it keeps, and one case judged as a user judges it."""

from __future__ import annotations

import contextlib
import io
import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from quadgraph import cli
from quadgraph.baking.pipeline import bake
from quadgraph.base.errors import InputError
from quadgraph.mesh.patches import PATCHES, patches_of
from quadgraph.mesh.surface import Surface
from quadgraph_validation.accuracy import unseen_engine, unseen_motion, unseen_study, unseen_tables
from quadgraph_validation.bodies import unseen_bodies, unseen_cases
from quadgraph_validation.truth.kept_walks import KeptWalks
from shapes import icosphere

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
pytest.importorskip("numba", reason="the extra `walks` is not installed: run tools/setup")

from quadgraph_validation.truth import kept_walks, unseen_truth

SEED = 2  # an even body of 29 mean free paths, albedo .9995, under a rectangle


@pytest.fixture(scope="module")
def body():
    return unseen_bodies.surface_of(SEED)


def test_a_seed_is_one_body_with_nothing_to_repair(body):
    again = unseen_bodies.surface_of(SEED)
    assert np.array_equal(body.vertices, again.vertices)
    assert np.array_equal(body.triangles, again.triangles)
    assert body.is_closed_manifold
    assert body.components == 1
    assert body.volume > 0
    least, most = unseen_bodies.LENGTH
    assert least <= np.ptp(body.vertices, axis=0).max() <= most
    assert 0.8 * unseen_bodies.TRIANGLES[0] < len(body.triangles) < 1.2 * unseen_bodies.TRIANGLES[1]


def test_cases_cover_what_they_are_drawn_from(body):
    cases = [unseen_cases.drawn(seed, body) for seed in range(200)]
    assert {case.light.type for case in cases} == set(unseen_cases.BEAMS)
    assert {case.medium.kind for case in cases} == {"even", "veins", "checker"}
    assert 0.4 < np.mean([case.medium.even for case in cases]) < 0.6
    albedos = np.array([case.albedo for case in cases])
    assert albedos.min() < 0.2
    assert albedos.max() > 0.9995
    assert (albedos > 0.7).mean() > 0.6
    for case in cases:
        total = case.medium.sigma_s_prime + case.medium.sigma_a
        assert (case.medium.sigma_s_prime > 0).all()
        assert case.medium.sigma_a.min() >= 0
        length = np.ptp(body.vertices, axis=0).max()
        assert total.min() * length > 0.4 * 2
        assert total.max() * length < 2.5 * 40 * 1.001
        assert 1 <= case.medium.eta <= 1.5


def test_denser_bodies_are_the_same_ones_with_shorter_mean_free_paths(body):
    for seed in range(20):
        usual, dense = (unseen_cases.drawn(seed, body, "beams", sizes) for sizes in ((2, 40), (40, 800)))
        assert dense.size == pytest.approx(20 * usual.size)
        assert (dense.albedo, dense.medium.kind, dense.light) == (usual.albedo, usual.medium.kind, usual.light)
        np.testing.assert_allclose(dense.medium.sigma_a, 20 * usual.medium.sigma_a, rtol=1e-5)


def test_mean_free_paths_the_wrong_way_round_are_refused(capsys):
    assert cli.main(["accuracy", "unseen", "--mean-free-paths", "5", "2"]) == 1
    assert "--mean-free-paths: 5 2 found" in capsys.readouterr().err


def test_a_volume_covers_its_body(body):
    case = next(c for c in (unseen_cases.drawn(seed, body) for seed in range(99)) if not c.medium.even)
    first, counts = np.array(case.medium.first), np.array(case.medium.sigma_a.shape[::-1])
    assert (first <= body.vertices.min(axis=0) + 1e-4).all()
    assert (first + (counts - 1) * case.medium.spacing >= body.vertices.max(axis=0) - 1e-4).all()


def test_patches_are_of_about_the_same_area_and_keep_the_sides_of_walls_apart(body):
    patch = patches_of(body)
    area = np.linalg.norm(body.doubled_normals, axis=1) / 2
    areas = np.bincount(patch, area)
    assert 200 <= len(areas) <= PATCHES
    assert areas.std() < 0.3 * areas.mean()
    normal = body.doubled_normals / (2 * area[:, None])
    mean = np.stack([np.bincount(patch, area * column) for column in normal.T], axis=1) / areas[:, None]
    assert np.linalg.norm(mean, axis=1).min() > 0.3  # 0 where both sides of a wall are one patch


def test_walks_are_gone_on_with_and_others_are_not_taken_for_them(tmp_path, monkeypatch):
    monkeypatch.setattr(kept_walks, "BATCH", 2000)
    case = unseen_cases.drawn(SEED, icosphere(3, 20.0))
    heard: list[int] = []
    first = unseen_truth.make(case, 4000, tmp_path, heard.append)
    longer = unseen_truth.make(case, 8000, tmp_path, heard.append)
    whole = unseen_truth.make(case, 8000, tmp_path / "other", lambda walks: None)
    assert heard == [0, 2000, 4000, 4000, 6000, 8000]
    assert first.batches == 2
    assert np.array_equal(longer.scattered, whole.scattered)
    assert longer.balance == pytest.approx(0, abs=0.01)
    denser = replace(case, medium=replace(case.medium, sigma_a=case.medium.sigma_a * 2))
    assert unseen_truth.stored(denser, tmp_path).batches == 0


def test_parts_and_errors_are_those_of_known_patches():
    area, ones = np.full(30, 2.0), np.ones(30)
    exitance = np.where(np.arange(30) < 15, 1.0, 0.1)
    entered = np.where(np.arange(30) < 15, 1.0, 0.05) * area
    noise = 0.02 * exitance
    scattered = 4 * exitance * area
    squares = scattered**2 / 4 + 12 * (noise * area) ** 2
    truth = KeptWalks({}, np.arange(30), area, 4, 4 * entered, scattered, squares, 0 * ones, np.zeros(4))
    parts = unseen_study.parts_of(truth, exitance)
    counts = {name: int(part.sum()) for name, part in parts.items()}
    assert counts == {"whole": 30, "lit": 15, "unlit": 15, "dimmest": 10}
    assert np.allclose(truth.error, noise)
    answer = unseen_study.UnseenAnswer(1, exitance * 1.1, {}, "sp3", 0.0)
    found = unseen_study.errors(truth, parts, answer)
    expected = np.sqrt((0.1**2 - 0.02**2) / (1 - 0.02**2))
    assert found["true"] == pytest.approx(dict.fromkeys(parts, expected), rel=1e-6)
    assert found["ratio"] == pytest.approx(1.1)
    dark = np.where(np.arange(30) < 20, exitance, 0)  # with the noise that it had: nothing is known of a dark third
    unknown = replace(truth, scattered=4 * dark * area, squares=4 * (dark * area) ** 2 + 12 * (noise * area) ** 2)
    assert set(unseen_study.parts_of(unknown, dark)) == {"whole", "lit", "unlit"}


def baked(folder: Path):
    """A bake of a body: of the default options whenever it is asked for, and done once."""
    kept, reports = folder / "body.qgraph", []

    def once(mesh, path, options):
        if not reports:
            reports.append(bake(mesh, kept, options))
        shutil.copyfile(kept, path)
        return reports[0]

    return once


@contextlib.contextmanager
def made_once(body: Surface, folder: Path):
    """The body of SEED is this one, and baked once."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(unseen_bodies, "surface_of", {SEED: body}.__getitem__)
        patch.setattr(unseen_engine, "bake", baked(folder))
        yield patch


@pytest.fixture(scope="module")
def judged(tmp_path_factory):
    """A folder with the record and the pictures of one case, at rest and in motion, and what was printed: of a ball in
    place of the seed's body, of a tenth of its triangles.
    """
    folder = tmp_path_factory.mktemp("judged")
    asked = f"accuracy unseen --seed {SEED} --count 1 --walks 200000 --sweeps 0 --sweeps 1 --motion --truth {folder}"
    printed = io.StringIO()
    with made_once(icosphere(3, 20.0), folder) as patch, contextlib.redirect_stdout(printed):
        patch.setattr(unseen_motion, "FRAMES", 4)
        patch.setattr(unseen_motion, "STILL", 3)
        patch.setattr(unseen_motion, "_TIMED", 1)
        status = cli.main([*asked.split(), "--json", str(folder / "unseen.json"), "--images", str(folder)])
    assert status == 0
    return folder, printed.getvalue()


def test_a_case_is_judged_printed_recorded_and_drawn(judged):
    folder, printed = judged
    assert "mean free paths" in printed
    (row,) = json.loads((folder / "unseen.json").read_text())["rows"]
    assert row["apart"] < 1e-3 * row["length"]
    assert row["noise"]["whole"] < 0.03
    plain, swept = row["solves"]
    assert swept["true"]["whole"] < 0.06
    assert swept["ratio"] == pytest.approx(1, abs=0.02)
    assert swept["true"]["whole"] < plain["true"]["whole"]
    assert (folder / "unseen.png").stat().st_size > 10_000
    summary = unseen_tables.summary([row])
    assert [found["sweeps"] for found in summary] == [0, 1]


@pytest.mark.long
def test_a_sky_comes_from_where_it_is(body, tmp_path):
    path = tmp_path / "sky.json"
    asked = f"accuracy unseen --seed {SEED} --count 1 --lights sky --walks 400000 --sweeps 0 --sweeps 2"
    with made_once(body, tmp_path):
        assert cli.main([*asked.split(), "--truth", str(tmp_path), "--json", str(path)]) == 0
    (row,) = json.loads(path.read_text())["rows"]
    plain, swept = row["solves"]
    assert swept["ratio"] == pytest.approx(1, abs=0.01)
    assert swept["true"]["whole"] < 0.5 * plain["true"]["whole"]  # whose light comes from all sides alike
    assert swept["true"]["whole"] < 0.03


def test_the_last_frame_of_the_motion_is_the_case_itself(body):
    case = unseen_cases.drawn(SEED, body)
    medium, light = unseen_motion.at_frame(case, unseen_motion.FRAMES - 1)
    assert medium is case.medium
    assert light == case.light
    middle = (body.vertices.min(axis=0) + body.vertices.max(axis=0)) / 2
    before, earlier = (unseen_motion.at_frame(case, frame)[1] for frame in (28, 27))
    arm, swung = (np.array(each.centre)[[0, 2]] - middle[[0, 2]] for each in (light, before))
    assert np.linalg.norm(swung) == pytest.approx(np.linalg.norm(arm))
    assert arm @ swung == pytest.approx(arm @ arm * np.cos(np.radians(unseen_motion.TURN)))
    assert earlier == unseen_motion.turned(light, -2 * unseen_motion.TURN, middle)
    edited = unseen_motion.at_frame(case, 0)[0]
    assert np.allclose(edited.sigma_a, (1 + unseen_motion.EDIT) * case.medium.sigma_a)
    with pytest.raises(InputError, match="a sky does not turn"):
        unseen_motion.at_frame(unseen_cases.drawn(SEED, body, "sky"), 0)


def test_a_case_is_judged_in_motion(judged):
    folder, printed = judged
    assert "summary in motion" in printed
    record = json.loads((folder / "unseen.json").read_text())
    (row,) = record["rows"]
    found = row["motion"]
    assert found["true"]["whole"] < 0.06
    assert found["still"]["whole"] < max(1.2 * found["true"]["whole"], 0.03)
    assert 0 < found["flicker"]["whole"] < found["true"]["whole"] + row["noise"]["whole"]
    assert found["segments"] > 1e5
    assert record["motion"]["true"]["lit"]["worst"] == found["true"]["lit"]


def test_a_sky_is_refused_in_motion(tmp_path, capsys):
    assert cli.main(["accuracy", "unseen", "--motion", "--lights", "sky", "--truth", str(tmp_path)]) != 0
    assert "take --lights beams" in capsys.readouterr().err


def test_a_missing_library_is_named_with_what_installs_it(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "numba", None)
    with pytest.raises(InputError, match=r"validation\[walks\]"):
        unseen_study.run(unseen_study.UnseenRun(1, 1, 1, None))


def test_ctrl_c_leaves_the_cases_that_were_finished(monkeypatch, tmp_path):
    errors = {"true": {"whole": 0.02, "lit": 0.02}, "printed": {"whole": 0.01}, "sweeps": None}
    finished = {"noise": {"whole": 0.001, "lit": 0.001}, "solves": [errors]}
    asked: list[int] = []
    stop = 2

    def judged(seed, wanted, tell):
        asked.append(seed)
        if len(asked) > stop:
            raise KeyboardInterrupt
        return finished

    monkeypatch.setattr(unseen_study, "judged", judged)
    record = unseen_study.run(unseen_study.UnseenRun(100, 5, 1, tmp_path))
    assert asked == [100, 101, 102]
    assert record["rows"] == [finished, finished]
    assert record["summary"][0]["ratios"]["whole"] == {"cases": 2, "within": 0.0, "least": 0.5, "greatest": 0.5}
    assert record["summary"][0]["true"]["unlit"] is None
    stop = 0
    with pytest.raises(KeyboardInterrupt):
        unseen_study.run(unseen_study.UnseenRun(100, 5, 1, tmp_path))
