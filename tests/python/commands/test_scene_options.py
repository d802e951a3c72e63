"""One place for each fact: command lines, scene files, schema and documents say what the engine's tables say."""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys

import jsonschema
import numpy as np
import pytest

import tiny
from engine_program import ENGINE, ROOT
from quadgraph import cli
from quadgraph.base.errors import InputError
from quadgraph.commands import render, scene_options

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

DOCS = ROOT / "docs"
OPTIONS = {option.name: option for option in _core.scene_options()}
ON_COMMAND_LINE = [option for option in OPTIONS.values() if option.on_command_line]


def render_parser() -> argparse.ArgumentParser:
    """The parser of `quadgraph render`, with all its arguments."""
    parser = argparse.ArgumentParser()
    render.add_arguments(parser)
    return parser


def action_of(option, parser: argparse.ArgumentParser) -> argparse.Action:
    return next(action for action in parser._actions if f"--{option.name}" in action.option_strings)


def engine_help() -> str:
    """What quadgraph-engine --help says, each run of blanks as one."""
    if ENGINE is None:
        pytest.skip("quadgraph-engine is not built: run tools/setup")
    said = subprocess.run([ENGINE, "--help"], capture_output=True, text=True, check=True).stdout
    return re.sub(r"\s+", " ", said)


def test_schema_and_tables_are_those_of_the_engine():
    done = subprocess.run(
        [sys.executable, ROOT / "tools" / "scene_tables", "--check"], capture_output=True, text=True, check=False
    )
    assert (done.stdout, done.stderr, done.returncode) == ("", "", 0)


def test_the_schema_takes_what_the_engine_takes_of_lights():
    schema = json.loads((DOCS / "scene.schema.json").read_text())
    values = {"direction": [0, 0, -1], "point": [0, 0, 9], "edge": [1, 0, 0], "top": [0, 1, 0], "axis": "z"}
    values |= {"number": 1, "turn": 20, "file": "a.png", "power": [1, 2, 3]}
    for kind in _core.light_kinds():
        light = {"type": kind.name, **{field.name: values[field.form] for field in kind.fields}}
        jsonschema.validate({"body": "a", "lights": [light]}, schema)
        for field in kind.fields:
            less = {name: value for name, value in light.items() if name != field.name}
            valid = jsonschema.Draft202012Validator(schema).is_valid({"body": "a", "lights": [less]})
            assert valid == field.optional, (kind.name, field.name)


def test_documents_name_every_kind_of_light_with_its_unit():
    page = (DOCS / "lights.md").read_text()
    for kind in _core.light_kinds():
        assert f"| `{kind.text}` |" in page
        for field in kind.fields:
            assert f"| {kind.name} | `{field.name}` | {field.unit.replace('^2', '²')} |" in page


def test_all_ways_to_a_scene_have_the_same_defaults(tmp_path):
    """Defaults of argparse, of a file that sets nothing, of Python's Scene; and quadgraph-engine's in tests/cpp/app."""
    path = tmp_path / "a.json"
    path.write_text(json.dumps({"body": "a.qgraph", "lights": []}))
    of_file = json.loads(_core.SceneFile(path).at(0).json())
    of_value = json.loads(_core.Scene("a.qgraph").json())
    assert {**of_file, "body": ""} == {**of_value, "body": ""}
    args = render_parser().parse_args(["a.qgraph", "-o", "a.png"])
    for option in OPTIONS.values():
        if option.on_command_line and option.name != "ground":  # which goes by the light
            assert getattr(args, scene_options.destination(option)) == (
                option.default or None if option.kind == "texts" else option.default
            )
        if option.member and not option.own_form and option.default is not None:
            found = of_value
            for key in option.member.strip("/").split("/"):
                found = found[key]
            assert found == option.default, option.name
    assert args.ground is None
    assert of_value["material"] == args.material == OPTIONS["material"].default == "marble"


@pytest.mark.parametrize("option", ON_COMMAND_LINE, ids=lambda option: option.name)
def test_both_command_lines_offer_an_option_alike(option):
    parser = render_parser()
    action = action_of(option, parser)
    said = engine_help()
    told = re.sub(r"\s+", " ", option.full_help)
    assert option.full_help.replace("%", "%%") in action.help
    assert told in said
    assert f"--{option.name}" in said
    assert (tuple(action.choices) if action.choices else ()) == tuple(option.choices)
    if option.choices:
        assert "{" + ", ".join(option.choices) + "}" in said
    if option.default_text and option.kind != "flag":
        assert f"(default: {option.default_text})" in action.help
        assert re.search(rf"--{option.name} [^=]*={re.escape(option.default_text)} ", said)
    if option.kind == "flag":
        assert action.option_strings == [f"--{option.name}", f"--no-{option.name}"]
        assert f"--no-{option.name}" in said


def test_options_out_of_range_are_wrong_usage(capsys):
    for arguments, said in (
        (["--path-cells", "7"], "path-cells: found '7', expected a whole number (8 to 150)"),
        (["--error", "100%"], "error: found '100%', expected a share (at least 0, below 1)"),
        (["--method", "magic"], "invalid choice: 'magic'"),
    ):
        with pytest.raises(SystemExit) as stop:
            cli.main(["render", "a.qgraph", "-o", "a.png", *arguments])
        assert stop.value.code == 2
        assert said in capsys.readouterr().err


def test_keywords_are_those_of_the_table():
    engine = _core.Engine(tiny.PATH)
    engine.set_material("marble")
    engine.set_lights(["ambient:1"])
    with pytest.raises(TypeError, match=r"solve\(\), metod: no such keyword; allowed are method, solver, .*mean_rays"):
        engine.solve(metod="fem")
    with pytest.raises(TypeError, match=r"solve\(\), cycles: found 'three', expected a whole number \(0 to 1000000\)"):
        engine.solve(cycles="three")
    with pytest.raises(InputError, match=r"method 'fen' \(did you mean 'fem'\?\): allowed are fem"):
        engine.solve(method="fen")
    report = engine.solve(tolerance=np.float32(0.01), cycles=np.int64(1), inter_reflection=np.bool_(False))
    assert report["levels"][-1]["iterations"] == 1
    with pytest.raises(TypeError, match="render"):
        engine.render(solver="dpcg")
    alike = [engine.render(**given) for given in ({"size": "32x16"}, {"width": 32, "height": 16})]
    np.testing.assert_array_equal(alike[0].scattered, alike[1].scattered)
    for option in OPTIONS.values():
        if option.keyword:
            assert option.full_help in (engine.solve.__doc__ + engine.render.__doc__), option.name


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (["--version"], 0, "quadgraph"),
        (["--help"], 0, "a picture of a baked object, or of a scene"),
        (["bake", "--help"], 0, "--height"),
        (["render", "--help"], 1, "tools/setup builds it"),
    ],
)
def test_only_what_needs_the_engine_asks_for_it(arguments, code, said):
    script = (
        "import sys\n"
        "sys.modules['quadgraph._core'] = None\n"
        "from quadgraph.cli import main\n"
        f"sys.exit(main({arguments!r}))"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr.count("\n") <= 1) == (code, True)
    assert said in done.stdout + done.stderr
