"""`quadgraph turntable`: what turns, where it stands in each frame, and its films."""

from __future__ import annotations

import argparse
import json
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from PIL import Image

import tiny
from quadgraph import cli
from quadgraph.base import atomic_file
from quadgraph.base.errors import InputError
from quadgraph.commands import turning

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

FAST = ["--no-correction", "--size", "48x32", "--device", "cpu"]


@pytest.fixture(scope="module")
def engine():
    engine = _core.Engine(tiny.PATH, device="cpu")
    engine.set_material("marble")
    engine.set_lights(["directional:0.4,-0.3,-1:1"])
    engine.solve(correction=False)
    return engine


def turntable(*arguments: object) -> int:
    return cli.main(["turntable", str(tiny.PATH), *FAST, *map(str, arguments)])


@pytest.mark.parametrize("up", ["y", "z"])
def test_an_eye_and_an_azimuth_turn_the_same_way(engine, up):
    """Seen from an eye that has turned by an angle is what is seen from an azimuth that is so much larger."""
    middle = turning.middle(engine)
    np.testing.assert_allclose(middle, [1, 1, 1])
    towards = np.array([0, 0, 9.0]) if up == "y" else np.array([0, -9.0, 0])
    texts = [",".join(map(str, place)) for place in (middle + towards, middle)]
    by_eye = argparse.Namespace(eye=texts[0], look_at=texts[1], view=None, up=up)
    by_angle = argparse.Namespace(eye=None, look_at=None, view="0,0,9", up=up)
    for degrees in (0, 50, 200):
        eye = turning.view(by_eye, engine, degrees) | {"look_at": texts[1]}
        pictures = [
            engine.render(size="40x40", up=up, **seen) for seen in (eye, turning.view(by_angle, engine, degrees))
        ]
        np.testing.assert_allclose(pictures[0].alpha, pictures[1].alpha, atol=1e-6)
        np.testing.assert_allclose(pictures[0].scattered, pictures[1].scattered, rtol=0.01, atol=1e-4)


def test_every_kind_of_light_goes_around():
    values = {"direction": [0, 0, -1], "point": [0, 0, 9], "edge": [1, 0, 0], "top": [0, 1, 0], "axis": "y"}
    values |= {"number": 1, "turn": 20, "file": "a.png", "power": [1, 2, 3]}
    for kind in _core.light_kinds():
        light = {"type": kind.name, **{field.name: values[field.form] for field in kind.fields}}
        light |= {"v": [0, 1, 0]} if kind.name == "rectangle" else {}
        text = _core.light_text(json.dumps(light))
        (quarter,) = turning.lights([text], "y", 90, np.array([0, 0, 1.0]))
        found = json.loads(_core.light_json(quarter))
        expected = {"direction": [-1, 0, 0], "point": [8, 0, 1], "edge": [0, 0, -1], "top": [0, 1, 0], "turn": 110}
        for field in kind.fields:
            wanted = expected.get(field.form, light[field.name]) if field.name != "v" else light["v"]
            if isinstance(wanted, str):
                assert found[field.name] == wanted
            else:
                np.testing.assert_allclose(found[field.name], wanted, atol=1e-6)
        (whole,) = turning.lights([text], "y", 360, np.array([0, 0, 1.0]))
        assert json.loads(_core.light_json(whole))["type"] == kind.name
    with pytest.raises(InputError, match="its up is z, so that --up z is wanted"):
        turning.lights(["environment:a.hdr:0,z:1"], "y", 90, np.zeros(3))


def test_lights_turn_as_the_camera_does(engine):
    """Light from behind the camera, both turned alike, lights the face that is seen, from all sides."""
    args = argparse.Namespace(eye=None, look_at=None, view="0,0", up="y")
    brightness = []
    for degrees in (0, 90, 180, 270):
        engine.set_lights(turning.lights(["directional:0,0,-1:1"], "y", degrees, turning.middle(engine)))
        engine.solve(correction=False)
        picture = engine.render(size="16x16", **turning.view(args, engine, degrees))
        brightness.append(picture.scattered[8, 8, 1])
    assert np.ptp(brightness) < 0.3 * np.mean(brightness)


def test_films_and_pictures_of_a_turn(tmp_path, capsys):
    gif, report = tmp_path / "a.gif", tmp_path / "report.json"
    outputs = ["-o", gif, "-o", tmp_path / "f" / "%02d.png", "-o", tmp_path / "f" / "%02d.exr", "--json", report]
    assert turntable("--frames", 4, "--seconds", 2, "--light", "lamps", *outputs) == 0
    said = capsys.readouterr().out
    assert "frames: 4, made in" in said
    assert f"film: {gif}" in said
    names = [f"{number:02d}.{suffix}" for number in range(4) for suffix in ("exr", "png")]
    assert sorted(path.name for path in (tmp_path / "f").iterdir()) == names
    frames = json.loads(report.read_text())
    assert [frame["frame"] for frame in frames] == [0, 1, 2, 3]
    assert len({frame["algebraic"]["whole"] for frame in frames}) == 1  # solved once: the light stays
    with Image.open(gif) as image:
        assert (image.n_frames, image.size) == (4, (48, 32))
        assert image.info["duration"] == 500
    pictures = [_core.read_image(tmp_path / "f" / f"{number:02d}.exr").sum() for number in range(4)]
    assert max(pictures) > 1.3 * min(pictures)


def test_a_film_has_its_rate(tmp_path):
    av = pytest.importorskip("av")
    assert turntable("--frames", 3, "--seconds", 0.25, "--turn", "body", "-o", tmp_path / "a.mp4") == 0
    with av.open(tmp_path / "a.mp4") as container:
        stream = container.streams.video[0]
        assert stream.average_rate == 12
        assert len(list(container.decode(stream))) == 3


def test_a_light_that_turns_is_solved_for_in_every_frame(tmp_path):
    report = tmp_path / "report.json"
    light = ["--light", "directional:0,0,-1:1", "--turn", "light", "--exposure", "0"]
    assert turntable("--frames", 2, *light, "-o", tmp_path / "%d.exr", "--json", report) == 0
    lit, unlit = (_core.read_image(tmp_path / f"{number}.exr").sum() for number in range(2))
    assert lit > 2 * unlit
    assert len({str(frame["energy"]) for frame in json.loads(report.read_text())}) == 2


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["-o", "a.gif", "--size", "40"], "--size: found '40', expected WIDTHxHEIGHT"),
        (["-o", "a.gif", "--view", "a,b"], "view, azimuth: found 'a', expected a finite number"),
        (["-o", "a.gif", "--eye", "1,2"], "eye"),
        (["-o", "a.gif", "--view", "1e39,0"], "view, azimuth: found inf"),
        (["-o", "a.gif", "--method", "shortest-path", "--show", "exitance"], "show: with shortest-path only 'picture'"),
        (["-o", "a.mp4", "--size", "0x4"], "--size: found '0x4', expected WIDTHxHEIGHT, 1 to"),
        (["-o", "a.mp4", "--seconds", "1e-300"], "--seconds: found 1e-300 for 48 frames, which is 4.8e+301 a second"),
        (["-o", "a.mp4", "--seconds", "1e300"], "allowed are 0.1 to 1000"),
        (["-o", "a.png"], "a.png: a number, e.g. %04d, in the name of every frame is wanted"),
        (["-o", "a.avi"], "a.avi: output must end in .png, .jpg, .jpeg, .exr, .mp4, .webm or .gif"),
        (["-o", "a.gif", "--seconds", "0.1"], "a.gif: found 480 frames a second, a .gif has at most 50"),
        (["-o", "a.mp4", "--size", "33x32"], "a film needs an even width and height, found 33x32"),
        (["-o", "a.gif", "--background", "transparent"], "a.gif: background 'transparent' found"),
        (["-o", "a.gif", "--frames", "10000000"], "--frames: found 10000000, allowed are 1 to 1000000"),
        (["-o", "a.gif", "--light", "environment:a.hdr:0,z:1"], "a.hdr"),
    ],
)
def test_what_cannot_be_made_is_said(arguments, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert turntable(*arguments) == 1
    captured = capsys.readouterr()
    assert said in captured.err
    assert captured.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("turns", ["camera", "body", "light"])
@pytest.mark.parametrize("camera", [{"azimuth": 30, "elevation": 10}, {"eye": [9, 5, 12], "look_at": [1, 1, 1]}])
def test_a_scene_turns_as_the_body_with_its_options_does(tmp_path, turns, camera):
    lights = ["directional:0.4,-0.3,-1:1", "point:4,5,6:3"]
    stated = [json.loads(_core.light_json(light)) for light in lights]
    picture = {"exposure": 0, "samples": 4, "ground": False}
    document = {"body": str(tiny.PATH), "material": "jade", "lights": stated, "camera": camera, "picture": picture}
    scene = tmp_path / "scene.json"
    scene.write_text(json.dumps(document))
    report = tmp_path / "report.json"
    turn = ["--turn", turns, "--frames", "3"]
    outputs = ["-o", f"{tmp_path}/scene/%d.exr", "--json", str(report)]
    assert cli.main(["turntable", str(scene), *FAST, *turn, *outputs]) == 0
    view = ["--view", "30,10"]
    if "eye" in camera:
        view = [word for name in camera for word in (f"--{name.replace('_', '-')}", ",".join(map(str, camera[name])))]
    same = ["--material", "jade", "--exposure", 0, "--samples", 4, *view]
    same += [word for light in lights for word in ("--light", light)]
    assert turntable(*same, *turn, "-o", tmp_path / "body" / "%d.exr") == 0
    seen = [[_core.read_image(tmp_path / of / f"{k}.exr") for k in range(3)] for of in ("scene", "body")]
    np.testing.assert_allclose(seen[0], seen[1], rtol=1e-4, atol=1e-5)
    assert not np.allclose(seen[0][0], seen[0][1], rtol=0.05)
    solves = len({str(frame["energy"]) for frame in json.loads(report.read_text())})
    assert (solves == 1) == (turns == "camera")


def test_a_scene_has_one_exposure_for_all_frames(tmp_path):
    scene = tmp_path / "scene.json"
    lights = [{"type": "directional", "direction": [0, 0, -1], "irradiance": 1}]
    picture = {"width": 32, "height": 32, "samples": 4, "background": "black", "ground": False}
    scene.write_text(json.dumps({"body": str(tiny.PATH), "lights": lights, "picture": picture}))
    words = ["--no-correction", "--device", "cpu", "--frames", "2"]
    assert cli.main(["turntable", str(scene), *words, "-o", f"{tmp_path}/%d.png", "-o", f"{tmp_path}/%d.exr"]) == 0
    shown, light = (
        [_core.read_image(tmp_path / f"{k}.{suffix}")[..., :3].sum() for k in range(2)] for suffix in ("png", "exr")
    )
    assert light[0] > 2 * light[1]
    assert shown[0] > 1.5 * shown[1]  # by an exposure of its own, the dim side would be as bright


def test_how_far_it_is_is_said_after_each_frame(tmp_path, monkeypatch):
    said = []
    monkeypatch.setattr(atomic_file, "write_json", lambda path, value: said.append((path, value)))
    progress = tmp_path / "progress.json"
    assert turntable("--frames", 3, "-o", tmp_path / "a.gif", "--progress", progress) == 0
    assert [(path, value["done"], value["frames"]) for path, value in said] == [(progress, k, 3) for k in range(4)]
    left = [value["seconds_left"] for _, value in said]
    assert left[:2] == [None, None]
    assert left[2] > 0
    assert left[3] == 0


def test_frames_of_a_scene_say_how_far_they_are(tmp_path):
    scene, progress = tmp_path / "a.json", tmp_path / "progress.json"
    scene.write_text(json.dumps({"body": str(tiny.PATH), "frames": 2}))
    words = ["render", str(scene), *FAST, "-o", str(tmp_path / "a.gif"), "--progress", str(progress)]
    assert cli.main([*words, "--frames"]) == 0
    assert json.loads(progress.read_text()) == {"done": 2, "frames": 2, "seconds_left": 0}
    assert cli.main([*words, "--frames", "--scheduler", "processes:1"]) == 1


@pytest.mark.parametrize("name", ["a.gif", "a.mp4"])
def test_one_that_is_interrupted_leaves_nothing(tmp_path, name):
    if name.endswith("mp4"):
        pytest.importorskip("av")
    command = [sys.executable, "-m", "quadgraph.cli", "turntable", str(tiny.PATH), "--frames", "5000", *FAST]
    process = subprocess.Popen(
        [*command, "-o", str(tmp_path / name)],
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    until = time.monotonic() + 60
    while not list(tmp_path.iterdir()) and time.monotonic() < until:
        time.sleep(0.05)
    assert list(tmp_path.iterdir())
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "interrupted" in said
    assert "Traceback" not in said
    assert list(tmp_path.iterdir()) == []
