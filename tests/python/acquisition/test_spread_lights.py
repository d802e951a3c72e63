"""Lights of one acquisition by workers: the same predictions, whoever makes them, and none made twice."""

from __future__ import annotations

import json
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import pytest

import twin_capture
from quadgraph import VolumeMaterial
from quadgraph.acquisition.capture import capture
from quadgraph.acquisition.model.prediction import Predictor
from quadgraph.cli import main
from quadgraph.commands.light_tasks import LightTasks
from quadgraph.work.schedulers import Scheduler, StayingWorkers

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

COEFFICIENTS = np.array([twin_capture.TRUTH["sigma_a"], twin_capture.TRUTH["sigma_s_prime"]])


@pytest.fixture(scope="module")
def twin(tmp_path_factory) -> Path:
    """The folder of a capture under two lights."""
    return twin_capture.twin(tmp_path_factory.mktemp("twin"), 3, vertices=300, finer=3)


class Spread:
    """Predictions by so many processes that keep what is finished in a folder."""

    def __init__(self, twin: Path, count: int, folder: Path) -> None:
        self.stated, self.body = capture.read(twin / "capture.json"), twin / "potato.qgraph"
        self.count, self.folder = count, folder
        self.said: list[str] = []

    def predict(self, coefficients: np.ndarray | Path) -> list[dict[str, np.ndarray]]:
        with ExitStack() as until:
            workers = StayingWorkers(Scheduler("processes", self.count), until)
            spread = LightTasks(workers, self.folder, "cpu", False, self.said.append)
            found = Predictor(self.stated, self.body, "cpu", spread=spread).predict(coefficients, True)
        return [vars(picture) for picture in found]

    def finished(self) -> dict[Path, int]:
        """When each file was written."""
        return {path: path.stat().st_mtime_ns for path in self.folder.iterdir()}


def test_predictions_do_not_depend_on_how_many_make_them(twin, tmp_path):
    one, two = Spread(twin, 1, tmp_path / "one"), Spread(twin, 2, tmp_path / "two")
    found, others = one.predict(COEFFICIENTS), two.predict(COEFFICIENTS)
    for picture, other in zip(found, others, strict=True):
        for name, values in picture.items():
            np.testing.assert_array_equal(values, other[name])
    here = Predictor(one.stated, one.body, "cpu").predict(COEFFICIENTS, True)
    for picture, other in zip(found, here, strict=True):
        lit = other.radiance > 0.05 * other.radiance.max()
        # Solved to 1e-4, by engines that begin from nothing or from the camera before.
        np.testing.assert_allclose(picture["radiance"][lit], other.radiance[lit], rtol=2e-3)
    before = one.finished()
    for picture, other in zip(one.predict(COEFFICIENTS), found, strict=True):
        np.testing.assert_array_equal(picture["radiance"], other["radiance"])
    assert one.finished() == before


def test_a_volume_is_known_by_its_content(twin, tmp_path):
    """The file that a fit makes is gone with the fit."""
    spread = Spread(twin, 2, tmp_path / "tasks")
    grid = [np.broadcast_to(each, (1, 1, 1, 3)).copy() for each in COEFFICIENTS[::-1]]
    for name in ("first.npz", "second.npz"):
        path = tmp_path / name
        VolumeMaterial(*grid, 1.0, (0.0, 0.0, 0.0), twin_capture.ETA).save(path)
        found = spread.predict(path)
        path.unlink()
        if name == "first.npz":
            before, first = spread.finished(), found
    assert spread.finished() == before
    assert all(np.array_equal(a["radiance"], b["radiance"]) for a, b in zip(first, found, strict=True))


def test_without_a_correction_there_is_nothing_to_spread(twin, tmp_path, capsys):
    asked = ["acquire", str(twin / "capture.json"), "-o", str(tmp_path / "plain.npz"), "--device", "cpu"]
    assert main([*asked, "--no-correction", "--scheduler", "processes:2"]) == 1
    assert "one whose predictions are corrected" in capsys.readouterr().err


@pytest.mark.long
def test_coefficients_are_recovered_by_workers(twin, tmp_path, capsys):
    asked = ["acquire", str(twin / "capture.json"), "--device", "cpu"]
    found = {}
    for name, more in (("here", []), ("spread", ["--scheduler", "processes:2"])):
        output, report = tmp_path / f"{name}.npz", tmp_path / f"{name}.json"
        main([*asked, "-o", str(output), "--json", str(report), *more])
        found[name] = json.loads(report.read_text())["coefficients"]
    assert "2 workers on this machine" in capsys.readouterr().err
    for name, values in found["here"].items():
        np.testing.assert_allclose(found["spread"][name], values, rtol=0.01)
