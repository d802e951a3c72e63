"""The user's file of defaults: for all commands or one, by the checks of the command line, which wins."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest
from PIL import Image

import tiny
from quadgraph import cli

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

FAST = 'device = "cpu"\ncorrection = false\n'


@pytest.fixture
def config(tmp_path, monkeypatch):
    """Writes the file of defaults; its path."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    path = tmp_path / "config" / "quadgraph" / "config.toml"
    path.parent.mkdir(parents=True)

    def write(text: str):
        path.write_text(text)
        return path

    return write


def rendered(tmp_path, *arguments: str) -> tuple[tuple[int, int], dict]:
    """The size of a picture that is rendered with these arguments, and its metadata."""
    out = tmp_path / "a.png"
    assert cli.main(["render", str(tiny.PATH), *arguments, "-o", str(out)]) == 0
    with Image.open(out) as image:
        return image.size, dict(image.text)


def test_values_for_all_commands_and_for_one(config, tmp_path):
    config(FAST + 'size = "40x30"\nmaterial = "jade"\n[render]\nmaterial = "wax"\nmethod = "quadgraph-fv"\n')
    size, said = rendered(tmp_path)
    assert size == (40, 30)
    assert said["material"] == "wax"
    assert said["method"] == "quadgraph-fv"


def test_what_is_typed_wins(config, tmp_path):
    config(FAST + '[render]\nsize = "40x30"\nmaterial = "jade"\nlight = ["ambient:1", "ambient:2"]\n')
    size, said = rendered(tmp_path, "--size", "20x10", "--material", "marble", "--light", "directional:0,0,-1:1")
    assert size == (20, 10)
    assert said["material"] == "marble"
    assert "ambient" not in said["lights"]
    assert "ambient" in rendered(tmp_path)[1]["lights"]


def test_an_option_that_is_typed_excludes_a_configured_one(config, tmp_path):
    config('[bake]\nheight = "2cm"\n')
    mesh = tmp_path / "cube.obj"
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    faces = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]
    lines = [f"v {x} {y} {z}" for x, y, z in corners] + [f"f {a} {b} {c} {d}" for a, b, c, d in faces]
    mesh.write_text("\n".join(lines))
    command = ["bake", str(mesh), "--surface-only"]
    for typed, unit in (([], 20), (["--unit", "cm"], 10)):
        out = tmp_path / f"{unit}.qgraph"
        assert cli.main([*command, *typed, "-o", str(out)]) == 0
        done = subprocess.run(
            [sys.executable, "-m", "quadgraph.cli", "info", str(out), "--json"], capture_output=True, check=True
        )
        assert json.loads(done.stdout)["metadata"]["unit_mm"] == unit


@pytest.mark.parametrize("before", [True, False])
def test_it_is_left_alone_when_asked(config, tmp_path, before):
    path = config("[render\n")
    arguments = ["render", str(tiny.PATH), "--size", "16x16", "--no-correction", "-o", str(tmp_path / "a.png")]
    command = ["--no-config", *arguments] if before else [*arguments, "--no-config"]
    assert cli.main(command) == 0
    assert path.read_text() == "[render\n"


def test_a_scene_file_wins_over_defaults_of_what_it_says(config, tmp_path):
    config('device = "cpu"\n[render]\nmaterial = "jade"\nsize = "20x10"\n')
    scene = tmp_path / "scene.json"
    scene.write_text(json.dumps({"body": str(tiny.PATH), "material": "wax", "solver": {"correction": False}}))
    out = tmp_path / "a.png"
    assert cli.main(["render", str(scene), "--size", "24x16", "-o", str(out)]) == 0
    with Image.open(out) as image:
        assert image.size == (24, 16)
        assert image.text["material"] == "wax"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[render]\nmateral = 1\n", "[render] materal (did you mean 'material'?): found; allowed are"),
        ("materal = 1\n", "materal (did you mean 'material'?): found; allowed are"),
        ("[rendr]\nsize = 1\n", "[rendr] (did you mean 'render'?): found; tables of commands are: bake, "),
        ('[render]\nmethod = "fen"\n', "[render] method: found 'fen'; invalid choice: 'fen'"),
        ("fov = 400\n", "fov: found 400; fov: found '400', expected a number (more than 0, at most 150)"),
        ("[render]\ncorrection = 1\n", "[render] correction: found 1; allowed are true and false"),
        ("[render]\nfov = [1, 2]\n", "[render] fov: found [1, 2]; allowed is a text or a number"),
        ("[render]\noutput = 'a.png'\n", "[render] output"),
        ("size = \n", "is no TOML"),
    ],
)
def test_what_is_wrong_is_named_with_the_file(config, tmp_path, capsys, text, said):
    path = config(text)
    assert cli.main(["render", str(tiny.PATH), "-o", str(tmp_path / "a.png")]) == 1
    captured = capsys.readouterr()
    assert captured.err.startswith("quadgraph: error: ")
    assert f"{path.name}: " in captured.err
    assert said in captured.err
    assert "--no-config" in captured.err
    assert captured.err.count("\n") == 1
    assert not (tmp_path / "a.png").exists()


def test_values_of_other_commands_do_not_disturb(config, capsys):
    config('size = "40x30"\n[bake]\nlevels = "many"\n')
    assert cli.main(["info", str(tiny.PATH)]) == 0
    assert cli.main(["bake", "absent.obj"]) == 1
    assert "[bake] levels: found 'many'; invalid positive_int value: 'many'" in capsys.readouterr().err


def test_doctor_tells_of_a_file_that_is_wrong_and_completion_works(config, capsys):
    path = config("size = \n")
    assert cli.main(["completion", "bash"]) == 0
    capsys.readouterr()
    assert cli.main(["doctor", "--json"]) == 0
    check = next(each for each in json.loads(capsys.readouterr().out)["checks"] if each["name"] == "config")
    assert not check["ok"]
    assert str(path) in check["found"]
