"""Edits by images in scene files: where they lie, that they stay with the body, and what is wrong with them."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from PIL import Image

from baked import write_levels
from quadgraph.base.errors import InputError
from shapes import icosphere

core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

SCHEMA = Path(__file__).resolve().parents[3] / "docs" / "scene.schema.json"
EDIT = {
    "operation": "add",
    "sigma_a": [2, 2, 2],
    "image": "half.png",
    "mask": "disc.png",
    "placement": {"centre": [0, 0, 6], "direction": [0, 0, -1], "size": [10, 10, 12]},
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """A sphere of radius 10 mm; an image whose right half is red, and a mask that is a disc."""
    path = tmp_path_factory.mktemp("images")
    write_levels(path / "sphere.qgraph", [icosphere(4, 10), icosphere(3, 10), icosphere(2, 10)])
    half = np.zeros((64, 64, 3), np.uint8)
    half[:, 32:, 0] = 255
    Image.fromarray(half).save(path / "half.png")
    y, x = np.mgrid[-1:1:64j, -1:1:64j]
    Image.fromarray(np.uint8(255 * (np.hypot(x, y) < 1))).save(path / "disc.png")
    return path


def scene_of(folder: Path, edits: list, **more) -> Path:
    scene = {
        "body": "sphere.qgraph",
        "material": "sigma_s_prime=3,sigma_a=.01",
        "lights": [{"type": "directional", "direction": [0, 0, -1], "irradiance": 1}],
        "edits": edits,
        "solver": {"correction": False},  # whose samples are others where a body is turned
        **more,
    }
    (folder / "scene.json").write_text(json.dumps(scene))
    return folder / "scene.json"


def solved(path: Path) -> dict:
    """Return the surface of the scene's first frame."""
    stage = core.Stage(validation=True)
    stage.show(core.SceneFile(path).at(0))
    stage.solve()
    assert stage.engine.validation_messages == []
    return {name: np.array(values) for name, values in stage.engine.surface_field().items()}


def test_light_is_missing_where_the_image_lies_in_its_mask_and_colour(folder):
    plain, edited = solved(scene_of(folder, [])), solved(scene_of(folder, [EDIT]))
    share = edited["exitance"] / plain["exitance"]
    x, y, z = plain["position"].T
    front, inside = z > 5, np.hypot(x, y) < 4
    assert share[front & inside & (x > 1.5), 0].max() < 0.4
    assert share[front & inside & (x > 1.5), 1].min() > 0.95
    assert share[front & inside & (x < -2.5), 0].min() > 0.7
    assert share[front & (np.hypot(x, y) > 8), 0].min() > 0.8
    everywhere = solved(scene_of(folder, [{**EDIT, "image": "disc.png"}]))["exitance"] / plain["exitance"]
    assert everywhere[front & inside & (x < -1.5)].max() < 0.4


def test_the_image_stays_with_the_body(folder):
    """Turned by 90 degrees about y together with its light the body gives off the same light."""
    turned = {
        "deformation": [{"type": "transform", "axis": [0, 1, 0], "degrees": 90}],
        "lights": [{"type": "directional", "direction": [-1, 0, 0], "irradiance": 1}],
    }
    rest, moved = solved(scene_of(folder, [EDIT])), solved(scene_of(folder, [EDIT], **turned))
    x, y, z = rest["position"].T
    assert np.allclose(moved["position"], np.column_stack([z, y, -x]), atol=1e-3)
    bright = rest["exitance"].max()
    assert np.abs(moved["exitance"] - rest["exitance"]).max() < 0.01 * bright  # shadow maps lie otherwise
    twisted = {"deformation": [{"type": "twist", "axis": [0, 0, 1], "degrees": 60, "range": [0, 0.9]}]}
    plain, edited = solved(scene_of(folder, [], **twisted)), solved(scene_of(folder, [EDIT], **twisted))
    share = edited["exitance"][:, 0] / plain["exitance"][:, 0]
    front = plain["position"][:, 2] > 7
    dark = plain["position"][front & (share < 0.4), :2].mean(axis=0)
    assert np.degrees(np.arctan2(dark[1], dark[0])) == pytest.approx(60, abs=12)


def test_a_scene_is_saved_with_its_images(folder, tmp_path):
    path = scene_of(folder, [EDIT])
    file = core.SceneFile(path)
    there = tmp_path / "below"
    there.mkdir()
    file.save(there / "copy.json")
    saved = json.loads((there / "copy.json").read_text())["edits"][0]
    assert (there / saved["image"]).resolve() == (folder / "half.png").resolve()
    assert saved["mask"] != EDIT["mask"]
    again = core.SceneFile(there / "copy.json").at(0)
    whole = json.loads(again.json())
    jsonschema.validate(whole, json.loads(SCHEMA.read_text()))
    assert whole["edits"][0]["placement"] == {**EDIT["placement"], "up": [0, 1, 0]}
    assert np.array_equal(solved(there / "copy.json")["exitance"], solved(path)["exitance"])


@pytest.mark.parametrize(
    ("changed", "said", "by_schema"),
    [
        ({"image": "none.png"}, "/edits/0/image: .*none.png", False),
        ({"mask": "scene.json"}, "/edits/0/mask: .*ends in .exr, .hdr or .png", False),
        ({"image": 3}, "/edits/0/image: found 3, allowed is a text", True),
        ({"placement": None}, "/edits/0/placement: found null", True),
        ({"placement": {"centre": [0, 0, 0]}}, "/edits/0/placement/size: found nothing", True),
        ({"placement": {"centre": [0, 0, 0], "size": [1, 1, 0]}}, "/edits/0/placement: size: found 0", True),
        ({"placement": {**EDIT["placement"], "up": [0, 0, 2]}}, "/edits/0/placement: up: found 0 or", False),
        ({"placement": {**EDIT["placement"], "turn": 2}}, "/edits/0/placement/turn: found 2, allowed is noth", True),
    ],
)
def test_what_cannot_be_projected_is_said(folder, changed, said, by_schema):
    edit = {**EDIT, **changed}
    path = scene_of(folder, [edit])
    with pytest.raises(InputError, match="scene.json: " + said):
        core.SceneFile(path)
    valid = jsonschema.Draft202012Validator(json.loads(SCHEMA.read_text())).is_valid(json.loads(path.read_text()))
    assert valid != by_schema
    without = {key: value for key, value in EDIT.items() if key != "placement"}
    with pytest.raises(InputError, match="/edits/0: placement: found none"):
        core.SceneFile(scene_of(folder, [without]))
