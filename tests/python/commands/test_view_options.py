"""Options of `quadgraph view`: what is said of a mesh may stand before the file and after it."""

from __future__ import annotations

from contextlib import contextmanager

import pytest

from quadgraph.cli import main
from quadgraph.commands import view
from shapes import icosphere, write_obj


@pytest.fixture
def seen(monkeypatch):
    """What a window would be opened with: the arguments of the mesh, and the program's."""
    found = {}

    @contextmanager
    def body(file, args, surface_only):
        found.update(file=file, longest=args.longest, unit=args.unit, wrap=args.wrap, only=surface_only)
        yield file

    def run(command, check):
        found["command"] = command
        return type("Ended", (), {"returncode": 0})()

    monkeypatch.setattr(view.own_mesh, "body", body)
    monkeypatch.setattr(view, "find_program", lambda: "program")
    monkeypatch.setattr(view.subprocess, "run", run)
    return found


@pytest.mark.parametrize("order", ["before", "after", "between"])
def test_the_size_of_a_mesh_stands_where_it_likes(tmp_path, seen, order):
    mesh = write_obj(icosphere(1, 5), tmp_path / "ball.obj")
    sizes, others = ["--longest", "80mm", "--wrap", "auto"], ["--headless", "--view", "-30,10"]
    words = {
        "before": [*sizes, str(mesh), *others],
        "after": [str(mesh), *others, *sizes],
        "between": [str(mesh), *others[:1], *sizes, *others[1:]],
    }
    assert main(["view", *words[order]]) == 0
    assert (seen["longest"], seen["wrap"], seen["unit"]) == (80, "auto", None)
    assert seen["command"] == ["program", mesh, "--headless", "--view=-30,10"]


def test_two_sizes_are_refused(tmp_path, seen, capsys):
    mesh = write_obj(icosphere(1, 5), tmp_path / "ball.obj")
    with pytest.raises(SystemExit) as refused:
        main(["view", str(mesh), "--headless", "--unit", "mm", "--longest", "80mm"])
    assert refused.value.code == 2
    assert "not allowed with" in capsys.readouterr().err
    assert not seen
