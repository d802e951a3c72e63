"""What is cut away from a body that is shown by shortest paths: light, volume, picture and scene file."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from quadgraph.baking import bare
from quadgraph.base.errors import InputError
from shapes import cube, icosphere

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

CELLS = 40


def write_body(folder: Path, surface) -> Path:
    """A file without levels."""
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in surface.vertices]
    lines += [f"f {a} {b} {c}" for a, b, c in surface.triangles + 1]
    (folder / "mesh.obj").write_text("\n".join(lines) + "\n")
    bare.write(folder / "mesh.obj", folder / "mesh.qgraph", unit="mm")
    return folder / "mesh.qgraph"


@pytest.fixture
def engine_of(tmp_path: Path):
    """Makes one engine, lit along z, and looks at what the validation layer said at the end."""
    engines = []

    def make(surface):
        engine = _core.Engine(write_body(tmp_path, surface), validation=True)
        engine.set_material("sigma_s_prime=1,sigma_a=.01,eta=1")
        engine.set_lights(["directional:0,0,1:1"])
        engines.append(engine)
        return engine

    yield make
    assert [message for engine in engines for message in engine.validation_messages] == []


def cut(engine, *cuts: dict) -> dict:
    """The report after these cuts and no others."""
    engine.set_cuts(json.dumps(cuts))
    return engine.solve(method="shortest-path", path_cells=CELLS)["path"]


def test_a_body_in_two_is_dark_behind(engine_of):
    sphere = icosphere(4, 10.0)
    engine = engine_of(sphere)
    cut(engine)
    behind = sphere.vertices[sphere.vertices[:, 2] > 3]
    before = engine.exitance_at(behind)
    assert before.min() > 0
    report = cut(engine, {"type": "slab", "normal": [0, 0, 1], "offset": 0, "thickness": 3})
    assert np.all(engine.exitance_at(behind) < 1e-3 * before)
    # A bridge lets the light through, on a longer way.
    whole = report["solid"]
    box = {"type": "box", "centre": [10, 0, 0], "size": [16, 40, 3]}
    assert cut(engine, box)["solid"] > whole
    bridged = engine.exitance_at(behind)
    assert bridged.min() > 0
    assert np.all(bridged <= before * 1.0001)
    cut(engine)
    assert np.array_equal(engine.exitance_at(behind), before)


def test_light_enters_through_a_cut(engine_of):
    engine = engine_of(cube(16.0))
    cell = cut(engine, {"type": "plane", "normal": [0, 0, -2], "offset": 1.0})["cell"]
    # All with -z > 1 is gone: the new face at z = -1 is lit as the old one was.
    points = np.array([[0, 0, -1.0], [4, -5, -1.0], [0, 0, 8.0]])
    lit, too, far = engine.exitance_at(points)[:, 0]
    assert lit == too == pytest.approx(1)
    assert -np.log(far) / np.sqrt(3 * 0.01 * 1.01) == pytest.approx(9, abs=1.5 * cell)


@pytest.mark.parametrize(
    ("tool", "volume", "area"),
    [
        ({"type": "sphere", "centre": [8, 0, 0], "radius": 5}, 2 / 3 * np.pi * 125, 2 * np.pi * 25),
        ({"type": "box", "centre": [0, 0, 0], "size": [4, 6, 30]}, 4 * 6 * 16, 2 * (4 + 6) * 16),
        ({"type": "plane", "normal": [1, 1, 0], "offset": 0}, 16**3 / 2, 16 * 16 * np.sqrt(2)),
    ],
)
def test_volume_that_is_cut_away(engine_of, tool: dict, volume: float, area: float):
    engine = engine_of(cube(16.0))
    whole, rest = (report["solid"] * report["cell"] ** 3 for report in (cut(engine), cut(engine, tool)))
    assert whole - rest == pytest.approx(volume, abs=(area + 16 * 16) * 16 / CELLS)


def test_cut_face_is_seen(engine_of):
    engine = engine_of(icosphere(4, 10.0))
    cut(engine, {"type": "plane", "normal": [0, 0, -1], "offset": 0})
    picture = engine.render(view="180,0", width=96, height=96, roughness=1)
    shown, alpha = np.asarray(picture.scattered)[..., 0], np.asarray(picture.alpha)
    # A flat disc that is lit from the front, with Fresnel's factors out of the way at eta 1: as bright everywhere.
    inner = shown[alpha == 1]
    assert len(inner) > 500
    assert np.median(inner) == pytest.approx(1 / np.pi, rel=1e-4)
    assert (np.abs(inner * np.pi - 1) < 0.01).mean() > 0.9


def test_cut_face_is_picked(engine_of):
    engine = engine_of(icosphere(4, 10.0))
    seen = {"view": "180,0", "up": "y"}  # from -z
    assert engine.pick((0, 0), **seen)["position"][2] == pytest.approx(-10, rel=1e-2)
    cut(engine, {"type": "plane", "normal": [0, 0, -1], "offset": -2})
    face = engine.pick((0, 0), **seen)
    assert np.allclose(face["position"], (0, 0, 2), atol=1e-4)
    assert np.allclose(face["at_rest"], (0, 0, 2), atol=1e-4)
    assert np.allclose(face["normal"], (0, 0, -1))
    assert engine.pick((0, 0), view="0,0")["position"][2] == pytest.approx(10, rel=1e-2)
    # The bottom of a hole; beside it the body.
    cut(engine, {"type": "sphere", "centre": [0, 0, -10], "radius": 4})
    hole = engine.pick((0, 0), **seen)
    assert np.allclose(hole["position"], (0, 0, -6), atol=1e-3)
    assert np.allclose(hole["normal"], (0, 0, -1), atol=1e-3)
    assert np.linalg.norm(engine.pick((0.5, 0), **seen)["position"]) == pytest.approx(10, rel=1e-2)
    # A box that lets the ray through to nothing.
    cut(engine, {"type": "box", "centre": [0, 0, 0], "size": [2, 2, 40]})
    assert engine.pick((0, 0), **seen) is None
    # What lies below the surface moves with the body.
    cut(engine, {"type": "plane", "normal": [0, 0, -1], "offset": -2})
    engine.set_deformation([{"type": "transform", "translate": [0, 0, 1]}])
    assert np.allclose(engine.pick((0, 0), **seen)["at_rest"], (0, 0, 1), atol=1e-3)


def test_wrong_cuts_are_refused(engine_of):
    engine = engine_of(cube(4.0))
    for wrong, message in (
        ({"type": "plane", "normal": [0, 0, 0], "offset": 0}, "cuts/0: normal: found 0"),
        ({"type": "sphere", "centre": [0, 0, 0], "radius": -1}, "cuts/0: radius: found -1"),
        ({"type": "cone"}, 'cuts/0/type: found "cone"'),
        ({"type": "box", "centre": [0, 0, 0]}, "size"),
    ):
        with pytest.raises(InputError, match=message):
            engine.set_cuts(json.dumps([wrong]))


def test_scene_files_have_cuts(tmp_path: Path):
    write_body(tmp_path, icosphere(3, 10.0))
    cuts = [{"type": "slab", "normal": [0, 1, 0], "offset": 2, "thickness": 1}]
    document = {"body": "mesh.qgraph", "solver": {"method": "shortest-path"}, "cuts": cuts}
    (tmp_path / "scene.json").write_text(json.dumps(document))
    file = _core.SceneFile(tmp_path / "scene.json")
    assert json.loads(file.at(0).json())["cuts"] == [{"normal": [0.0, 1.0, 0.0], **cuts[0]}]
    stage = _core.Stage(validation=True)
    stage.show(file.at(0))
    one = stage.solve()["path"]["solid"]
    file.set("/cuts", "[]")
    stage.show(file.at(0))
    assert stage.solve()["path"]["solid"] > one
    file.set("/cuts", json.dumps(cuts))
    file.set("/solver/method", "fem")
    stage.show(file.at(0))
    with pytest.raises(InputError, match="cuts: only the method shortest-path knows them"):
        stage.solve()
    assert stage.engine.validation_messages == []
