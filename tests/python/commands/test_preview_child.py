"""The bake of a window in a process of its own: of several at once one bakes, and the others wait for its body."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from shapes import icosphere, write_obj


@pytest.fixture
def cache(tmp_path: Path, monkeypatch) -> Path:
    """A cache folder of the test's own."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache" / "quadgraph" / "bodies"


def start(mesh: Path) -> subprocess.Popen[str]:
    """The bake that a window of a mesh starts, its temporary files in a folder beside the mesh."""
    folder = mesh.parent / "window"
    folder.mkdir(exist_ok=True)
    return subprocess.Popen(
        [sys.executable, "-m", "quadgraph.commands.preview_child", str(mesh), '{"longest_mm": 20}', str(folder)],
        env=os.environ | {"TMPDIR": str(folder)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def read_until(child: subprocess.Popen[str], text: str) -> None:
    """Read what it says up to a line with a text."""
    assert child.stderr is not None
    while text not in (line := child.stderr.readline()):
        assert line, f"it ended without {text!r}"


def start_two(mesh: Path) -> tuple[subprocess.Popen[str], subprocess.Popen[str]]:
    """One that bakes, and was stopped (SIGCONT lets it go on), and another that waits for it."""
    first = start(mesh)
    read_until(first, f"read {mesh.name}")
    first.send_signal(signal.SIGSTOP)
    second = start(mesh)
    read_until(second, f"another program is baking {mesh.name}")
    return first, second


def test_who_waits_for_a_body_gets_the_one_that_another_bakes(tmp_path: Path, cache: Path):
    first, second = start_two(write_obj(icosphere(2, 10), tmp_path / "ball.obj"))
    first.send_signal(signal.SIGCONT)
    bodies = [json.loads(child.communicate(timeout=120)[0])["body"] for child in (first, second)]
    assert bodies == [str(path) for path in cache.glob("*/ball.qgraph")] * 2


@pytest.mark.long
def test_who_waits_for_a_bake_that_is_ended_bakes(tmp_path: Path, cache: Path):
    first, second = start_two(write_obj(icosphere(2, 10), tmp_path / "ball.obj"))
    first.terminate()
    first.send_signal(signal.SIGCONT)
    first.communicate(timeout=20)
    read_until(second, "kept for the next time")
    body = json.loads(second.communicate(timeout=20)[0])["body"]
    assert (first.returncode, second.returncode) == (143, 0)
    assert [str(path) for path in cache.glob("*/*")] == [body]


def test_without_a_cache_the_body_is_in_the_folder(tmp_path: Path, cache: Path):
    cache.parent.parent.write_text("a file where the folder should be")
    child = start(write_obj(icosphere(1, 10), tmp_path / "ball.obj"))
    answer, said = child.communicate(timeout=120)
    assert "is not kept" in said
    assert Path(json.loads(answer)["body"]) == tmp_path / "window" / "ball.qgraph"
    assert list((tmp_path / "window").iterdir()) == [tmp_path / "window" / "ball.qgraph"]


def test_a_mesh_that_cannot_be_baked_is_an_error_in_one_line(tmp_path: Path, cache: Path):
    (tmp_path / "open.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    child = start(tmp_path / "open.obj")
    answer, said = child.communicate(timeout=120)
    assert (child.returncode, answer) == (1, "")
    assert said.splitlines()[-1].startswith("quadgraph: error: ")
    assert "Traceback" not in said
