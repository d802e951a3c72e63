"""Scene files as a user renders them: stills, frames, films, and what is wrong with them; and their schema."""

from __future__ import annotations

import copy
import json
import re
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from PIL import Image

from baked import write_levels
from quadgraph import cli
from quadgraph.base.errors import InputError
from shapes import icosphere

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

DOCS = Path(__file__).resolve().parents[3] / "docs"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with a sphere of radius 10 mm in it."""
    path = tmp_path_factory.mktemp("scenes")
    write_levels(path / "sphere.qgraph", [icosphere(3, 10), icosphere(2, 10)])
    return path


def documented() -> dict:
    """The scene that docs/scene.md shows."""
    return json.loads(re.search(r"```json\n(.*?)```", (DOCS / "scene.md").read_text(), re.DOTALL)[1])


def moving(folder: Path) -> Path:
    """A scene in which a light goes around a sphere in four frames."""
    scene = {
        "body": "sphere.qgraph",
        "material": "wholemilk",
        "lights": [{"type": "directional", "direction": [1, 0, 0], "irradiance": 1}],
        "picture": {"width": 48, "height": 32, "background": "black", "exposure": 0},
        "solver": {"sweep_points": 300},
        "frames": 4,
        "tracks": [{"path": "/lights/0/direction", "keys": [[0, [1, 0, 0]], [3, [-1, 0, 0]]], "between": "step"}],
    }
    path = folder / "moving.json"
    path.write_text(json.dumps(scene))
    return path


def lit_side(path: Path) -> float:
    """Where in a picture the light is: -1 at the left, 1 at the right."""
    with Image.open(path) as image:
        light = np.asarray(image.convert("L"), float).sum(axis=0)
    return float((light * np.linspace(-1, 1, len(light))).sum() / light.sum())


def test_frames_go_with_the_tracks_and_do_not_depend_on_each_other(folder, tmp_path, capsys):
    scene = moving(folder)
    report = tmp_path / "report.json"
    numbered = ["--frames", "-o", str(tmp_path / "f" / "%03d.png"), "--json", str(report)]
    assert cli.main(["render", str(scene), *numbered, "--validation"]) == 0
    assert sorted(path.name for path in (tmp_path / "f").iterdir()) == [f"{k:03d}.png" for k in range(4)]
    assert [entry["frame"] for entry in json.loads(report.read_text())] == [0, 1, 2, 3]
    assert "frames: 4" in capsys.readouterr().out
    assert lit_side(tmp_path / "f" / "000.png") < -0.05
    assert lit_side(tmp_path / "f" / "003.png") > 0.05
    alone = tmp_path / "alone.png"
    assert cli.main(["render", str(scene), "--frame", "3", "-o", str(alone)]) == 0
    with Image.open(alone) as still, Image.open(tmp_path / "f" / "003.png") as frame:
        assert np.array_equal(np.asarray(still), np.asarray(frame))


@pytest.mark.parametrize("suffix", [".MP4", ".webm"])
def test_a_film_has_the_frames_and_the_rate(folder, tmp_path, suffix):
    import av

    film = tmp_path / f"turn{suffix}"
    assert cli.main(["render", str(moving(folder)), "--frames", "-o", str(film)]) == 0
    with av.open(film) as container:
        stream = container.streams.video[0]
        assert stream.average_rate == 24
        pictures = [frame.to_ndarray(format="rgb24") for frame in container.decode(stream)]
    assert len(pictures) == 4
    assert pictures[0].shape == (32, 48, 3)
    assert pictures[0][:, :24].mean() > pictures[0][:, 24:].mean()
    assert pictures[3][:, :24].mean() < pictures[3][:, 24:].mean()
    assert list(tmp_path.iterdir()) == [film]


def test_set_changes_what_the_scene_says(folder, tmp_path):
    out = tmp_path / "a.png"
    changes = ["--set", "/picture/width=24", "--set", "/material=ketchup", "--set", "/lights/0/direction=[-1, 0, 0]"]
    assert cli.main(["render", str(moving(folder)), *changes, "--set", "/tracks=[]", "-o", str(out)]) == 0
    with Image.open(out) as image:
        assert image.size == (24, 32)
        pixels = np.asarray(image, float).sum(axis=(0, 1))
    assert pixels[0] > 2 * pixels[2]
    assert lit_side(out) > 0.05


def test_a_volume_lies_beside_its_scene(folder, tmp_path):
    grid = np.ones((2, 2, 2))
    np.savez(folder / "even.npz", sigma_s_prime=2 * grid, sigma_a=0.05 * grid, spacing=10)
    (folder / "even.npz").rename(folder / "even.NPZ")
    pictures = []
    for material in ("even.NPZ", "sigma_s_prime=2,sigma_a=0.05"):
        out = tmp_path / f"{len(pictures)}.png"
        assert cli.main(["render", str(moving(folder)), "--set", f"/material={material}", "-o", str(out)]) == 0
        with Image.open(out) as image:
            pictures.append(np.asarray(image, int))
    assert pictures[0].max() > 60
    assert np.abs(pictures[0] - pictures[1]).max() <= 2


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--set", "/camera/fov"], "--set /camera/fov: allowed is PATH=VALUE"),
        (["--set", f"/material={'[' * 65}"], "--set /material: JSON nested deeper than 64 levels"),
        (["--set", "/camera/fov=500"], "/camera: view, field of view: found 500"),
        (["--frames", "-o", "a.png"], "a.png: a number, e.g. %04d, in the name of every frame is wanted"),
        (["-o", "%d.png"], "%d.png: no number without --frames is wanted"),
        (["-o", "a.mp4"], "a.mp4: a film needs --frames"),
        (["-o", "a.avi"], "a.avi: output must end in .png, .jpg, .jpeg, .exr, .mp4, .webm or .gif"),
        (["--frames", "-o", "a.mp4", "--set", "/picture/width=33"], "a film needs an even width and height"),
    ],
)
def test_what_cannot_be_rendered_is_said(folder, tmp_path, monkeypatch, capsys, options, said):
    monkeypatch.chdir(tmp_path)
    outputs = [] if "-o" in options else ["-o", "out.png"]
    assert cli.main(["render", str(moving(folder)), *options, *outputs]) == 1
    assert said in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_options_of_scenes_want_a_scene(folder, tmp_path, capsys):
    body = str(folder / "sphere.qgraph")
    for option in (["--frames"], ["--set", "/material=jade"], ["--frame", "2"]):
        assert cli.main(["render", body, "-o", str(tmp_path / "a.png"), *option]) == 1
        assert f"{option[0]}: only with a scene file (.json), found" in capsys.readouterr().err


def test_the_documented_scene_is_one_by_schema_and_engine(folder):
    scene = documented()
    jsonschema.validate(scene, json.loads((DOCS / "scene.schema.json").read_text()))
    path = folder / "documented.json"
    path.write_text(json.dumps(scene))
    file = _core.SceneFile(path)
    assert file.frames == scene["frames"]
    whole = json.loads(file.at(0).json())
    jsonschema.validate(whole, json.loads((DOCS / "scene.schema.json").read_text()))


@pytest.mark.parametrize(
    ("pointer", "value"),
    [
        ("/zoom", 1),
        ("/frames", 0),
        ("/camera/elevation", 91),
        ("/camera/up", "x"),
        ("/lights/0/power", 1),
        ("/lights/1/irradiance", -1),
        ("/edits/0/operation", "dye"),
        ("/edits/0/depth", [1]),
        ("/deformation/0/type", "squash"),
        ("/deformation/0/factor", 2),
        ("/solver/method", "fen"),
        ("/picture/width", 1.5),
        ("/picture/background", "red"),
        ("/tracks/0/keys", []),
        ("/tracks/0/between", "fast"),
    ],
)
def test_schema_and_engine_refuse_the_same(folder, pointer, value):
    scene = copy.deepcopy(documented())
    *parents, last = pointer.strip("/").split("/")
    at = scene
    for part in parents:
        at = at[int(part) if part.isdigit() else part]
    at[last] = value
    schema = json.loads((DOCS / "scene.schema.json").read_text())
    assert not jsonschema.Draft202012Validator(schema).is_valid(scene)
    path = folder / "bad.json"
    path.write_text(json.dumps(scene))
    with pytest.raises(InputError, match=f"bad.json: {'/'.join(pointer.split('/')[:2])}"):
        _core.SceneFile(path)
