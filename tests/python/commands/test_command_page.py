"""docs/commands.md: its examples of defaults can be read, and each command has its section and a command line."""

from __future__ import annotations

import importlib
import re
import tomllib

import pytest

from engine_program import ROOT
from quadgraph import cli

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

PAGE = (ROOT / "docs" / "commands.md").read_text()
LINES = re.findall(r"^quadgraph .*$", "\n".join(re.findall(r"```sh\n(.*?)```", PAGE, re.DOTALL)), re.MULTILINE)


def parser():
    modules = {name: importlib.import_module(f"quadgraph.commands.{file}") for name, file in cli.SUBCOMMANDS.items()}
    return cli.build_parser(modules, {})


def test_new_commands_have_sections():
    sections = set(re.findall(r"^## `quadgraph (\w+)`$", PAGE, re.MULTILINE))
    assert sections == {"turntable", "sheet", "compare", "materials", "devices", "doctor", "completion"}
    assert sections <= set(cli.SUBCOMMANDS)
    assert {line.split()[1] for line in LINES} >= sections - {"completion"}


def test_the_example_of_defaults_is_taken(tmp_path, monkeypatch):
    (example,) = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    path = tmp_path / "quadgraph" / "config.toml"
    path.parent.mkdir()
    path.write_text(example)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    said = tomllib.loads(example)
    whole = parser()
    cli.configure(whole)
    args = whole.parse_args(["render", "a.qgraph", "-o", "a.png", "--material", "wax"])
    assert (args.size, args.device, args.material) == (said["size"], said["device"], "wax")
    assert (args.correction, args.light) == (False, said["render"]["light"])
    assert parser().parse_args(["bake", "a.obj"]).levels is None
    assert whole.parse_args(["bake", "a.obj"]).levels == said["bake"]["levels"]
