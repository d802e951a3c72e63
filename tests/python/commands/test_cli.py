"""The command line: exit status, one line per error, and JSON."""

from __future__ import annotations

import json
import re
import subprocess
import sys

import numpy as np
import pytest

import tiny
from quadgraph import cli
from quadgraph.baking.pipeline import BakeOptions
from quadgraph.base.arguments import length_mm
from quadgraph.file import level_quality
from quadgraph.tets.polygrid.build import DEFAULT_CELLS
from quadgraph.tets.polygrid.polycube import DEFAULT_CUBES
from quadgraph.tets.tet_geometry import determinants
from quadgraph.tets.tetrahedralise import DEFAULT_GRADING
from shapes import icosphere, write_obj

TOLD_DEFAULT = re.compile(r"--([a-z-]+) .*\(default: (?:about )?([\w.]+)")


def test_the_help_of_bake_tells_the_defaults_of_what_bakes(capsys):
    """It is printed without importing the modules that have them."""
    usual = BakeOptions()
    defaults = {"mesher": usual.mesher, "order": usual.order}
    numbers = {"relax-nodes": usual.relax_nodes, "visibility-rays": usual.visibility_rays, "grading": DEFAULT_GRADING}
    numbers |= {"cubes": DEFAULT_CUBES, "cells": DEFAULT_CELLS}
    numbers |= {"time-limit": usual.time_limit_s, "memory-limit": round(usual.memory_limit_bytes / 1e9, 1)}
    defaults |= {name: f"{number:.3g}" for name, number in numbers.items()}
    with pytest.raises(SystemExit):
        cli.main(["bake", "--help"])
    options = re.split(r"^  (?=-)", capsys.readouterr().out, flags=re.MULTILINE)
    told = [found.groups() for text in options if (found := TOLD_DEFAULT.match(" ".join(text.split())))]
    assert {name: text for name, text in told if name in defaults} == defaults


def test_a_start_loads_nothing_that_only_meshes_or_other_commands_need():
    names = ("pymeshlab", "scipy", "trimesh", "quadgraph.commands.bake", "quadgraph_validation")
    loaded = f"[name for name in {names} if name in sys.modules]"
    code = f"import sys; from quadgraph import cli; cli.main(['solve', {str(tiny.PATH)!r}]); print({loaded})"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout.endswith("[]\n"), done.stdout + done.stderr


@pytest.fixture
def sphere(tmp_path):
    return write_obj(icosphere(3, 10), tmp_path / "sphere.obj")


def test_bake_prints_json_on_standard_output_alone(sphere, tmp_path, capsys):
    output = tmp_path / "sphere.qgraph"
    assert cli.main(["bake", str(sphere), "-o", str(output), "--height", "2cm", "--levels", "2", "--json"]) == 0
    captured = capsys.readouterr()
    report = json.loads(captured.out)
    assert report["unit_mm"] == pytest.approx(1)
    assert len(report["levels"]) == 2
    assert report["byte_size"] == output.stat().st_size
    assert "read sphere.obj" in captured.err


def test_bake_reports_to_people(sphere, tmp_path, capsys):
    assert cli.main(["bake", str(sphere), "-o", str(tmp_path / "a.qgraph"), "--unit", "mm"]) == 0
    text = capsys.readouterr().out
    for word in ("tets", "time:", "memory:", "after relaxing", "sees itself in 0.0%", "wrote"):
        assert word in text


def test_bake_and_info_tell_that_rays_were_left_out(sphere, tmp_path, capsys):
    output = str(tmp_path / "a.qgraph")
    assert cli.main(["bake", str(sphere), "-o", output, "--unit", "mm", "--visibility-rays", "0"]) == 0
    assert cli.main(["info", output]) == 0
    text = capsys.readouterr().out
    assert text.count("exchange: none") == 2
    assert "visibility_rays 0" in text


def test_bake_and_info_tell_what_the_interior_is_for(sphere, tmp_path, capsys):
    output = str(tmp_path / "a.qgraph")
    arguments = ["bake", str(sphere), "-o", output, "--unit", "mm", "--levels", "2", "--visibility-rays", "0"]
    assert cli.main([*arguments, "--interior", "1.5"]) == 0
    assert cli.main(["info", output]) == 0
    text = capsys.readouterr().out
    assert text.count("interior: tets as asked for, edges of at most 1.5, 3 mm by level") == 2
    medium = "sigma_s_prime=2,sigma_a=0.01"
    assert cli.main([*arguments, "--for-material", medium, "--for-material", "sigma_s_prime=1,sigma_a=0.1"]) == 0
    assert f"interior: tets for {medium}, sigma_s_prime=1,sigma_a=0.1, edges" in " ".join(
        capsys.readouterr().out.split()
    )
    assert cli.main([*arguments, "--interior", "1.5", "--for-material", medium]) == 1
    assert "one of them says how large tets are" in capsys.readouterr().err


def test_info_json_tells_everything(capsys):
    assert cli.main(["info", str(tiny.PATH), "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert facts["byte_size"] == tiny.PATH.stat().st_size
    assert facts["metadata"]["mesher"]["name"] == "hand"
    tets = next(entry for entry in facts["sections"] if entry["name"] == "level0/tets")
    assert tets == {"name": "level0/tets", "type": "uint32", "shape": [24, 4], "bytes": 384}
    assert facts["levels"][0]["nodes"] == 36
    assert facts["display"] == {"vertices": 24, "triangles": 12, "size_mm": [2, 2, 2]}


def test_info_for_people(capsys):
    assert cli.main(["info", str(tiny.PATH)]) == 0
    text = capsys.readouterr().out
    for word in ("hand", "level1/links", "17", "smallest"):
        assert word in text


def test_info_needs_no_reader_of_meshes():
    script = (
        "import sys\n"
        "for name in ('pymeshlab', 'trimesh', 'fast_simplification'): sys.modules[name] = None\n"
        "from quadgraph.cli import main\n"
        f"sys.exit(main(['info', {str(tiny.PATH)!r}]))"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_without_standard_output_nothing_fails():
    command = f"{sys.executable} -m quadgraph.cli info {tiny.PATH} --json >&-"
    done = subprocess.run(command, shell=True, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


def test_a_reader_that_leaves_causes_no_traceback():
    command = f"{sys.executable} -m quadgraph.cli info {tiny.PATH} --json | true"
    done = subprocess.run(command, shell=True, capture_output=True, text=True)
    assert done.stderr == ""


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["polish"],
        ["bake"],
        ["bake", "a.obj", "-o", "a.qgraph", "--unit", "inch"],
        ["bake", "a.obj", "-o", "a.qgraph", "--unit", "mm", "--height", "1mm"],
        ["bake", "a.obj", "-o", "a.qgraph", "--height", "100"],
        ["bake", "a.obj", "-o", "a.qgraph", "--height", "-1mm"],
        ["bake", "a.obj", "-o", "a.qgraph", "--levels", "0"],
        ["bake", "a.obj", "-o", "a.qgraph", "--relax-nodes", "-1"],
        ["bake", "a.obj", "-o", "a.qgraph", "--visibility-rays", "-1"],
        ["bake", "a.obj", "-o", "a.qgraph", "--order", "sideways"],
        ["bake", "a.obj", "-o", "a.qgraph", "--time-limit", "nan"],
        ["bake", "a.obj", "-o", "a.qgraph", "--time-limit", "1e300"],
        ["bake", "a.obj", "-o", "a.qgraph", "--memory-limit", "1e308"],
        ["bake", "a.obj", "-o", "a.qgraph", "--interior=--"],
        ["bake", "a.obj", "-o--"],
        ["info"],
    ],
)
def test_wrong_usage_exits_with_2(arguments, capsys):
    with pytest.raises(SystemExit) as stop:
        cli.main(arguments)
    assert stop.value.code == 2
    assert "usage: quadgraph" in capsys.readouterr().err


def test_errors_are_one_line_and_exit_with_1(tmp_path, capsys):
    absent = tmp_path / "absent.obj"
    for arguments in (
        ["bake", str(absent), "-o", str(tmp_path / "a.qgraph"), "--unit", "mm"],
        ["bake", str(tiny.PATH), "-o", str(tmp_path / "a.qgraph"), "--unit", "mm"],
        ["info", str(absent)],
        ["info", __file__],
    ):
        assert cli.main(arguments) == 1
        captured = capsys.readouterr()
        assert captured.out == ""
        assert captured.err.startswith("quadgraph: error: ")
        assert captured.err.count("\n") == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("text", "expected"), [("100mm", 100), ("1.5cm", 15), ("2 m", 2000), ("1e-1m", 100)])
def test_lengths(text, expected):
    assert length_mm(text) == pytest.approx(expected)


def test_dihedral_angles_of_a_regular_and_a_right_tet():
    regular = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    right = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    assert determinants(right, np.arange(4)[None]) > 0
    tet = np.arange(4)[None]
    np.testing.assert_allclose(level_quality.dihedral_angles(regular, tet), np.degrees(np.arccos(1 / 3)))
    steep = np.degrees(np.arccos(1 / np.sqrt(3)))
    np.testing.assert_allclose(np.sort(level_quality.dihedral_angles(right, tet)[0]), [steep] * 3 + [90] * 3)
