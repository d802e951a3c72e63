"""A spoilt capture is refused, or what is wrong with it is named; one that is not spoilt is left in peace."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import twin_capture
from quadgraph.cli import main
from spoilt_captures import QUICK, SLOW, Document, Spoil

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")


@pytest.fixture(scope="module")
def twin(tmp_path_factory) -> Path:
    """The folder of a capture with nothing wrong."""
    return twin_capture.twin(tmp_path_factory.mktemp("twin"), 20)


@pytest.fixture(scope="module")
def coarse_twin(tmp_path_factory) -> Path:
    """The same on coarser meshes: enough for what is plain to see."""
    return twin_capture.twin(tmp_path_factory.mktemp("coarse"), 20, vertices=400, finer=3)


def spoilt(twin: Path, folder: Path, spoil: Spoil) -> Path:
    """A copy of a capture after it was spoilt."""
    shutil.copytree(twin, folder)
    document: Document = json.loads((folder / "capture.json").read_text())
    spoil(folder, document)
    (folder / "capture.json").write_text(json.dumps(document))
    return folder


def acquired(folder: Path, capsys) -> tuple[int, str, dict[str, Any]]:
    """Exit code, what was said, and the report; without correction, which is quicker."""
    paths = [str(folder / name) for name in ("capture.json", "wax.npz", "wax.json")]
    status = main(["acquire", paths[0], "-o", paths[1], "--json", paths[2], "--device", "cpu", "--no-correction"])
    said = capsys.readouterr()
    report = json.loads(Path(paths[2]).read_text()) if status != 1 else {}
    assert status != 1 or not Path(paths[1]).exists()
    return status, said.err if status == 1 else said.out, report


def is_named(folder: Path, texts: tuple[str, ...], capsys) -> None:
    status, said, report = acquired(folder, capsys)
    assert status in (1, 3)
    lines = [said] if status == 1 else report["findings"]
    assert any(all(text in line for text in texts) for line in lines), lines
    assert status == 1 or all(line in said for line in lines)


@pytest.mark.parametrize("name", QUICK)
def test_what_is_wrong_is_refused_or_named(coarse_twin, tmp_path, capsys, name):
    spoil, texts = QUICK[name]
    is_named(spoilt(coarse_twin, tmp_path / "spoilt", spoil), texts, capsys)


@pytest.mark.long
@pytest.mark.parametrize("name", SLOW)
def test_what_is_wrong_in_ways_that_take_longer_to_find_is_named(twin, tmp_path, capsys, name):
    spoil, texts = SLOW[name]
    is_named(spoilt(twin, tmp_path / "spoilt", spoil), texts, capsys)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(6))
def test_nothing_is_found_where_nothing_is_wrong(tmp_path, seed, capsys):
    """Other materials, noise and bodies; one absorbs next to nothing, one a third; gains are unknown in some."""
    generator = np.random.default_rng(seed)
    scattering = np.exp(generator.uniform(np.log(0.4), np.log(3), 3))
    absorbed = [1e-4, 0.5][seed] if seed < 2 else np.exp(generator.uniform(np.log(0.001), np.log(0.1), 3))
    material = {"sigma_a": (absorbed * scattering).tolist(), "sigma_s_prime": scattering.tolist()}
    twin_capture.bodies(tmp_path, shape=twin_capture.pebble if seed > 3 else twin_capture.potato)
    twin_capture.write(tmp_path, material, seed, gains=seed % 2 == 1)
    status, _, report = acquired(tmp_path, capsys)
    assert report["findings"] == []
    assert status == (0 if report["converged"] else 3)
