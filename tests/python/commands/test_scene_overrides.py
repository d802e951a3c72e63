"""Options beside a scene file take the place of what it says, as they say it of a body."""

from __future__ import annotations

import argparse
import json

import numpy as np
import pytest
from PIL import Image

import tiny
from quadgraph import cli
from quadgraph.commands import scene_overrides

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

SCENE = {
    "body": str(tiny.PATH),
    "material": "ketchup",
    "lights": [{"type": "ambient", "irradiance": 1}],
    "camera": {"azimuth": 30, "elevation": 20, "fov": 20},
    "solver": {"correction": False},
    "picture": {"width": 40, "height": 30, "background": "black", "exposure": 0},
}
TYPED = {
    "material": "jade",
    "light": "directional:0,0,-1:1",
    "view": "70,-10,9",
    "eye": "5,1,9",
    "look-at": "1,1,1",
    "size": "24x16",
    "background": "0.1/0.2/0.3",
    "exposure": "1.5",
    "show": "exitance",
    "up": "z",
    "fov": "40",
    "tolerance": "1%",
    "cycles": "3",
    "path-cells": "16",
    "method": "quadgraph-fv",
    "radiance": "lambertian",
}


@pytest.fixture
def scene(tmp_path):
    def write(**changes: object):
        path = tmp_path / "scene.json"
        path.write_text(json.dumps(SCENE | changes))
        return path

    return write


def render(*arguments: object) -> int:
    return cli.main(["render", *map(str, arguments), "--device", "cpu"])


def overridden(path, *arguments: str) -> dict:
    """The scene that is shown with these arguments."""
    commands = {"render": cli.importlib.import_module("quadgraph.commands.render")}
    args = cli.build_parser(commands, {}).parse_args(["render", str(path), "-o", "a.png", *arguments])
    file = _core.SceneFile(path)
    scene_overrides.apply(file, json.loads(path.read_text()), args)
    return json.loads(file.at(0).json())


def pixels(path) -> np.ndarray:
    with Image.open(path) as image:
        return np.asarray(image).astype(int)


def test_a_scene_with_options_is_the_body_with_the_same_ones(scene, tmp_path):
    options = ["--material", "skin1", "--light", "directional:0,-0.2,-1:1", "--view", "40,5", "--size", "48x32"]
    options += ["--background", "white", "--exposure", "auto", "--no-correction", "--fov", "30"]
    assert render(scene(), *options, "-o", tmp_path / "scene.png") == 0
    assert render(tiny.PATH, *options, "-o", tmp_path / "body.png") == 0
    np.testing.assert_array_equal(pixels(tmp_path / "scene.png"), pixels(tmp_path / "body.png"))


def test_what_is_typed_counts_even_where_it_is_the_default(scene):
    path = scene()
    assert overridden(path)["material"] == "ketchup"
    assert overridden(path, "--material", "marble")["material"] == "marble"
    assert (
        overridden(path, "--background", "studio")["picture"]["background"]
        == (json.loads(_core.Scene(tiny.PATH).json())["picture"]["background"])
    )
    assert overridden(path, "--correction")["solver"]["correction"] is True


@pytest.mark.parametrize("name", [name for name in TYPED if name != "look-at"])
def test_every_option_reaches_its_member_and_no_other(scene, name):
    path = scene()
    typed = [f"--{name}={TYPED[name]}", *([f"--look-at={TYPED['look-at']}"] if name == "eye" else [])]
    before, after = overridden(path), overridden(path, *typed)
    changed = {f"/{member}" for member in after if before.get(member) != after[member]}
    option = next(each for each in _core.scene_options() if each.name == name and each.on_command_line)
    assert changed == {"/" + option.member.split("/")[1]}
    text = json.dumps(after)
    assert {"view": '"azimuth": 70', "eye": '"eye": [5', "size": '"width": 24'}.get(name, "") in text
    if name == "view":
        assert (after["camera"]["distance"], after["camera"]["fov"]) == (9, 20)


def test_all_options_of_own_forms_are_known():
    own = {option.name for option in _core.scene_options() if option.own_form and option.on_command_line}
    assert set(scene_overrides.OWN_FORMS) == own


def test_a_view_takes_the_place_of_an_eye_and_an_eye_that_of_angles(scene):
    path = scene(camera={"eye": [0, 0, 9], "look_at": [1, 1, 1], "fov": 25})
    camera = overridden(path, "--view", "10,20")["camera"]
    assert "eye" not in camera
    assert (camera["azimuth"], camera["fov"]) == (10, 25)
    camera = overridden(scene(), "--eye", "0,0,9", "--look-at", "1,1,1")["camera"]
    assert camera["eye"] == [0, 0, 9]


def test_tracks_of_what_is_typed_are_left_out_and_others_stay(scene, tmp_path):
    tracks = [
        {"path": "/camera/azimuth", "keys": [[0, 0], [3, 90]]},
        {"path": "/lights/0/irradiance", "keys": [[0, 1], [3, 2]]},
    ]
    path = scene(tracks=tracks)
    args = argparse.Namespace(view="5,6", given={"view"})
    file = _core.SceneFile(path)
    scene_overrides.apply(file, json.loads(path.read_text()), args)
    last = json.loads(file.at(3).json())
    assert last["camera"]["azimuth"] == 5
    assert last["lights"][0]["irradiance"] == 2
    assert file.frames == 4


def test_a_track_of_a_whole_member_is_not_guessed_at(scene, tmp_path, capsys):
    path = scene(tracks=[{"path": "/camera", "keys": [[0, {"fov": 20}]], "between": "step"}])
    assert render(path, "--fov", "30", "-o", tmp_path / "a.png") == 1
    assert "a track of the scene changes all of /camera" in capsys.readouterr().err
    assert not (tmp_path / "a.png").exists()


def test_files_that_are_typed_are_those_of_the_working_directory(scene, tmp_path, monkeypatch):
    path = scene()
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    monkeypatch.chdir(elsewhere)
    grid = np.ones((2, 2, 2))
    np.savez("even.npz", sigma_s_prime=2 * grid, sigma_a=0.05 * grid, spacing=1)
    Image.new("RGB", (4, 4), "white").save("a.png")
    shown = overridden(path, "--material", "even.npz", "--light", "projector:0,0,9:0,0,-1:20:a.png:1")
    assert shown["material"] == str(elsewhere / "even.npz")
    assert shown["lights"][0]["file"] == str(elsewhere / "a.png")


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--size", "40"], "--size: found '40', expected WIDTHxHEIGHT"),
        (["--view", "a"], "--view: found 'a', expected 2 or 3 finite numbers"),
        (["--eye", "0,0,inf", "--look-at", "0,0,0"], "--eye: found '0,0,inf', expected 3 finite numbers"),
        (["--height", "2cm"], "--height: not beside a scene file, whose /body is a baked .qgraph"),
        (["--material", "marbel"], "(did you mean 'marble'?)"),
        (["--eye", "0,0,9"], "look_at"),
        (["--light", "spot:1"], "light 'spot:1'"),
    ],
)
def test_what_does_not_fit_is_said(scene, tmp_path, capsys, options, said):
    assert render(scene(), *options, "-o", tmp_path / "a.png") == 1
    captured = capsys.readouterr()
    assert said in captured.err
    assert captured.err.count("\n") == 1
    assert not (tmp_path / "a.png").exists()


def test_set_has_the_last_word(scene, tmp_path):
    out = tmp_path / "a.png"
    assert render(scene(), "--size", "24x16", "--set", "/picture/width=20", "-o", out) == 0
    assert pixels(out).shape == (16, 20, 3)
