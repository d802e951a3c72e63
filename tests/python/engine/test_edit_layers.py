"""Layers of edits in scene files and in Python, and edits that are on both sides of a body."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from PIL import Image

import quadgraph
from baked import write_levels
from quadgraph.base.errors import InputError
from shapes import icosphere

core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

SCHEMA = json.loads((Path(__file__).resolve().parents[3] / "docs" / "scene.schema.json").read_text())
SPOT = {"operation": "add", "sigma_a": 1, "stroke": [[6, 0, 8]], "radius": 4, "softness": 2}
OTHER = {"stroke": [[-6, 0, 8]]}
DARK = {"operation": "add", "sigma_a": 0.5}
FAR = np.array([[6.0, 0.0, -8.0], [-6.0, 0.0, -8.0], [0.0, 6.0, -8.0]])  # mm, on the unlit side of the ball


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """A sphere of radius 10 mm, and an image."""
    path = tmp_path_factory.mktemp("layers")
    write_levels(path / "sphere.qgraph", [icosphere(3, 10), icosphere(2, 10)])
    Image.fromarray(np.full((8, 8, 3), 128, np.uint8)).save(path / "grey.png")
    return path


def layer(*edits: dict, **more: object) -> dict:
    return {"name": "Spots", "edits": list(edits), **more}


def scene_of(folder: Path, edits: list, name: str = "scene.json", **more: object) -> Path:
    scene = {
        "body": "sphere.qgraph",
        "material": "sigma_s_prime=3,sigma_a=.01",
        "lights": [{"type": "directional", "direction": [0, 0, -1], "irradiance": 1}],
        "edits": edits,
        "solver": {"correction": False},
        **more,
    }
    (folder / name).write_text(json.dumps(scene))
    return folder / name


def exitance(folder: Path, edits: list) -> np.ndarray:
    """Of the lit half, (faces, 3), and before that the place of each face."""
    with quadgraph.Stage() as stage:
        stage.show(quadgraph.SceneFile(scene_of(folder, edits)).at(0))
        stage.solve()
        field = stage.engine.surface()
        return np.hstack([field.position, field.exitance])[field.position[:, 2] > 0]


def test_hidden_layers_are_not_there_and_opacity_is_a_share_of_the_way(folder):
    none, whole = exitance(folder, []), exitance(folder, [layer(DARK)])
    assert np.array_equal(whole, exitance(folder, [DARK]))
    for absent in ({"visible": False}, {"opacity": 0}):
        assert np.array_equal(none, exitance(folder, [layer(DARK, **absent)]))
        assert np.array_equal(whole, exitance(folder, [layer(SPOT, **absent), DARK]))
    half = {"operation": "add", "sigma_a": 0.25}
    assert np.allclose(exitance(folder, [layer(DARK, opacity=0.5)]), exitance(folder, [half]), rtol=1e-5)
    assert np.allclose(
        exitance(folder, [layer({**DARK, "operation": "set"}, {**DARK, "operation": "set"}, opacity=0.5)]),
        exitance(folder, [{"operation": "set", "sigma_a": 0.255}]),  # half way from .01 to .5, however often
        rtol=1e-4,
    )
    assert none[:, 3].mean() > 1.5 * exitance(folder, [half])[:, 3].mean()


def test_shortest_paths_see_layers_and_mirror_images_too(folder):
    paths = {"solver": {"method": "shortest-path", "path": {"cells": 40}}}

    def shown(*edits: dict) -> np.ndarray:
        """What leaves at places of the unlit side, (places, 3)."""
        stage = core.Stage(validation=True)
        stage.show(core.SceneFile(scene_of(folder, list(edits), **paths)).at(0))
        stage.solve()
        assert stage.engine.validation_messages == []
        return stage.engine.exitance_at(FAR)

    weak = shown(layer(DARK, opacity=0.5))
    assert np.allclose(weak, shown({**DARK, "sigma_a": 0.25}), rtol=1e-4)
    assert weak.mean() < 0.9 * shown().mean()
    here, there = ({**SPOT, "stroke": [[side, 0, -8]]} for side in (6, -6))
    both = shown({**here, "mirrored": {"stroke": there["stroke"]}})
    assert np.allclose(both, shown(here, there), rtol=1e-4)  # they do not meet
    assert (both[:2, 0] < 0.5 * shown()[:2, 0]).all()


def test_a_mirrored_stroke_darkens_both_sides_alike(folder):
    plain = exitance(folder, [])
    one, other = exitance(folder, [SPOT]), exitance(folder, [{**SPOT, **OTHER}])
    both = exitance(folder, [{**SPOT, "mirrored": OTHER}])
    _, y, z = plain[:, :3].T
    right, left = (np.linalg.norm(plain[:, :3] - [side, 0, 8], axis=1) < 2 for side in (6, -6))
    share, mirrored = one[:, 3] / plain[:, 3], both[:, 3] / plain[:, 3]
    assert share[right].mean() < 0.3
    assert share[left].mean() > 0.9
    assert mirrored[right].mean() == pytest.approx(share[right].mean(), rel=0.02)
    assert mirrored[left].mean() == pytest.approx((other[:, 3] / plain[:, 3])[left].mean(), rel=0.02)
    assert mirrored[left].mean() == pytest.approx(mirrored[right].mean(), rel=0.1)  # the mesh has no mirror image
    assert mirrored[(z > 5) & (np.abs(y) > 6)].min() > 0.6  # between them it is as it was


def test_layers_are_kept_by_python_and_by_files(folder, tmp_path):
    stamp = {**DARK, "image": "grey.png", "placement": {"centre": [0, 0, 8], "size": [4, 4, 4]}}
    edits = [
        layer({**SPOT, "mirrored": OTHER}, opacity=0.25, visible=False),
        layer({**stamp, "mirrored": {"placement": stamp["placement"]}}, name="Größe"),
    ]
    path = scene_of(folder, edits, "kept.json")
    jsonschema.validate(json.loads(path.read_text()), SCHEMA)
    file = quadgraph.SceneFile(path)
    file.save(tmp_path / "copy.json")
    saved = json.loads((tmp_path / "copy.json").read_text())["edits"]
    assert (tmp_path / saved[1]["edits"][0]["image"]).resolve() == (folder / "grey.png").resolve()
    shown = quadgraph.SceneFile(tmp_path / "copy.json").at(0)
    assert [(each["name"], each["visible"], each["opacity"]) for each in shown.edits] == [
        ("Spots", False, 0.25),
        ("Größe", True, 1),
    ]
    document = json.loads(json.dumps(shown.to_dict()))
    jsonschema.validate(document, SCHEMA)
    again = quadgraph.SceneFile(quadgraph.Scene.from_dict(document)).at(0)
    assert json.loads(json.dumps(again.to_dict())) == document
    assert document["edits"][0]["edits"][0]["mirrored"]["stroke"] == [[-6, 0, 8]]


def test_edits_without_a_layer_are_read_and_written_as_before(folder):
    shown = quadgraph.SceneFile(scene_of(folder, [DARK, SPOT])).at(0)
    assert [each["operation"] for each in shown.edits] == ["add", "add"]
    mixed = quadgraph.SceneFile(scene_of(folder, [DARK, layer(SPOT), SPOT])).at(0)
    assert [each["name"] for each in mixed.edits] == ["Layer 1", "Spots", "Layer 3"]


def test_the_opacity_of_a_layer_may_change_from_frame_to_frame(folder):
    track = {"path": "/edits/0/opacity", "keys": [[0, 0], [10, 1]]}
    file = quadgraph.SceneFile(scene_of(folder, [layer(SPOT)], "moving.json", tracks=[track]))
    assert [file.at(frame).edits[0]["opacity"] for frame in (0, 5, 10)] == pytest.approx([0, 0.5, 1])


def test_an_engine_takes_layers_with_arrays_in_them(folder):
    with quadgraph.Engine(folder / "sphere.qgraph") as engine:
        engine.material = "wholemilk"
        before = engine.solve().energy.absorbed
        dark = {**SPOT, "sigma_a": np.array([5.0, 5.0, 5.0]), "stroke": np.array([[0.0, 0.0, 10.0]])}
        engine.set_edits([{"name": "Spots", "opacity": np.float32(0.5), "edits": [dark]}])
        assert engine.solve().energy.absorbed[0] > 1.02 * before[0]
        with pytest.raises(InputError, match="/edits/0/opacity: found 2, allowed is"):
            engine.set_edits([layer(dark, opacity=2)])


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        ({"name": "a", "edits": [{**DARK, "operation": "dye"}]}, "/edits/0/edits/0/operation: found"),
        ({"name": "a", "edits": {}}, "/edits/0/edits: found"),
        ({"name": "a", "edits": [], "blend": "normal"}, "/edits/0/blend: found"),
        ({"name": "", "edits": []}, "/edits/0: name: found 0 bytes"),
        ({"name": "a" * 65, "edits": []}, "/edits/0: name: found 65 bytes"),
        ({"name": "a", "opacity": "half", "edits": []}, "/edits/0/opacity: found"),
        ({"name": "a", "opacity": -0.1, "edits": []}, "/edits/0/opacity: found -0.1"),
        ({"name": "a", "visible": None, "edits": []}, "/edits/0/visible: found null"),
        ({"name": "a", "edits": [{"name": "b", "edits": []}]}, "/edits/0/edits/0/name: found"),
        ({**SPOT, "mirrored": {}}, "/edits/0: mirrored: stroke: found 0"),
        ({**SPOT, "mirrored": {"stroke": [[0, 0]]}}, "/edits/0/mirrored/stroke/0: found"),
        ({**SPOT, "mirrored": {**OTHER, "axis": "x"}}, "/edits/0/mirrored/axis: found"),
    ],
)
def test_schema_and_engine_refuse_the_same_of_layers(folder, edit, said):
    path = scene_of(folder, [edit], "bad.json")
    assert not jsonschema.Draft202012Validator(SCHEMA).is_valid(json.loads(path.read_text()))
    with pytest.raises(InputError, match=f"bad.json: {said}"):
        quadgraph.SceneFile(path)


def test_more_layers_than_a_scene_may_have_are_refused(folder):
    empty = {"name": "a", "edits": []}
    assert len(quadgraph.SceneFile(scene_of(folder, 256 * [empty])).at(0).edits) == 256
    for last in (empty, DARK):
        with pytest.raises(InputError, match=r"/edits/256: found .*, allowed is at most 256 layers"):
            quadgraph.SceneFile(scene_of(folder, [*(256 * [empty]), last]))
