"""A mesh where a command takes a baked file: baked by itself, at a size that is said, and once."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest
from PIL import Image

from quadgraph import cli
from quadgraph.commands import view
from shapes import icosphere, write_obj

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

SCENE = ["--material", "marble", "--light", "directional:0,0,-1:1", "--no-correction", "--device", "cpu"]


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """The present folder, with a mesh, and a cache folder in it."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.chdir(tmp_path)
    write_obj(icosphere(2, 5), tmp_path / "ball.obj")
    return tmp_path


def test_a_mesh_is_rendered_like_its_bake(folder, capsys):
    assert cli.main(["render", "ball.obj", "--longest", "12mm", "--size", "32x32", *SCENE, "-o", "own.png"]) == 0
    assert "baked ball.obj" in capsys.readouterr().err
    assert cli.main(["render", "ball.obj", "--longest", "12mm", "--size", "32x32", *SCENE, "-o", "again.png"]) == 0
    assert "baked" not in capsys.readouterr().err
    assert cli.main(["bake", "ball.obj", "--longest", "12mm"]) == 0
    assert cli.main(["render", "ball.qgraph", "--size", "32x32", *SCENE, "-o", "baked.png"]) == 0
    pictures = [Image.open(f"{name}.png").tobytes() for name in ("own", "again", "baked")]
    assert pictures[0] == pictures[1] == pictures[2]


def test_a_mesh_is_solved_at_the_size_that_is_said(folder, capsys):
    assert cli.main(["solve", "ball.obj", *SCENE, "--json", "report.json"]) == 0
    said = capsys.readouterr().err
    assert "ball.obj: no size was given, so its longest side is 100 mm" in said
    entered = json.loads((folder / "report.json").read_text())["energy"]["entered"][0]
    assert cli.main(["solve", "ball.obj", "--longest", "50mm", *SCENE, "--json", "half.json"]) == 0
    assert "no size" not in capsys.readouterr().err
    half = json.loads((folder / "half.json").read_text())["energy"]["entered"][0]
    assert entered / half == pytest.approx(4, rel=1e-3)


def test_a_bake_names_its_file_and_replaces_none_by_itself(folder, capsys):
    assert cli.main(["bake", "ball.obj", "--levels", "1"]) == 0
    assert "longest side is 100 mm" in capsys.readouterr().out
    before = (folder / "ball.qgraph").read_bytes()
    assert cli.main(["bake", "ball.obj", "--levels", "2"]) == 1
    assert "-o ball.qgraph replaces it" in capsys.readouterr().err
    assert (folder / "ball.qgraph").read_bytes() == before


def test_a_baked_file_knows_its_size(folder, capsys):
    assert cli.main(["bake", "ball.obj", "--levels", "1"]) == 0
    assert cli.main(["render", "ball.qgraph", "--longest", "3mm", *SCENE, "-o", "a.png"]) == 1
    assert "--longest and --wrap are for meshes" in capsys.readouterr().err


PROGRAM = f"""#!{sys.executable}
import json, pathlib, sys, time
from quadgraph.file import qgraph_file
body, said = sys.argv[1], {{}}
if "--preview" in sys.argv:
    assert not qgraph_file.read(body).metadata["levels"]
    news = pathlib.Path(sys.argv[sys.argv.index("--preview") + 1])
    while not said.keys() & {{"body", "failed"}}:
        time.sleep(.02)
        said = json.loads(news.read_text()) if news.exists() else {{}}
    body = said["body"]
sys.exit(10 + len(qgraph_file.read(body).metadata["levels"]))
"""


@pytest.mark.parametrize(
    ("options", "levels"),
    [
        ([], 2),
        (["--method", "fem"], 2),
        (["--method", "shortest-path"], 0),
        (["--method=shortest-path"], 0),
        (["--method", "shortest-path", "--method", "fem"], 2),
    ],
)
def test_the_window_gets_a_bake_unless_the_method_takes_any_mesh(folder, monkeypatch, options, levels):
    """The program in its place says how many levels it was given: of a preview, those of what it is told of then."""
    program = folder / "program"
    program.write_text(PROGRAM)
    program.chmod(0o755)
    monkeypatch.setattr(view, "find_program", lambda: str(program))
    for _ in range(2):  # the second time it is kept
        assert cli.main(["view", "--longest", "10mm", "ball.obj", *options]) == 10 + min(levels, 1)


def test_ctrl_c_while_a_mesh_is_baked_keeps_nothing(folder):
    write_obj(icosphere(5, 5), folder / "large.obj")
    command = [sys.executable, "-m", "quadgraph.cli", "render", "large.obj", *SCENE, "-o", "a.png"]
    program = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    assert program.stderr is not None
    while "read large.obj" not in program.stderr.readline():
        assert program.poll() is None
    program.terminate()
    assert program.wait(timeout=20) == 143
    program.stderr.close()
    assert not list((folder / "cache" / "quadgraph" / "bodies").iterdir())
    assert not (folder / "a.png").exists()
