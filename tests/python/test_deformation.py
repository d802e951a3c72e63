"""Deformations from Python and in scene files."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from quadgraph import _core
from quadgraph.errors import InputError

TINY = Path(__file__).resolve().parents[1] / "data" / "tiny.qgraph"

TETRAHEDRON = {
    "cage": [[-9, -9, -9], [30, -9, -9], [-9, 30, -9], [-9, -9, 30]],
    "triangles": [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
}
EVERY_KIND = [
    {"type": "twist", "axis": [0, 1, 0.5], "degrees": 90, "range": [0.2, 0.8]},
    {"type": "bend", "towards": [0, 0, 1], "degrees": 30, "centre": [0, 1, 0]},
    {"type": "taper", "factor": 0.5, "range_mm": [0, 1.5]},
    {"type": "stretch", "axis": [1, 0, 0], "factor": 2},
    {"type": "transform", "degrees": 20, "scale": 1.5, "translate": [1, 2, 3]},
    {"type": "lattice", "size": [1, 2, 1], "displacements": [[0, 0, 0], [1, 0, 0]], "basis": "linear"},
    {"type": "cage", **TETRAHEDRON, "moved": [[-9, -9, -9], [30, -9, -9], [-9, 33, -9], [-9, -9, 30]]},
]


@pytest.fixture(scope="module")
def engine():
    engine = _core.Engine(TINY, validation=True)
    engine.set_material("marble")
    engine.set_lights(["directional:0,-1,-1:1"])
    yield engine
    assert engine.validation_messages == []


def test_every_kind_is_written_out_and_read_back_as_it_is():
    written = _core.check_deformation(EVERY_KIND)
    assert _core.check_deformation(written) == written
    assert json.loads(written)[0] == {**EVERY_KIND[0], "axis": [0, 1, 0.5]}


@pytest.mark.parametrize(
    ("deformer", "said"),
    [
        ({"type": "melt"}, "/1/type.*twist, bend"),
        ({"type": "twist", "degrees": "a lot"}, "/1/degrees.*a number"),
        ({"type": "twist", "factor": 2}, "/1/factor.*degrees"),
        ({"type": "stretch", "factor": 0}, "/1: stretch, factor.*0.001"),
        ({"type": "taper", "factor": 2, "range": [1, 0]}, "/1: taper, range"),
        ({"type": "cage", **TETRAHEDRON}, "/1/moved"),
        ({"type": "displaced", "shapes": "nowhere.qshapes", "frame": 0}, "/1/shapes.*cannot be read"),
    ],
)
def test_what_makes_no_sense_is_refused_with_its_place(engine, deformer, said):
    with pytest.raises(InputError, match=said):
        engine.set_deformation([{"type": "twist", "degrees": 1}, deformer])


def test_a_body_that_is_scaled_takes_in_so_much_more_light_and_comes_back(engine):
    rest = engine.solve()["energy"]["entered"]
    exitance = engine.surface_field()["exitance"]
    engine.set_deformation([{"type": "transform", "scale": 3}])
    report = engine.solve()
    assert report["deformed"] == ""
    assert np.allclose(report["energy"]["entered"], 9 * np.array(rest), rtol=1e-3)
    area = engine.surface_field()["area"].sum()
    engine.set_deformation([])
    engine.solve()
    field = engine.surface_field()
    assert area == pytest.approx(9 * field["area"].sum(), rel=1e-5)
    assert np.array_equal(field["exitance"], exitance)


def test_a_scene_file_deforms_and_moves_the_deformation(tmp_path):
    scene = {
        "body": str(TINY),
        "deformation": [{"type": "stretch", "factor": 1}],
        "tracks": [{"path": "/deformation/0/factor", "keys": [[0, 1], [4, 3]]}],
    }
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(scene))
    file = _core.SceneFile(path)
    stage = _core.Stage(validation=True)
    heights = []
    for frame in (0, 2, 4):
        stage.show(file.at(frame))
        stage.solve()
        heights.append(np.ptp(stage.engine.surface_field()["position"][:, 1]))
    assert np.allclose(np.array(heights) / heights[0], [1, 2, 3], rtol=1e-5)
    assert json.loads(file.at(2).json())["deformation"][0]["factor"] == 2
    assert stage.engine.validation_messages == []
