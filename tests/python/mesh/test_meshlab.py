"""pymeshlab where a library of the system is missing, which it needs to be imported."""

from __future__ import annotations

import sys

from quadgraph import cli
from shapes import icosphere, write_obj


def test_what_is_missing_of_the_system_is_named_with_its_package(tmp_path, monkeypatch, capsys):
    write_obj(icosphere(4, 10), tmp_path / "ball.obj")
    monkeypatch.setitem(sys.modules, "pymeshlab", None)
    body = tmp_path / "ball.qgraph"
    assert cli.main(["bake", str(tmp_path / "ball.obj"), "-o", str(body)]) == 1
    errors = capsys.readouterr().err.splitlines()
    assert "apt install libgl1 libopengl0 libxkbcommon0" in errors[-1]
    assert "ball.obj: pymeshlab cannot be imported" in errors[-1]
    assert not body.exists()
