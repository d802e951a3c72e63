"""Names and values of 100,000 characters: told in fewer than 480, with the next step at the end."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest

import tiny
from engine_program import ENGINE
from quadgraph.base.errors import InputError
from quadgraph.base.message import MOST, shortened
from quadgraph.cli import main

core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

LONG, WORDS = "x" * 100_000, "word " * 20_000
LIGHT = {"type": "directional", "direction": [0, 0, -1], "irradiance": 1}
SCENES = {
    "a key": ({LONG: 1}, "frames_per_second, tracks"),
    "a key of a light": ({"lights": [{**LIGHT, LONG: 1}]}, "allowed are type, direction, irradiance"),
    "a kind of light": ({"lights": [{**LIGHT, "type": LONG}]}, "rectangle, projector, environment"),
    "a material": ({"material": LONG}, "or sigma_s_prime=...,sigma_a=...,eta=..."),
    "words": ({"material": WORDS}, "or sigma_s_prime=...,sigma_a=...,eta=..."),
    "a method": ({"solver": {"method": LONG}}, "polygrid-divergence, shortest-path"),
    "a body": ({"body": LONG}, "(File name too long)"),
}
COMMANDS = {
    "a file": (["info", LONG], 1, "(File name too long)"),
    "an output": (["render", tiny.PATH, "-o", f"{LONG}.png"], 1, "File name too long"),
    "a value": (["render", tiny.PATH, "-o", "a.png", "--size", LONG], 1, "', expected WIDTHxHEIGHT"),
    "a choice": (["render", tiny.PATH, "-o", "a.png", "--method", LONG], 2, "'polygrid-divergence', 'shortest-path')"),
    "an option": (["render", tiny.PATH, "-o", "a.png", f"--{LONG}"], 2, LONG[-3:]),
    "a command": ([LONG], 2, "'stability')"),
    "a height": (["bake", "a.obj", "-o", "a.qgraph", "--height", LONG], 2, "like 100mm"),
}


@pytest.mark.parametrize("case", SCENES)
def test_scenes_with_long_texts_are_refused_in_short(tmp_path: Path, capfd, case: str):
    document, ending = SCENES[case]
    path = tmp_path / "scene.json"
    path.write_text(json.dumps({"quadgraph_scene": 1, "body": str(tiny.PATH), **document}))
    assert main(["render", str(path), "-o", str(tmp_path / "a.png")]) == 1
    said = [capfd.readouterr().err]
    if ENGINE:
        command = [ENGINE, path, "--headless", "-o", tmp_path / "a.png"]
        result = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
        assert result.returncode == 1
        said.append(result.stderr)
    for text in said:
        assert len(text) < 480
        assert text.rstrip().endswith(ending)
    assert [found.name for found in tmp_path.iterdir()] == ["scene.json"]


@pytest.mark.parametrize("case", COMMANDS)
def test_long_arguments_are_refused_in_short(capfd, tmp_path: Path, monkeypatch, case: str):
    monkeypatch.chdir(tmp_path)
    arguments, code, ending = COMMANDS[case]
    try:
        status = main([str(argument) for argument in arguments])
    except SystemExit as error:
        status = error.code
    assert status == code
    line = capfd.readouterr().err.rstrip().splitlines()[-1]
    assert len(line) < 480
    assert line.endswith(ending)
    assert not list(tmp_path.iterdir())


def test_both_languages_write_out_what_a_terminal_obeys():
    text = "a\x1b[31m\x7f\r \x9b\xa0\n\tb"
    with pytest.raises(InputError) as error:
        core.Engine(text)
    assert str(error.value) == shortened(f"{text}: cannot be read (No such file or directory)")
    assert str(error.value).startswith("a\\x1b[31m\\x7f\\x0d \\x9b\xa0\n\tb:")


@pytest.mark.parametrize("text", [LONG, WORDS, f"{WORDS}{LONG}", f"a.json: '{LONG}'; {WORDS}", "a" * (MOST + 1)])
def test_both_languages_shorten_alike(text: str):
    with pytest.raises(InputError) as error:
        core.Engine(text)
    assert str(error.value) == shortened(f"{text}: cannot be read (File name too long)")
    assert len(str(error.value)) <= MOST
    assert str(error.value)[:9] == text[:9]
