"""The recovery of a volume goes on from where it was left, and from nothing else."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

import twin_capture
from quadgraph import VolumeMaterial
from quadgraph.acquisition.capture import capture
from quadgraph.acquisition.recovery import recover
from quadgraph.acquisition.volume import volume_fit
from quadgraph.acquisition.volume.fit_state import FitState, StateFolder
from quadgraph.acquisition.volume.volume_options import VolumeOptions
from quadgraph.base.errors import InputError
from quadgraph.cli import main

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")


@pytest.fixture(scope="module")
def twin(tmp_path_factory) -> Path:
    """The folder of a capture of a body that is denser above."""
    folder = tmp_path_factory.mktemp("resumed")
    twin_capture.bodies(folder, vertices=300, finer=3)
    box = [[-24, -24, -24], [24, 24, 24]]
    VolumeMaterial.from_function(lambda p: (np.where(p[:, 1] > 0, 0.9, 0.6), 0.02), box, 1, twin_capture.ETA).save(
        folder / "truth.npz"
    )
    twin_capture.write(folder, folder / "truth.npz", 7)
    return folder


def state(points: int = 4) -> FitState:
    random = np.random.default_rng(1)
    shapes = {"start": (2, 3), "gains": (4, 3), "logs": (2, points, 3), "told": (2, points, 3), "chi_squared": (2, 3)}
    shapes |= {"in_tiles": (3,), "local": (3,), "factors": (5, 3)}
    arrays = {name: random.uniform(size=shape) for name, shape in shapes.items()}
    return FitState(
        **arrays,
        smoothing=np.array(2.0),
        enough=np.array(False),
        outer=np.array(1),
        smoothings=np.array([3.0, 2.0]),
        draw=np.array(1),
    )


def test_a_state_comes_back_as_it_was_kept(twin, tmp_path):
    stated = capture.read(twin / "capture.json")
    folder = StateFolder(tmp_path / "new" / "state", stated, "options")
    assert folder.read() is None
    kept = state()
    folder.write(kept)
    found = StateFolder(tmp_path / "new" / "state", stated, "options").read()
    assert found is not None
    for name in FitState.__annotations__:
        np.testing.assert_array_equal(getattr(found, name), getattr(kept, name))


def test_a_state_of_anything_else_is_refused(twin, tmp_path):
    stated = capture.read(twin / "capture.json")
    StateFolder(tmp_path, stated, "options").write(state())
    with pytest.raises(InputError, match=r"key: found that of another capture.*; remove the file"):
        StateFolder(tmp_path, stated, "other options").read()
    other = tmp_path / "other"
    shutil.copytree(twin, other)
    photograph = next(iter(other.glob("*-front.npz")))
    with np.load(photograph) as file:
        np.savez(photograph, photograph=1.01 * file["photograph"])
    with pytest.raises(InputError, match="key: found that of another capture"):
        StateFolder(tmp_path, capture.read(other / "capture.json"), "options").read()
    with np.load(tmp_path / "acquire-state.npz") as file:
        arrays = {name: file[name] for name in file.files if name != "told"}
    np.savez(tmp_path / "acquire-state.npz", **arrays)
    with pytest.raises(InputError, match="told: is missing; remove the file to begin anew"):
        StateFolder(tmp_path, stated, "options").read()
    arrays["told"] = np.zeros((2, 3, 3))  # of three points, where logs are of four
    np.savez(tmp_path / "acquire-state.npz", **arrays)
    with pytest.raises(InputError, match=r"told: float64 of shape \(2, 3, 3\) found.*\(2, 4, 3\) wanted; remove"):
        StateFolder(tmp_path, stated, "options").read()
    arrays["told"] = np.full((2, 4, 3), np.nan)
    np.savez(tmp_path / "acquire-state.npz", **arrays)
    with pytest.raises(InputError, match=r"told: .* finite numbers"):
        StateFolder(tmp_path, stated, "options").read()
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="--resume: cannot be made a folder"):
        StateFolder(tmp_path / "file", stated, "options")


def test_resume_is_of_volumes(twin, tmp_path, capsys):
    command = ["acquire", str(twin / "capture.json"), "-o", str(tmp_path / "wax.npz")]
    assert main([*command, "--resume", str(tmp_path / "state")]) == 1
    assert "--resume: found without --volume" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.long
def test_what_was_interrupted_ends_as_if_it_had_not_been(twin, tmp_path, monkeypatch):
    stated = capture.read(twin / "capture.json")
    said: list[str] = []

    def recovered(folder: Path | None):
        said.clear()
        return recover(stated, False, VolumeOptions(8.0), said.append, lambda share: None, "cpu", resume=folder)

    whole = recovered(None).fit
    told = said.copy()
    monkeypatch.setattr(volume_fit, "OUTER", 1)
    recovered(tmp_path / "state")
    monkeypatch.undo()
    path = tmp_path / "state" / "acquire-state.npz"
    with np.load(path) as file:
        assert int(file["outer"]) == 1
    resumed = recovered(tmp_path / "state").fit
    assert said[0].startswith("volume: ")  # without a homogeneous fit
    assert said[1].startswith("resumed: ")
    assert said[-2:] == told[-2:]
    # Sums of several threads differ in their last digit.
    smoothings = [step.smoothing for step in whole.steps]
    assert [step.smoothing for step in resumed.steps] == pytest.approx(smoothings, rel=1e-9)
    np.testing.assert_allclose(resumed.coefficients, whole.coefficients, rtol=1e-6)
    np.testing.assert_allclose(resumed.deviations, whole.deviations, rtol=1e-6)
