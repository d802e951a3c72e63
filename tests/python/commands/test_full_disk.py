"""Where there is no room: one line that says where, exit code 1, and nothing half-written."""

from __future__ import annotations

import importlib.util
import json
import resource
import subprocess
import sys
from pathlib import Path

import pytest

import tiny
from shapes import cube, write_obj

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")


SMALL = ("--size", "64x64", "--no-correction")


def run(arguments: list[str | Path], room: int | None = None, **streams) -> subprocess.CompletedProcess:
    """Run the command line where no file becomes longer than `room` bytes, which fails as a full disk does."""
    return subprocess.run(
        [sys.executable, "-m", "quadgraph.cli", *map(str, arguments)],
        preexec_fn=None if room is None else lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (room, room)),
        stderr=subprocess.PIPE,
        text=True,
        **streams,
    )


def scene(folder: Path) -> Path:
    path = folder / "scene.json"
    picture, solver = {"width": 64, "height": 64}, {"correction": False}
    path.write_text(json.dumps({"body": str(tiny.PATH), "frames": 30, "picture": picture, "solver": solver}))
    return path


@pytest.mark.parametrize(
    ("name", "room", "arguments"),
    [
        ("out.png", 400, ["render", "BODY", "-o", "OUT", *SMALL]),
        ("out.exr", 400, ["render", "BODY", "-o", "OUT", *SMALL]),
        ("out.json", 100, ["solve", "BODY", "--json", "OUT", "--no-correction"]),
        ("out.npz", 100, ["solve", "BODY", "--field", "OUT", "--no-correction"]),
        ("out.qgraph", 100, ["bake", "MESH", "--unit", "mm", "--surface-only", "-o", "OUT"]),
        ("out.jpg", 400, ["render", "BODY", "-o", "OUT", *SMALL]),
        ("out.gif", 400, ["turntable", "BODY", "-o", "OUT", *SMALL, "--frames", "3"]),
        ("sheet.png", 400, ["sheet", "BODY", "-o", "OUT", *SMALL]),
        ("out.mp4", 500, ["render", "SCENE", "--frames", "-o", "OUT"]),
    ],
)
def test_an_output_without_room_is_named(tmp_path, name, room, arguments):
    if name.endswith(".mp4") and importlib.util.find_spec("av") is None:
        pytest.skip("films need PyAV")
    inputs, outputs = tmp_path / "in", tmp_path / "out"
    inputs.mkdir()
    outputs.mkdir()
    known = {"BODY": tiny.PATH, "OUT": outputs / name, "SCENE": scene(inputs)}
    known["MESH"] = write_obj(cube(2.0), inputs / "cube.obj")
    done = run([known.get(argument, argument) for argument in arguments], room, stdout=subprocess.DEVNULL)
    assert done.returncode == 1
    assert "Traceback" not in done.stderr
    assert f"quadgraph: error: {outputs / name}: cannot be written" in done.stderr
    assert list(outputs.iterdir()) == []


@pytest.mark.parametrize(
    "arguments", [["info", tiny.PATH], ["info", tiny.PATH, "--json"], ["--version"], ["bake", "-h"]]
)
def test_standard_output_without_room_is_said(arguments):
    with Path("/dev/full").open("w") as full:
        done = run(arguments, stdout=full)
    assert done.returncode == 1
    assert done.stderr.startswith("quadgraph: error: standard output, or a temporary file in ")
    assert done.stderr.endswith(": No space left on device\n")
    assert done.stderr.count("\n") == 1


def test_temporary_files_without_room_are_said(tmp_path):
    mesh = write_obj(cube(2.0), tmp_path / "cube.obj")
    done = run(["bake", mesh, "--unit", "mm", "-o", tmp_path / "out.qgraph"], 20, stdout=subprocess.DEVNULL)
    assert done.returncode == 1
    assert "Traceback" not in done.stderr
    assert "File too large" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["cube.obj"]
