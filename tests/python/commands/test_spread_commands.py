"""Commands that spread many runs over workers: the same files as one after the other."""

from __future__ import annotations

import json

import pytest
from PIL import Image, ImageSequence

import tiny
from quadgraph import cli
from shapes import icosphere, write_obj

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

TWO = ["--scheduler", "processes:2"]


@pytest.fixture
def meshes(tmp_path):
    folder = tmp_path / "meshes"
    folder.mkdir()
    for name, radius in (("large", 3.0), ("small", 2.0)):
        write_obj(icosphere(1, radius), folder / f"{name}.obj")
    return folder


def bake(*arguments: object) -> int:
    return cli.main(["bake", *map(str, arguments), "--unit", "mm", "--levels", "1", "--visibility-rays", "0"])


def test_a_folder_is_baked_as_its_meshes_are(meshes, tmp_path, capsys):
    """One that cannot be baked leaves the others, which are not baked again."""
    out = tmp_path / "out"
    (meshes / "broken.obj").write_text("v 0 0\n")
    assert bake(meshes, "-o", out, *TWO) == 1
    said = capsys.readouterr().err
    assert "bake large: done" in said
    assert "1 of 3 failed: bake broken: " in said
    assert bake(meshes / "small.obj", "-o", tmp_path / "alone.qgraph") == 0
    assert (out / "small.qgraph").read_bytes() == (tmp_path / "alone.qgraph").read_bytes()
    capsys.readouterr()
    assert bake(meshes / "large.obj", meshes / "small.obj", "-o", out, "--json") == 0
    said = capsys.readouterr()
    assert "2 of 2 are finished already" in said.err
    assert [report["levels"][0]["surface_vertices"] for report in json.loads(said.out)] == [42, 42]
    assert bake(meshes / "large.obj", meshes / "small.obj", "-o", out) == 0
    assert "small.obj" in capsys.readouterr().out


def test_what_several_meshes_do_not_take_is_refused(meshes, tmp_path, capsys):
    (tmp_path / "empty").mkdir()
    (tmp_path / "again").mkdir()
    write_obj(icosphere(1), tmp_path / "again" / "small.obj")
    out = tmp_path / "out"
    for arguments, words in (
        ([meshes], "--output: found none with several meshes"),
        ([meshes, "-o", out, "--surface-only"], "--surface-only: found with several meshes"),
        ([tmp_path / "empty", "-o", out], "empty: no mesh in this folder"),
        ([meshes, tmp_path / "again", "-o", out], "small.obj: would be baked to"),
        ([meshes, "-o", meshes / "small.obj"], "a folder is wanted for several meshes"),
        ([meshes / "small.obj", "-o", out, *TWO], "--scheduler: found with nothing to spread over workers"),
    ):
        assert bake(*arguments) == 1
        assert words in capsys.readouterr().err
    assert not list(out.glob("*.qgraph"))


@pytest.fixture
def scene(tmp_path):
    document = {
        "quadgraph_scene": 1,
        "body": str(tiny.PATH),
        "material": "marble",
        "lights": [{"type": "directional", "direction": [0.4, -0.3, -1], "irradiance": 1}],
        "camera": {"azimuth": 0, "elevation": 10},
        "solver": {"correction": False},
        "picture": {"width": 48, "height": 32, "samples": 4},
        "frames": 3,
        "tracks": [{"path": "/camera/azimuth", "keys": [[0, 0], [3, 360]]}],
    }
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(document))
    return path


def test_frames_are_those_that_are_rendered_alone(scene, tmp_path, capsys):
    asked = ["--device", "cpu", "-o", str(tmp_path / "f" / "%02d.exr"), "-o", str(tmp_path / "f" / "turn.gif")]
    report = tmp_path / "report.json"
    assert cli.main(["render", str(scene), "--frames", *asked, *TWO, "--json", str(report)]) == 0
    said = capsys.readouterr()
    assert "frame 2: done" in said.err
    assert "frames: 3 in" in said.out
    assert [each["frame"] for each in json.loads(report.read_text())] == [0, 1, 2]
    alone = tmp_path / "alone.exr"
    assert cli.main(["render", str(scene), "--frame", "1", "--device", "cpu", "-o", str(alone)]) == 0
    assert (tmp_path / "f" / "01.exr").read_bytes() == alone.read_bytes()
    with Image.open(tmp_path / "f" / "turn.gif") as film:
        assert len(list(ImageSequence.Iterator(film))) == 3


def test_frames_that_are_finished_are_found(scene, tmp_path, capsys):
    frames = ["--frames", "2", "--device", "cpu", "-o", str(tmp_path / "f" / "%d.png"), *TWO]
    assert cli.main(["render", str(scene), *frames]) == 0
    (tmp_path / "f" / "1.png").unlink()
    capsys.readouterr()
    assert cli.main(["render", str(scene), *frames]) == 0
    said = capsys.readouterr().err
    assert "1 of 2 are finished already" in said
    assert "frame 1: done (2 of 2)" in said
    assert cli.main(["render", str(scene), "-o", str(tmp_path / "one.png"), *TWO]) == 1
    assert "--frames is wanted" in capsys.readouterr().err


def test_schedulers_that_are_none_are_refused(meshes, tmp_path, capsys):
    with pytest.raises(SystemExit) as stop:
        bake(meshes, "-o", tmp_path / "out", "--scheduler", "local:none")
    assert stop.value.code == 2
    assert "a number of workers is wanted, local:1 to local:1024" in capsys.readouterr().err


def test_several_captures_are_checked_before_any(tmp_path, capsys):
    twice = [str(tmp_path / name / "capture.json") for name in ("a", "b/a")]
    for arguments, words in (
        ([*twice, "-o", "out", "--report", "page.html"], "--report: found with several captures"),
        ([*twice, "-o", "out"], "two of them would be written to one file"),
        ([twice[0], "-o", "out.npz", "--no-correction", *TWO], "several captures are wanted"),
    ):
        assert cli.main(["acquire", *arguments]) == 1
        assert words in capsys.readouterr().err
