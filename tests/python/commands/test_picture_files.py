"""Kinds of picture files: JPEG, and PNG that is transparent where there is no body."""

from __future__ import annotations

import json
import subprocess

import numpy as np
import pytest
from PIL import Image

import tiny
from engine_program import ENGINE
from quadgraph import InputError, cli
from quadgraph.base import image_file

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

FAST = ["--no-correction", "--size", "48x48", "--device", "cpu"]


def render(*arguments: object) -> int:
    return cli.main(["render", str(tiny.PATH), *FAST, *map(str, arguments)])


def pixels(path) -> np.ndarray:
    with Image.open(path) as image:
        return np.asarray(image).astype(int)


def linear(codes: np.ndarray) -> np.ndarray:
    """Display colour of sRGB codes."""
    share = codes / 255
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


def test_a_transparent_png_laid_over_white_is_the_picture_on_white(tmp_path):
    clear, white = tmp_path / "clear.png", tmp_path / "white.png"
    # Channels differ in what they let through at rough edges, as one alpha cannot.
    smooth = ("--transmission-roughness", 0)
    assert render("--background", "transparent", "-o", clear, *smooth) == 0
    assert render("--background", "white", "-o", white, *smooth) == 0
    rgba, rgb = pixels(clear), pixels(white)
    assert rgba.shape == (48, 48, 4)
    assert rgba[0, 0].tolist() == [0, 0, 0, 0]
    assert rgba[24, 24, 3] > 245  # a little is seen through 2 mm
    alpha = rgba[..., 3:] / 255
    laid = linear(rgba[..., :3]) * alpha + (1 - alpha)
    assert np.abs(laid - linear(rgb)).max() < 0.02


def test_surroundings_are_left_out_of_a_transparent_picture(tmp_path):
    sky = tmp_path / "sky.hdr"
    sky.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n" + bytes([128, 128, 128, 129]) * 8)
    out = tmp_path / "a.png"
    assert render("--light", f"environment:{sky}:0:1", "--surroundings", "--background", "transparent", "-o", out) == 0
    assert pixels(out)[0, 0].tolist() == [0, 0, 0, 0]


@pytest.mark.parametrize("name", ["a.jpg", "a.JPEG"])
def test_a_jpeg_is_the_picture_with_what_made_it_in_its_comment(tmp_path, name):
    jpeg, png = tmp_path / name, tmp_path / "a.png"
    assert render("-o", jpeg, "-o", png) == 0
    with Image.open(jpeg) as image:
        assert image.format == "JPEG"
        assert "material: marble" in image.info["comment"].decode()
    assert np.abs(pixels(jpeg) - pixels(png)).mean() < 2


def test_what_has_no_transparency_is_refused_before_any_work(tmp_path, capsys):
    scene = tmp_path / "scene.json"
    scene.write_text(json.dumps({"body": str(tiny.PATH), "picture": {"background": "transparent"}}))
    out = tmp_path / "a.jpg"
    for command in (["render", str(tiny.PATH), "--background", "transparent"], ["render", str(scene)]):
        assert cli.main([*command, "-o", str(out)]) == 1
        assert f"{out}: background 'transparent' found" in capsys.readouterr().err
    assert cli.main(["render", str(scene), "--frames", "1", "-o", str(tmp_path / "a.mp4")]) == 1
    assert "transparent" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == [scene]


@pytest.mark.parametrize("command", ["render", "render scene", "sheet", "solve", "bench", "accuracy", "program"])
def test_a_file_in_a_folder_that_is_not_there_is_refused_before_any_work(command, tmp_path, capsys):
    """Before the body is read, which is none: what it is would be said otherwise."""
    missing, body, scene = tmp_path / "none", tmp_path / "body.qgraph", tmp_path / "scene.json"
    body.write_bytes(b"no body")
    scene.write_text(json.dumps({"body": "body.qgraph"}))
    asked = {
        "render": ["render", body, "-o", missing / "a.png"],
        "render scene": ["render", scene, "-o", missing / "a.png"],
        "sheet": ["sheet", body, "--material", "jade", "-o", missing / "a.png"],
        "solve": ["solve", body, "--json", missing / "a.json"],
        "bench": ["bench", body, "--json", missing / "a.json"],
        "accuracy": ["accuracy", "orders", "--json", missing / "a.json"],
        "program": [body, "--headless", "-o", missing / "a.png"],
    }[command]
    if command == "program":
        done = subprocess.run([str(ENGINE), *map(str, asked)], capture_output=True, text=True, timeout=60)
        status, said = done.returncode, done.stderr
    else:
        status, said = cli.main(list(map(str, asked))), capsys.readouterr().err
    assert status == 1
    assert f"the folder {missing} does not exist" in " ".join(said.split())
    assert not missing.exists()


def test_scenes_write_jpeg_frames_and_transparent_stills(tmp_path):
    scene = tmp_path / "scene.json"
    picture = {"width": 32, "height": 32, "background": "transparent"}
    scene.write_text(json.dumps({"body": str(tiny.PATH), "solver": {"correction": False}, "picture": picture}))
    assert cli.main(["render", str(scene), "-o", str(tmp_path / "a.png")]) == 0
    assert pixels(tmp_path / "a.png")[0, 0].tolist() == [0, 0, 0, 0]
    frames = ["--frames", "1", "--set", "/picture/background=black", "-o", str(tmp_path / "%02d.jpg")]
    assert cli.main(["render", str(scene), *frames]) == 0
    assert pixels(tmp_path / "00.jpg").shape == (32, 32, 3)


def test_a_transparent_background_is_a_value_of_a_scene():
    file = _core.SceneFile(_core.Scene(tiny.PATH))
    file.set("/picture/background", "transparent")
    assert json.loads(file.at(0).json())["picture"]["background"] == "transparent"
    file.set("/picture/background", '{"top": 0.5, "bottom": 0}')
    assert json.loads(file.at(0).json())["picture"]["background"] == {"top": 0.5, "bottom": 0}
    with pytest.raises(InputError, match='/picture/background/bottom: found "transparent"'):
        file.set("/picture/background", '{"top": 0.5, "bottom": "transparent"}')


def test_a_picture_that_cannot_be_written_leaves_nothing(tmp_path):
    grey = np.full((4, 4, 3), 128, np.uint8)
    with pytest.raises(InputError, match="cannot be written"):
        image_file.write(tmp_path / "absent" / "a.jpg", grey)
    with pytest.raises(InputError, match=r"output must end in \.png, \.jpg or \.jpeg"):
        image_file.write(tmp_path / "a.bmp", grey)
    assert list(tmp_path.iterdir()) == []
