"""The studio that is built in: on command lines, in scene files wherever they lie, and in Python."""

from __future__ import annotations

import json
import shutil

import numpy as np
import pytest

import quadgraph
import tiny
from quadgraph import cli

SMALL = {"width": 24, "height": 24, "samples": 4}


def picture(light: str, view: str) -> quadgraph.Picture:
    with quadgraph.Engine(tiny.PATH, device="cpu") as engine:
        engine.set_light_roughness(None)
        engine.material = "milk"
        engine.lights = [light]
        engine.solve()
        return engine.render(view, surroundings=True, **SMALL)


@pytest.fixture(scope="module")
def shown():
    return picture("studio", "0,10")


def test_it_lights_the_body_and_is_seen_around_it(shown):
    assert shown.scattered.sum() > 0
    assert shown.specular.sum() > 0
    around = shown.surroundings[0].mean(axis=-1)
    assert around.max() > 2 * around.min()


def test_it_turns_with_the_view(shown):
    turned = picture("environment:studio:40:0.0002", "40,10")
    assert np.allclose(turned.surroundings, shown.surroundings, rtol=0.01)
    assert not np.allclose(picture("studio", "40,10").surroundings, shown.surroundings, rtol=0.01)


def test_a_command_line_turns_it_with_the_view(tmp_path):
    fast = ["--size", "24x24", "--samples", "4", "--device", "cpu", "--view", "40,10", "--surroundings"]
    for name, light in (("a", "studio"), ("b", "environment:studio:40:0.0002")):
        told = [str(tiny.PATH), "--material", "milk", "--light", light, *fast, "-o", str(tmp_path / f"{name}.png")]
        assert cli.main(["render", *told]) == 0
    assert np.array_equal(pixels(tmp_path / "a.png"), pixels(tmp_path / "b.png"))


def test_a_picture_that_nobody_lit_has_it_and_the_ground(tmp_path):
    fast = ["--size", "24x24", "--samples", "4", "--device", "cpu", "--view", "40,10"]
    for name, told in (("a", []), ("b", ["--light", "studio", "--ground"]), ("c", ["--light", "studio"])):
        told = [str(tiny.PATH), "--material", "milk", *told, *fast, "-o", str(tmp_path / f"{name}.png")]
        assert cli.main(["render", *told]) == 0
    assert np.array_equal(pixels(tmp_path / "a.png"), pixels(tmp_path / "b.png"))
    assert not np.array_equal(pixels(tmp_path / "a.png"), pixels(tmp_path / "c.png"))


def test_lamps_are_the_lights_of_solves_and_have_no_ground():
    lamps, ground = quadgraph.core.picture_light(["lamps"], view="40,10")
    assert lamps == quadgraph.core.default_lights("40,10")
    assert not ground
    studio, ground = quadgraph.core.picture_light([], view="40,10")
    assert studio == ["environment:studio:40,y:2e-04"]
    assert ground
    assert quadgraph.core.picture_light([], ground=False)[1] is False


def test_the_ground_gets_the_light_of_the_body():
    """Its colour is that of what leaves the body, which no light from beside colours."""
    with quadgraph.Engine(tiny.PATH, device="cpu") as engine:
        engine.material = "sigma_s_prime=2,sigma_a=.01/.3/1,eta=1.3"
        engine.lights = ["ambient:1"]
        engine.solve()
        small = {"width": 48, "height": 48, "samples": 4}
        plain, standing = (engine.render("0,20", ground=ground, **small) for ground in (False, True))
    beside = (plain.alpha == 0) & (standing.alpha > 0.05)
    light = standing.scattered[beside].sum(axis=0)
    assert beside.sum() > 50
    assert light[0] > 1.3 * light[1] > 1.3 * light[2] > 0
    assert standing.alpha.max() <= 1
    assert (standing.alpha[beside] <= 0.9 + 1e-6).all()
    covered = plain.alpha == 1
    assert np.array_equal(standing.scattered[covered], plain.scattered[covered])


def test_a_scene_names_it_as_no_file_of_its_folder(shown, tmp_path):
    shutil.copy(tiny.PATH, tmp_path / "a.qgraph")
    scene = {
        "body": "a.qgraph",
        "material": "milk",
        "lights": [{"type": "environment", "file": "studio", "turn": 0, "radiance": 0.0002}],
        "camera": {"azimuth": 0, "elevation": 10},
        "picture": {**SMALL, "surroundings": True},
    }
    (tmp_path / "scene.json").write_text(json.dumps(scene))
    assert quadgraph.SceneFile(tmp_path / "scene.json").at(0).to_dict()["lights"][0]["file"] == "studio"
    assert cli.main(["render", str(tmp_path / "scene.json"), "--device", "cpu", "-o", str(tmp_path / "a.png")]) == 0
    told = [str(tiny.PATH), "--material", "milk", "--light", "studio", "--view", "0,10", "--surroundings"]
    fast = ["--size", "24x24", "--samples", "4", "--device", "cpu"]
    assert cli.main(["render", *told, *fast, "-o", str(tmp_path / "b.png")]) == 0
    shown.save(tmp_path / "c.png")
    from_scene, from_text, from_python = (pixels(tmp_path / f"{name}.png") for name in "abc")
    assert np.array_equal(from_scene, from_python)
    assert np.array_equal(from_text, from_python)


def pixels(path):
    from PIL import Image

    with Image.open(path) as image:
        return np.asarray(image)
