"""Slips in names are answered with what they may have been: commands, options, materials, lights and patterns."""

from __future__ import annotations

import pytest

import tiny
from quadgraph import cli
from quadgraph.base.message import meant

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

RENDER = ["render", str(tiny.PATH), "-o", "a.png"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["rendr"], "(did you mean 'render'?)"),
        ([*RENDER, "--materal", "jade"], "unrecognized arguments: --materal jade (did you mean '--material'?)"),
        ([*RENDER, "--exposur=1", "x"], "unrecognized arguments"),
        ([*RENDER, "--metod=fem"], "(did you mean '--method'?)"),
        ([*RENDER, "--method", "fen"], "(did you mean 'fem'?)"),
        (["bake", "a.obj", "--up", "7"], "invalid choice: '7' (choose from 'y', 'z')\n"),
    ],
)
def test_of_a_command_line_with_its_usage(arguments, said, capsys):
    with pytest.raises(SystemExit) as stop:
        cli.main(arguments)
    assert stop.value.code == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ([*RENDER, "--material", "marbel"], "material 'marbel' (did you mean 'marble'?)"),
        ([*RENDER, "--material", "marble,pattern=viens"], "(did you mean 'veins'?)"),
        ([*RENDER, "--light", "sopt:0,0,9:0,0,-1:20:1"], "light 'sopt:0,0,9:0,0,-1:20:1' (did you mean 'spot'?)"),
        (["materials", "whole-milk"], "material 'whole-milk' (did you mean 'wholemilk'?)"),
    ],
)
def test_of_names_in_one_line(arguments, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert cli.main(arguments) == 1
    captured = capsys.readouterr()
    assert said in captured.err
    assert captured.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_what_is_no_slip_is_not_guessed():
    assert meant("zzz", ["render", "bake"]) == ""
    assert meant("", ["render"]) == ""
    assert meant("x" * 10_000, ["render"]) == ""
