"""quadgraph-engine, run as a program: pictures without a display, and mistakes told in one line."""

from __future__ import annotations

import json
import os
import struct
import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import tiny
from engine_program import ENGINE, assert_refused
from quadgraph.cli import main

pytestmark = pytest.mark.skipif(ENGINE is None, reason="quadgraph-engine is not built: run tools/setup")


def run(*arguments: object) -> subprocess.CompletedProcess:
    """The program with no display to talk to."""
    environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    return subprocess.run(
        [ENGINE, *map(str, arguments)], env=environment, capture_output=True, text=True, timeout=60, check=False
    )


def test_png_without_display(tmp_path: Path):
    path = tmp_path / "cube.png"
    result = run(tiny.PATH, "--headless", "-o", path, "--size", "120x80", "--validation")
    assert result.returncode == 0, result.stderr
    assert result.stderr == ""
    assert [p.name for p in tmp_path.iterdir()] == ["cube.png"]
    with Image.open(path) as image:
        assert image.size == (120, 80)
        assert image.info["material"] == "marble"
        assert image.info["units"] == "W/(mm^2 sr)"
        assert "stops" in image.info["exposure"]
        pixels = np.asarray(image)
    assert pixels[40, 60].max() > pixels[0, 0].max() + 20


def test_same_input_same_bytes(tmp_path: Path):
    for name in ("a.png", "b.png"):
        assert run(tiny.PATH, "--headless", "-o", tmp_path / name, "--size", "64x64").returncode == 0
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_exr_and_json(tmp_path: Path):
    path = tmp_path / "cube.exr"
    light, material = "directional:0,0,-1:1/2/3", "sigma_s_prime=1,sigma_a=0.1,eta=1"
    result = run(
        "--headless", "-o", path, "--json", "--method", "quadgraph-fdm", "--material", material,
        "--size", "64x64", "--view", "-30,-20,9", "--light", light, "--light", "point:1,1,50:0", tiny.PATH,
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    assert struct.unpack("<I", path.read_bytes()[:4]) == (20000630,)  # OpenEXR's magic number
    report = json.loads(result.stdout)
    assert report["solve"]["method"] == "quadgraph-fdm"
    assert report["solve"]["energy"]["entered_W"] == pytest.approx([4, 8, 12], rel=1e-4)  # a face of 4 mm^2
    assert report["metadata"]["lights"] == light + " point:1,1,50:0"
    assert report["metadata"]["camera"].startswith("view -30,-20,9,")
    assert {"shadow maps", "irradiance", "visibility", "shading"} <= {entry["name"] for entry in report["passes"]}
    assert report["device_bytes"]["peak"] >= report["device_bytes"]["now"] > 0
    assert report["wall_ms"]["total"] > 0


def test_without_display_it_says_what_to_do():
    assert_refused(run(tiny.PATH), "no display", "--headless")


def test_view_without_display_says_it_too(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    assert main(["view", str(tiny.PATH), "--material", "skin1"]) == 1
    assert "--headless" in capfd.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["-o", "x.jpg"], ["x.jpg", ".png", ".exr"]),
        ([], [".png", ".exr"]),
        (["-o", "x.png", "--light", "spot:1"], ["spot:1", "directional:DX,DY,DZ:IRRADIANCE"]),
        (["-o", "x.png", "--material", "granite"], ["granite", "marble"]),
        (["-o", "x.png", "--view", "10"], ["'10'", "azimuth,elevation"]),
        (["-o", "x.png", "--size", "10"], ["'10'", "WIDTHxHEIGHT"]),
        (["-o", "x.png", "--size", "0x10"], ["0x10"]),
        (["-o", "x.png", "--solver", "magic"], ["magic", "dpcg"]),
        (["-o", "x.png", "--device", "no such device"], ["no such device"]),
        (["-o", "x.png", "--no-such-option"], ["--no-such-option", "--help"]),
        (["-o", "/no/such/folder/x.png", "--size", "16x16"], ["/no/such/folder/x.png"]),
    ],
)
def test_mistakes_are_told_in_one_line(tmp_path: Path, monkeypatch, arguments: list[str], words: list[str]):
    monkeypatch.chdir(tmp_path)
    assert_refused(run(tiny.PATH, "--headless", *arguments), *words)
    assert list(tmp_path.iterdir()) == []


def test_a_damaged_file_is_named(tmp_path: Path):
    damaged = tmp_path / "damaged.qgraph"
    damaged.write_bytes(tiny.PATH.read_bytes()[:-64])
    assert_refused(run(damaged, "--headless", "-o", tmp_path / "x.png"), "damaged.qgraph")


def test_help_lists_units():
    result = run("--help")
    assert result.returncode == 0
    for word in ("W/mm^2", "degrees", "--headless", "--exposure", "--tolerance"):
        assert word in result.stdout


EDIT = {
    "operation": "add",
    "sigma_a": [0.5, 0.5, 0.5],
    "image": "edit.png",
    "mask": "mask.png",
    "placement": {"centre": [1, 1, 2], "direction": [0, 0, -1], "size": [2, 2, 1]},
}
PROJECTOR = {"type": "projector", "position": [1, 1, 50], "direction": [0, 0, -1], "angle": 20, "power": 1}


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    """A scene that reads a body and four images, all in the test's folder."""
    for name in ("edit.png", "mask.png", "light.png", "rough.png"):
        Image.new("RGB", (4, 4), "white").save(tmp_path / name)
    (tmp_path / "body.qgraph").write_bytes(tiny.PATH.read_bytes())
    document = {
        "quadgraph_scene": 1,
        "body": "body.qgraph",
        "edits": [EDIT],
        "lights": [{**PROJECTOR, "file": "light.png"}],
        "picture": {"roughness_map": {"image": "rough.png", "placement": EDIT["placement"]}},
    }
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(document))
    return path


@pytest.mark.parametrize("read", ["edit.png", "mask.png", "light.png", "rough.png"])
def test_a_picture_replaces_nothing_that_the_scene_reads(scene: Path, read: str):
    before = (scene.parent / read).read_bytes()
    for name in (scene.parent / read, scene.parent / ".." / scene.parent.name / read):
        assert_refused(run(scene, "--headless", "-o", name), read, "is read", "give the output another name")
    os.link(scene.parent / read, scene.parent / "hard.png")
    assert_refused(run(scene, "--headless", "-o", scene.parent / "hard.png"), "hard.png: is read", read)
    assert (scene.parent / read).read_bytes() == before
    result = run(scene, "--headless", "-o", scene.parent / "new.png", "--size", "32x32")
    assert result.returncode == 0, result.stderr


def test_a_picture_replaces_no_body_and_no_scene(scene: Path):
    for read in ("body.qgraph", "scene.json"):
        os.link(scene.parent / read, scene.parent / f"{read}.png")
        result = run(scene, "--headless", "-o", scene.parent / f"{read}.png")
        assert_refused(result, f"{read}.png: is read", "give the output another name")


def test_a_picture_replaces_regular_files_alone_and_says_so_before_work(scene: Path):
    (scene.parent / "link.png").symlink_to(scene.parent / "elsewhere.png")
    (scene.parent / "folder.png").mkdir()
    os.mkfifo(scene.parent / "pipe.png")
    for name, what in {"link.png": "a link", "folder.png": "a folder", "pipe.png": "no regular file"}.items():
        result = run(scene, "--headless", "-o", scene.parent / name, "--device", "no such device")
        assert_refused(result, f"{name}: is {what}", "allowed is a regular file or a new name")
