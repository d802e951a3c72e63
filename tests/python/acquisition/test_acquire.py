"""`quadgraph acquire` recovers coefficients from pictures on another mesh, and names what is wrong with captures."""

from __future__ import annotations

import contextlib
import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import twin_capture
from quadgraph.acquisition.capture import capture
from quadgraph.acquisition.model.prediction import Predictor
from quadgraph.cli import main
from quadgraph.file import npz

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

SEED = 20


@pytest.fixture(scope="module")
def twin(tmp_path_factory) -> Path:
    """The folder of a capture."""
    return twin_capture.twin(tmp_path_factory.mktemp("twin"), SEED)


@pytest.fixture(scope="module")
def known(twin) -> dict[str, Any]:
    """The report of the capture as it is, whose gains are known; what was printed is in said.txt."""
    with (twin / "said.txt").open("w") as said, contextlib.redirect_stdout(said):
        status, report = acquire(twin, "--report", str(twin / "wax.html"))
    assert status == 0
    return report


def acquire(folder: Path, *more: str) -> tuple[int, dict[str, Any]]:
    """Exit code and report."""
    paths = [str(folder / name) for name in ("capture.json", "wax.npz", "wax.json")]
    status = main(["acquire", paths[0], "-o", paths[1], "--json", paths[2], "--device", "cpu", *more])
    return status, json.loads(Path(paths[2]).read_text()) if Path(paths[2]).exists() else {}


def off(report: dict[str, Any], name: str) -> tuple[np.ndarray, np.ndarray]:
    """By how much a coefficient is off, (3,), relative and in standard deviations."""
    found, true = np.array(report["coefficients"][name]), np.array(twin_capture.TRUTH[name])
    return found / true - 1, np.log(found / true) / report["deviations_of_logarithms"][name]


@pytest.mark.long
def test_predictions_of_what_absorbs_much_change_smoothly(twin):
    """In all pixels that count: one that jumps makes the derivatives of a fit large, and its deviations small."""
    stated = capture.read(twin / "capture.json")
    predictor = Predictor(stated, twin / "potato.qgraph", "cpu")
    steps = [
        predictor.predict(np.array([[0.14], [0.4]]) * np.exp([[0.0], [0.02 * number]]) * np.ones(3), False)
        for number in range(3)
    ]
    for pictures in zip(*steps, strict=True):
        first, middle, last = (picture.radiance for picture in pictures)
        counts = first > 1e-4 * first.max(axis=(0, 1))
        bend = np.log(last[counts]) - 2 * np.log(middle[counts]) + np.log(first[counts])
        assert np.abs(bend).max() < 0.05


@pytest.mark.long
def test_another_recovery_is_the_same_to_the_last_digit(twin, known):
    assert acquire(twin) == (0, known)


def test_coefficients_are_recovered_within_what_is_said_of_them(twin, known):
    assert known["converged"]
    assert not known["findings"]
    for name, most in (("sigma_a", 0.10), ("sigma_s_prime", 0.05)):
        relative, deviations = off(known, name)
        assert (np.abs(relative) < most).all()
        assert (np.abs(deviations) < 3).all()
    said = (twin / "said.txt").read_text()
    assert "sigma_a, 1/mm: red" in said
    assert "±" in said
    material = npz.read(twin / "wax.npz", ("sigma_a", "sigma_s_prime", "eta"))
    for name in twin_capture.TRUTH:
        np.testing.assert_allclose(material[name].ravel(), known["coefficients"][name], rtol=1e-6)
    assert float(material["eta"]) == twin_capture.ETA


@pytest.mark.long
def test_unknown_gains_leave_coefficients_within_what_is_said_of_them(twin, tmp_path):
    for name in ("potato.qgraph", "finer.qgraph"):
        shutil.copy(twin / name, tmp_path)
    twin_capture.write(tmp_path, twin_capture.TRUTH, SEED + 1, gains=True)
    status, report = acquire(tmp_path)
    assert status == 0
    for name in twin_capture.TRUTH:
        assert (np.abs(off(report, name)[1]) < 3).all()
    gains = np.array([each["gain"] for each in report["photographs"]])
    assert gains.std() > 0.02


def test_the_page_shows_everything_and_needs_nothing_else(twin, known, browser):
    text = (twin / "wax.html").read_text()
    assert "://" not in text
    for name in twin_capture.TRUTH:
        for value in known["coefficients"][name]:
            assert f"{value:.4g} ±" in text
    browser.get((twin / "wax.html").as_uri())
    sizes = "return Array.from(document.images).map(each => [each.naturalWidth, each.naturalHeight])"
    assert browser.execute_script(sizes) == [[40, 40]] * 3 * len(known["photographs"])
    assert not browser.get_log("browser")
