"""`quadgraph colours`: from a mesh with colours to a picture; nothing is written where something is wrong."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from baked import write_levels
from coloured_files import ramp_glb, ramp_obj, ramp_ply
from quadgraph import cli
from quadgraph.mesh.surface import Surface
from shapes import icosphere

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

BALL = icosphere(3, 10)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The present folder, with a ball that is red on the left and green on the right, baked."""
    monkeypatch.chdir(tmp_path)
    ramp_glb(tmp_path / "toy.glb", BALL)
    write_levels(tmp_path / "toy.qgraph", [BALL])
    return tmp_path


def test_a_picture_shows_the_colours(folder, capsys):
    options = ["--base", "wax", "--mean-free-path", "1/1/0.8", "--depth", "3", "--eta", "1.4", "-o", "toy.npz"]
    assert cli.main(["colours", "toy.glb", "--body", "toy.qgraph", *options]) == 0
    said = capsys.readouterr().out
    assert "eta 1.4; mean colour of the surface 0.35/0.32/0.15 (linear)" in said
    assert "wrote toy.npz" in said
    assert set(np.load("toy.npz")) == {"sigma_s_prime", "sigma_a", "spacing", "origin", "eta"}
    light = ["--light", "ambient:1", "--device", "cpu", "--no-correction", "--exposure", "0"]
    shown = ["--view", "0,0", "--size", "64x64", "-o", "toy.png"]
    assert cli.main(["render", "toy.qgraph", "--material", "toy.npz", *light, *shown]) == 0
    picture = np.asarray(Image.open("toy.png").convert("RGB"), int)
    left, right = picture[24:40, 12:20].mean(axis=(0, 1)), picture[24:40, 44:52].mean(axis=(0, 1))
    assert left[0] > left[1] + 20
    assert right[1] > right[0] + 20


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"-o": "toy.vdb"}, "toy.vdb: output must end in .npz"),
        ({"-o": "toy.npz", "MESH": "gone.glb"}, "gone.glb"),
        ({"MESH": "plain.ply"}, "plain.ply: no colours found"),
        ({"MESH": "other.ply"}, "give the body that was baked of this mesh"),
        ({"--body": "toy.glb"}, "toy.glb"),
        ({"--base": "waxx"}, "waxx"),
        ({"--spacing": "0.001"}, "take about"),
        ({"--depth": "2"}, "depth: found without a base"),
    ],
)
def test_what_is_wrong_is_said_in_a_line(folder, capsys, change, words):
    text = ramp_ply(folder / "other.ply", Surface(BALL.vertices * [1, 3, 1], BALL.triangles)).read_text()
    for channel in ("red", "green", "blue"):
        text = text.replace(f"uchar {channel}", f"uchar other_{channel}")
    (folder / "plain.ply").write_text(text)
    before = set(folder.iterdir())
    given = {"MESH": "toy.glb", "--body": "toy.qgraph", "-o": "new.npz"} | change
    options = [each for name, value in given.items() if name != "MESH" for each in (name, value)]
    assert cli.main(["colours", given["MESH"], *options]) == 1
    said = capsys.readouterr().err
    assert words in said
    assert said.count("\n") == 1
    assert set(folder.iterdir()) == before


def test_a_mesh_is_shown_in_its_own_colours(folder, capsys, monkeypatch):
    """As by hand, step by step."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder / "cache"))
    shown = ["--light", "ambient:1", "--device", "cpu", "--no-correction", "--size", "48x48", "-o"]
    own = ["--longest", "20mm", "--material", "own,mean_free_path=0.7,depth=3,cells=30000,base=wax,period=9"]
    assert cli.main(["render", "toy.glb", *own, *shown, "own.png"]) == 0
    assert "mean colour of the surface 0.35/0.32/0.15" in capsys.readouterr().err
    assert cli.main(["bake", "toy.glb", "--longest", "20mm", "-o", "same.qgraph"]) == 0
    said = ["--mean-free-path", "0.7", "--depth", "3", "--cells", "30000", "--base", "wax,period=9", "-o", "a.npz"]
    assert cli.main(["colours", "toy.glb", "--body", "same.qgraph", *said]) == 0
    assert cli.main(["render", "same.qgraph", "--material", "a.npz", *shown, "by-hand.png"]) == 0
    assert Image.open("own.png").tobytes() == Image.open("by-hand.png").tobytes()
    path = ["--method", "shortest-path", "--material", "own", "--longest", "20mm"]
    assert cli.main(["render", "toy.glb", *path, *shown[:4], "--size", "32x32", "-o", "path.png"]) == 0


@pytest.mark.parametrize(
    ("file", "material", "more", "words"),
    [
        ("toy.qgraph", "own", [], "toy.qgraph: material 'own' found with a file that has no colours"),
        ("toy.glb", "own,depht=3", [], "'depht=3' found, allowed are mean_free_path, depth, eta"),
        ("toy.glb", "own,depth=x", [], "material 'own', depth: 'x' found, a number is wanted"),
        ("toy.glb", "own,cells=1.5", [], "material 'own', cells: '1.5' found"),
        ("toy.glb", "own,base=waxx", [], "waxx"),
        ("toy.glb", "own", ["--map", "box"], "--map: found with --material own"),
    ],
)
def test_own_colours_that_are_none(folder, capsys, monkeypatch, file, material, more, words):
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder / "cache"))
    command = ["render", file, "--material", material, *more, "--device", "cpu", "-o", "a.png"]
    assert cli.main(command + (["--longest", "20mm"] if file.endswith(".glb") else [])) == 1
    assert words in capsys.readouterr().err
    assert not (folder / "a.png").exists()


def test_no_picture_of_the_mesh_is_replaced(folder, capsys):
    ramp_obj(folder / "toy.obj", BALL)
    before = (folder / "ramp.png").read_bytes()
    assert cli.main(["render", "toy.obj", "--longest", "20mm", "--material", "own", "-o", "ramp.png"]) == 1
    assert "ramp.png: is read" in capsys.readouterr().err
    assert (folder / "ramp.png").read_bytes() == before


@pytest.mark.parametrize("path", ["1/2", "0", "a", "-1"])
def test_a_mean_free_path_that_is_none(folder, capsys, path):
    arguments = ["colours", "toy.glb", "--body", "toy.qgraph", "-o", "a.npz", f"--mean-free-path={path}"]
    with pytest.raises(SystemExit) as stopped:
        cli.main(arguments)
    assert stopped.value.code == 2
    assert "--mean-free-path" in capsys.readouterr().err


def test_help_says_what_is_usual(capsys):
    with pytest.raises(SystemExit):
        cli.main(["colours", "--help"])
    said = " ".join(capsys.readouterr().out.split())
    for words in ("a .glb, .gltf, .obj or .ply that has colours", "default: 4 mean free paths", "(default: 1000000)"):
        assert words in said
