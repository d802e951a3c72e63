"""Pictures of a volume that was carried into another body are those of random walks through what was carried."""

from __future__ import annotations

import json
import runpy
from pathlib import Path

import numpy as np
import pytest

from baked import write_levels
from shapes import icosphere

core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
pytest.importorskip("numba", reason="the extra walks is not installed")

from quadgraph_validation.truth import photographed  # noqa: E402

EXAMPLE = Path(__file__).resolve().parents[3] / "docs/examples/veined_block.py"
WALKS, SIDE, RADIUS = 6000, 16, 10.0  # of a pixel; pixels; mm
LIGHT = {"type": "rectangle", "centre": [-30, 20, 40], "u": [8, 15, -8], "v": [15, 0, 15], "power": 10}


@pytest.mark.long
def test_pictures_of_a_mapped_volume_are_those_of_random_walks(tmp_path):
    runpy.run_path(str(EXAMPLE))["main"](tmp_path / "block.obj", tmp_path / "block.npz")
    write_levels(tmp_path / "ball.qgraph", [icosphere(4, RADIUS), icosphere(3, RADIUS)])
    picture = {"width": SIDE, "height": SIDE, "samples": 256, "transmission_roughness": 0}
    scene = {
        "body": "ball.qgraph",
        "material": {"volume": "block.npz", "map": "shell"},
        "lights": [LIGHT],
        "camera": {"azimuth": 0, "elevation": 10, "fov": 24},
        "picture": picture,
    }
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(scene))
    subject = photographed.subject(path)
    options = photographed.PhotographOptions(azimuths=(0.0,), walks=WALKS, seed=3)
    cameras = photographed.views(subject, options)
    ((walked, noise),) = photographed.by_walks(subject, cameras, options, lambda share: None).values()
    scene["camera"] = {name: cameras["view1"][name] for name in ("eye", "look_at", "up", "fov")}
    path.write_text(json.dumps(scene))
    stage = core.Stage()
    stage.show(core.SceneFile(path).at(0))
    stage.solve()
    found = np.array(stage.render().scattered, np.float64)
    off, noise_there, all_of_it = (float((each**2).sum()) for each in (found - walked, noise, walked))
    assert noise_there / all_of_it < 0.1**2
    assert off - noise_there < 0.05**2 * all_of_it
    assert found.sum() == pytest.approx(walked.sum(), rel=0.03)
