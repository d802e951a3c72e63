"""Temporary files beside outputs: gone however Python ends, but for what others own or what became an output."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from quadgraph.base import atomic_file

BEGIN = "import os, sys, pathlib\nfrom quadgraph.base import atomic_file\n"
BEGIN += "handle, name = atomic_file.new_file(pathlib.Path('out.mp4'), '.mp4')\nos.write(handle, b'half')\n"


def left_by(folder, program: str) -> list[str]:
    """Names of the files that a program leaves in a folder."""
    run = subprocess.run([sys.executable, "-c", BEGIN + program], cwd=folder, capture_output=True, text=True)
    assert "atomic_file" not in run.stderr, run.stderr
    return sorted(path.name for path in folder.iterdir())


@pytest.mark.parametrize("ending", ["pass", "sys.exit(3)", "raise KeyboardInterrupt"])
def test_a_temporary_file_goes_when_python_ends(tmp_path, ending):
    assert left_by(tmp_path, ending) == []


def test_it_goes_from_where_it_was_made(tmp_path):
    (tmp_path / "other").mkdir()
    assert left_by(tmp_path, "os.chdir('other')") == ["other"]


def test_what_could_not_be_made_is_forgotten(tmp_path):
    path = tmp_path / "not there" / "out.json"
    with pytest.raises(FileNotFoundError):
        atomic_file.new_file(path, ".tmp")
    assert not [each for each in atomic_file._unfinished if each.parent == path.parent]


def test_what_became_an_output_stays(tmp_path):
    assert left_by(tmp_path, "name.replace('out.mp4')") == ["out.mp4"]


def test_a_fork_leaves_the_files_of_its_parent_alone(tmp_path):
    program = "if os.fork() == 0: sys.exit()\nos.wait()\nname.replace('out.mp4')"
    assert left_by(tmp_path, program) == ["out.mp4"]


def test_a_discarded_file_is_gone_at_once(tmp_path):
    handle, temporary = atomic_file.new_file(tmp_path / "out.png", ".tmp")
    os.close(handle)
    assert temporary.parent == tmp_path
    assert temporary.is_file()
    atomic_file.discard(temporary)
    assert list(tmp_path.iterdir()) == []


def test_names_as_long_as_the_system_takes_can_be_written(tmp_path):
    path = tmp_path / ("\N{SNOWMAN}" * 83 + ".json")  # 254 bytes of UTF-8
    atomic_file.write_json(path, [1])
    assert path.read_text() == "[\n 1\n]\n"
