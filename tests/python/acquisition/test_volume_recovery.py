"""`quadgraph acquire --volume` finds where in a body coefficients differ, from pictures on another mesh."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import twin_capture
from quadgraph import VolumeMaterial
from quadgraph.acquisition.capture import capture, photographs
from quadgraph.acquisition.model import prediction
from quadgraph.acquisition.model.prediction import Predictor
from quadgraph.acquisition.model.problem import Problem
from quadgraph.acquisition.volume.volume_model import VolumeSetting
from quadgraph.acquisition.volume.volume_weights import AT_FIRST, Sizes
from quadgraph.cli import main
from quadgraph.file import npz

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

COEFFICIENTS = ("sigma_a", "sigma_s_prime")
STATED = [f"{name}_{what}" for name in COEFFICIENTS for what in ("deviation", "resolution")]
VOLUME = (*COEFFICIENTS, "spacing", "origin", "eta", *STATED)
SEED = 31
SCATTERING, ABSORPTION = 0.7, 0.02
SPOT, RADIUS = np.array([9.0, 3.0, 7.0]), 7.0  # mm: where it absorbs four times as much, near the front


def truth(points: np.ndarray) -> tuple[float, np.ndarray]:
    """sigma_s_prime and sigma_a."""
    return SCATTERING, np.where(np.linalg.norm(points - SPOT, axis=1) < RADIUS, 4 * ABSORPTION, ABSORPTION)


@pytest.fixture(scope="module")
def twin(tmp_path_factory) -> Path:
    """The folder of a capture of a body with a spot in it."""
    folder = tmp_path_factory.mktemp("volume")
    twin_capture.bodies(folder, vertices=500)
    box = [[-24, -24, -24], [24, 24, 24]]
    VolumeMaterial.from_function(truth, box, 0.6, twin_capture.ETA).save(folder / "truth.npz")
    twin_capture.write(folder, folder / "truth.npz", SEED)
    return folder


@pytest.fixture(scope="module")
def found(twin) -> dict[str, Any]:
    """The report of a recovery."""
    paths = [str(twin / name) for name in ("capture.json", "wax.npz", "wax.json", "wax.html")]
    options = ["--json", paths[2], "--report", paths[3], "--device", "cpu", "--volume", "--spacing", "5"]
    # A process of its own, whose memory is none of this one's: others are measured by what started them.
    command = [sys.executable, "-m", "quadgraph.cli", "acquire", paths[0], "-o", paths[1], *options]
    subprocess.run(command, check=True)
    return json.loads(Path(paths[2]).read_text())


def places(volume: dict[str, np.ndarray]) -> np.ndarray:
    """(nz, ny, nx, 3) mm of the points of a file."""
    z, y, x = np.indices(volume["sigma_a"].shape[:3])
    return volume["origin"] + float(volume["spacing"]) * np.stack([x, y, z], axis=-1)


def test_a_spot_is_found_where_it_is(twin, found):
    assert found["findings"] == []
    assert max(found["volume"]["chi_squared_per_square"]) < 1.5
    volume = npz.read(twin / "wax.npz", VOLUME)
    points = places(volume)
    inside = np.linalg.norm(points / [1, 0.8, 0.9], axis=-1) < 15
    spot = np.linalg.norm(points - SPOT, axis=-1) < RADIUS - 2
    beside = inside & (np.linalg.norm(points - SPOT, axis=-1) > RADIUS + 4)
    for name, most in (("sigma_a", ABSORPTION), ("sigma_s_prime", SCATTERING)):
        assert np.median(volume[name][beside]) == pytest.approx(most, rel=0.2)
    contrast = np.median(volume["sigma_a"][spot]) / np.median(volume["sigma_a"][beside])
    assert 2.4 < contrast < 5
    assert np.median(volume["sigma_s_prime"][spot]) == pytest.approx(SCATTERING, rel=0.25)


def test_the_truth_lies_within_what_is_said_of_it(twin, found):
    """Beside the spot's edge, where no grid of this spacing holds the truth."""
    volume = npz.read(twin / "wax.npz", VOLUME)
    points = places(volume)
    inside = np.linalg.norm(points / [1, 0.8, 0.9], axis=-1) < 18
    chosen = inside & (np.linalg.norm(points - SPOT, axis=-1) > RADIUS + 2)
    for name, true in (("sigma_a", ABSORPTION), ("sigma_s_prime", SCATTERING)):
        deviation = volume[f"{name}_deviation"][chosen]
        within = np.abs(np.log(volume[name][chosen] / true)) < 2 * deviation
        assert within.mean() > 0.8, name
        assert 0.02 < np.median(deviation) < 0.3, name


def test_resolution_lengths_are_finest_where_light_comes_near(twin, found):
    """Below the surface, and not in the middle; nowhere below the grid's spacing."""
    volume = npz.read(twin / "wax.npz", VOLUME)
    radius = np.linalg.norm(places(volume) / [1, 0.8, 0.9], axis=-1)
    for name in COEFFICIENTS:
        length = volume[f"{name}_resolution"]
        assert length.min() >= float(volume["spacing"])
        near, middle = (np.median(length[chosen]) for chosen in ((radius > 12) & (radius < 17), radius < 7))
        assert near < 0.8 * middle, name


def test_a_volume_is_rendered_with_its_deviations_in_the_file(twin, found):
    command = [
        "render",
        str(twin / "potato.qgraph"),
        "--material",
        str(twin / "wax.npz"),
        "--size",
        "32x32",
        "--device",
        "cpu",
    ]
    assert main([*command, "-o", str(twin / "wax.png")]) == 0


def test_the_page_shows_slices(twin, found, browser):
    browser.get((twin / "wax.html").as_uri())
    texts = "return Array.from(document.querySelectorAll('h3')).map(each => each.textContent)"
    titles = browser.execute_script(texts)
    kinds = ("", "Deviation of ", "Resolution length of ")
    assert titles[:6] == [f"{kind}{name}" for name in COEFFICIENTS for kind in kinds]
    assert not browser.get_log("browser")


def test_a_posed_body_is_refused(twin, tmp_path, capsys):
    document = json.loads((twin / "capture.json").read_text())
    path = twin / "posed.json"
    path.write_text(json.dumps(document | {"deformation": [{"type": "transform", "translate": [0, 1, 0]}]}))
    assert main(["acquire", str(path), "-o", str(tmp_path / "wax.npz"), "--volume"]) == 1
    assert (
        f"{path}: deformation: found, allowed with --volume is a body that lies as in its file"
        in capsys.readouterr().err
    )
    assert not (tmp_path / "wax.npz").exists()


@pytest.fixture(scope="module")
def setting(twin, tmp_path_factory) -> VolumeSetting:
    """Photographs and grid of the twin."""
    stated = capture.read(twin / "capture.json")
    predictor = Predictor(stated, twin / "potato.qgraph", "cpu")
    first = predictor.predict(np.array([[0.03] * 3, [0.8] * 3]), False)
    problem = Problem(stated, photographs.read_all(stated), first)
    return VolumeSetting(problem, predictor, 6.0, tmp_path_factory.mktemp("volumes"), lambda: None)


def test_the_derivative_of_a_volume_is_that_of_its_predictions(setting):
    random = np.random.default_rng(6)
    logs = np.log([[[0.03]], [[0.8]]]) + 0.2 * random.normal(size=(2, setting.grid.count, 3))
    around = setting.predicted(logs, np.ones((4, 3)), False)
    along, step = random.normal(size=logs.shape), 1e-3
    above, below = (around.moved(logs + sign * step * along, around.gains).residual for sign in (1, -1))
    counts = around.weights.counts
    change = ((below - above) / (2 * step))[counts]
    expected = around.along(along)[counts]
    assert np.abs(change - expected).max() < 1e-4 * np.abs(expected).max()
    weights = np.where(counts, random.normal(size=counts.shape), 0)
    moved = np.where(counts, around.along(along), 0)
    left, right = (moved * weights).sum(), (along * around.transposed(weights)).sum()
    assert abs(left - right) < 1e-6 * np.linalg.norm(moved) * np.linalg.norm(weights)


def test_sets_of_lights_may_share_an_engine(setting, twin, tmp_path, monkeypatch):
    """There are at most so many engines, however many sets of lights."""
    monkeypatch.setattr(prediction, "_STAGES", 1)
    predictor = Predictor(setting.problem.capture, twin / "potato.qgraph", "cpu")
    shared = VolumeSetting(setting.problem, predictor, 6.0, tmp_path, lambda: None)
    logs = np.log(np.broadcast_to([[[0.03]], [[0.8]]], (2, shared.grid.count, 3)))
    for found, expected in zip(shared.linearised(logs).radiances, setting.linearised(logs).radiances, strict=True):
        np.testing.assert_allclose(found, expected, rtol=1e-5, atol=1e-7 * expected.max())


def test_spacing_is_of_volumes(twin, tmp_path, capsys):
    assert main(["acquire", str(twin / "capture.json"), "-o", str(tmp_path / "wax.npz"), "--spacing", "4"]) == 1
    assert "--spacing: found without --volume" in capsys.readouterr().err
    assert not (tmp_path / "wax.npz").exists()


def test_what_squares_share_is_taken_out_as_by_the_whole_covariance(setting):
    """The engine's error: alike within lights and brightness, in parts of pictures, and apart in each square."""
    logs = np.log(np.broadcast_to([[[0.03]], [[0.8]]], (2, setting.grid.count, 3)))
    around = setting.predicted(logs, np.ones((4, 3)), False)
    weights, residual = around.weights, around.residual
    pairs = list(zip(setting.samples.squares, around.pictures, strict=True))
    error = np.concatenate([squares.of(picture.error) for squares, picture in pairs])[:, 1]
    band = np.concatenate([np.rint(squares.of(picture.band)) for squares, picture in pairs])[:, 1]
    value = (setting.data - residual)[:, 1]
    lights = np.repeat([0, 0, 1, 1], [len(squares.rays) for squares, _ in pairs])
    counts = weights.counts[:, 1]
    alike = (lights[:, None] == lights) & (band[:, None] == band)
    tile = np.concatenate([16 * number + squares.tile for number, (squares, _) in enumerate(pairs)])
    beside = AT_FIRST.in_tiles[1] ** 2 * (tile[:, None] == tile)
    covariance = np.diag(1 / around.weighing.each[counts, 1])
    assert (np.diag(covariance) > (AT_FIRST.local[1] * error * value)[counts] ** 2).all()
    covariance += ((alike + beside) * np.outer(error * value, error * value))[np.ix_(counts, counts)]
    expected = np.linalg.solve(covariance, residual[counts, 1])
    np.testing.assert_allclose(
        around.weighing.apply(residual)[counts, 1], expected, rtol=1e-6, atol=1e-9 * abs(expected).max()
    )


def test_the_size_of_the_error_is_what_residuals_speak_for(setting):
    logs = np.log(np.broadcast_to([[[0.03]], [[0.8]]], (2, setting.grid.count, 3)))
    around = setting.predicted(logs, np.ones((4, 3)), False)
    weights, pairs = around.weights, list(zip(setting.samples.squares, around.pictures, strict=True))
    error = np.concatenate([squares.of(picture.error) for squares, picture in pairs]) * (setting.data - around.residual)
    number = np.concatenate([16 * k + squares.tile for k, (squares, _) in enumerate(pairs)])
    variance = 1 / weights.resized(Sizes(np.ones(3), np.full(3, 1e-9))).at(np.zeros(error.shape)).each
    noise = np.where(weights.counts, np.sqrt(variance), 0)
    random = np.random.default_rng(8)
    guess = Sizes(np.full(3, 0.25), np.full(3, 0.5))
    for in_tiles, local in ((0.3, 0.5), (0.6, 0.2)):
        found = []
        for _ in range(20):
            shared = random.normal(size=(number.max() + 1, 3))[number]
            own, read = random.normal(size=(2, *error.shape))
            found.append(weights.estimated(in_tiles * error * shared + local * error * own + noise * read, guess))
        squares = np.square(found).mean(axis=0)
        np.testing.assert_allclose(squares[0], in_tiles**2, rtol=0.25)
        np.testing.assert_allclose(squares[1], local**2, rtol=0.1, atol=0.015)
    least = weights.estimated(noise * random.normal(size=error.shape), AT_FIRST)
    assert (np.concatenate(least) < 0.25).all()


def test_schemes_are_those_of_volumes(twin, tmp_path, capsys):
    command = ["acquire", str(twin / "capture.json"), "-o", str(tmp_path / "wax.npz")]
    assert main([*command, "--scheme", "h1"]) == 1
    assert "--scheme: found without --volume" in capsys.readouterr().err
    assert main([*command, "--volume", "--scheme", "published", "--resume", str(tmp_path)]) == 1
    assert "--resume: found with --scheme published, which keeps no steps" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.long
@pytest.mark.parametrize("scheme", ["h1", "published"])
def test_other_schemes_recover_too(twin, tmp_path, scheme):
    """About: they are there to compare with."""
    output, report = tmp_path / "wax.npz", tmp_path / "wax.json"
    command = ["acquire", str(twin / "capture.json"), "-o", str(output), "--json", str(report), "--device", "cpu"]
    main([*command, "--volume", "--spacing", "5", "--scheme", scheme])
    said = json.loads(report.read_text())
    assert (scheme == "published") == ("resolution" not in said["volume"])
    assert (scheme == "published") == any("does not say how well" in line for line in said["undetermined"])
    volume = npz.read(output, VOLUME)
    points = places(volume)
    spot = np.linalg.norm(points - SPOT, axis=-1) < RADIUS - 2
    beside = (np.linalg.norm(points / [1, 0.8, 0.9], axis=-1) < 15) & (
        np.linalg.norm(points - SPOT, axis=-1) > RADIUS + 4
    )
    assert np.median(volume["sigma_a"][spot]) > 1.2 * np.median(volume["sigma_a"][beside])
    assert np.median(volume["sigma_s_prime"][beside]) == pytest.approx(SCATTERING, rel=0.3)
