"""Coefficients from photographs by random walks, which share nothing with the engine but the shape."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph.cli import main

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
pytest.importorskip("numba", reason="numba is not installed: run tools/setup")

SCENES = Path(__file__).resolve().parents[3] / "docs" / "scenes"
MATERIAL = {"sigma_s_prime": [0.8, 1.0, 1.4], "sigma_a": [0.03, 0.01, 0.1], "eta": 1.3}


@pytest.mark.long
def test_walks_are_recovered_within_what_is_said(tmp_path):
    (tmp_path / "scenes" / "docs").mkdir(parents=True)
    (tmp_path / "out").mkdir()
    shutil.copy(SCENES / "pebble.obj", tmp_path)
    bake(tmp_path / "pebble.obj", tmp_path / "out" / "pebble.qgraph", BakeOptions(unit="mm", levels=2))
    document = json.loads((SCENES / "pebble.json").read_text()) | {"material": MATERIAL}
    document["picture"] = {"width": 48, "height": 48}
    scene = tmp_path / "scenes" / "docs" / "pebble.json"
    scene.write_text(json.dumps(document))
    files = [str(tmp_path / name) for name in ("capture.json", "found.npz", "found.json")]
    assert main(["photograph", str(scene), "--capture", files[0], "--seed", "9"]) == 0
    assert main(["acquire", files[0], "-o", files[1], "--json", files[2], "--device", "cpu"]) == 0
    report = json.loads(Path(files[2]).read_text())
    for name, most in (("sigma_a", 0.15), ("sigma_s_prime", 0.1)):
        off = np.log(np.array(report["coefficients"][name]) / MATERIAL[name])
        assert (np.abs(off) < most).all()
        assert (np.abs(off) < 3 * np.array(report["deviations_of_logarithms"][name])).all()
    assert (np.array(report["chi_squared_per_degree"]) < 2).all()
