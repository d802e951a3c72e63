"""`quadgraph render` and `solve` as a user runs them."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

import tiny
from baked import write_levels
from quadgraph import cli
from quadgraph.file import qgraph_file
from shapes import icosphere

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")


@pytest.fixture(scope="module")
def sphere(tmp_path_factory):
    """A sphere of two levels, radius 10 mm."""
    path = tmp_path_factory.mktemp("commands") / "sphere.qgraph"
    return str(write_levels(path, [icosphere(3, 10), icosphere(2, 10)]))


def test_render_writes_both_formats_and_a_report(sphere, tmp_path, capsys):
    png, exr, report = tmp_path / "a.png", tmp_path / "a.exr", tmp_path / "a.json"
    arguments = ["render", sphere, "-o", str(png), "-o", str(exr), "--size", "64x48", "--json", str(report)]
    assert cli.main([*arguments, "--material", "wholemilk", "--light", "directional:0,0,-1:1", "--validation"]) == 0
    with Image.open(png) as image:
        assert image.size == (64, 48)
        assert np.asarray(image).max() > 60
    assert exr.stat().st_size > 64 * 48 * 4
    assert json.loads(report.read_text())["levels"][-1]["converged"]
    printed = capsys.readouterr().out
    for word in ("nodes:", "levels", "ms", "error:", "memory:", str(png), str(exr)):
        assert word in printed


def test_a_view_may_start_with_a_minus(sphere, tmp_path):
    path = tmp_path / "a.json"
    arguments = ["render", sphere, "-o", str(tmp_path / "a.png"), "--size", "16x16", "--view", "-30,-10.5,80"]
    assert cli.main([*arguments, "--json", str(path)]) == 0
    assert path.exists()


def test_solve_field_has_the_documented_arrays_and_balances(sphere, tmp_path, capsys):
    field, report = tmp_path / "field.npz", tmp_path / "report.json"
    light = ["--light", "directional:0,0,-1:1/0.5/0.25"]
    assert cli.main(["solve", sphere, *light, "--tolerance", "1e-5", "--json", str(report), "--field", str(field)]) == 0
    with np.load(field) as arrays:
        n = len(arrays["area"])
        assert set(arrays) == {"position", "normal", "area", "q", "phi", "exitance", "unscattered"}
        assert all(arrays[name].shape == (n, 3) for name in arrays if name != "area")
        entered = (arrays["q"] * arrays["area"][:, None]).sum(axis=0)
        left = ((arrays["exitance"] + arrays["unscattered"]) * arrays["area"][:, None]).sum(axis=0)
        assert np.allclose(np.linalg.norm(arrays["normal"], axis=1), 1, atol=1e-5)
        outward = (arrays["position"] * arrays["normal"]).sum(axis=1)
    assert (outward > 9).all()
    energy = json.loads(report.read_text())["energy"]
    assert np.allclose(entered, energy["entered"], rtol=1e-4)
    assert np.allclose(left + energy["absorbed"], entered, rtol=1e-3)
    assert "dispatches" in capsys.readouterr().out


@pytest.mark.parametrize("method", ["fem", "quadgraph-fv", "quadgraph-fdm"])
def test_solve_answers_with_every_method_model_and_source(sphere, tmp_path, capsys, method):
    for source in ("buried", "diffuse"):
        for model in ("diffusion", "sp3", "auto"):
            path = tmp_path / f"{source}-{model}.json"
            way = ["--method", method, "--source", source, "--model", model]
            status = cli.main(["solve", sphere, "--material", "skin1", *way, "--json", str(path)])
            report = json.loads(path.read_text())
            # What does not conserve energy may be out of balance by more than its error.
            out_of_balance = method == "quadgraph-fdm" and "does not conserve energy" in report["stopped"]
            assert status == (3 if out_of_balance else 0)
            assert (report["method"], report["source"]) == (method, source)
            published = (method, source) == ("quadgraph-fdm", "diffuse")
            automatic = "diffusion" if published else "sp3"
            assert report["model"] == (automatic if model == "auto" else model)
            assert set(report["energy"]) == {
                "entered",
                "re_entered",
                "scattered_out",
                "absorbed",
                "unscattered_out",
                "balance",
            }
            printed = capsys.readouterr().out
            assert f"{method} / {report['model']} / {source}" in printed
            assert "clipped" in printed


def test_solve_says_so_when_it_stops_early(sphere, capsys):
    arguments = ["solve", sphere, "--light", "directional:0,0,-1:1", "--max-iterations", "2", "--solver", "cascade"]
    assert cli.main(arguments) == 3
    assert "failed: not converged" in capsys.readouterr().out


def test_a_missed_error_is_a_warning_and_fails_where_it_is_held_against_the_solve(tmp_path, capsys):
    arguments = ["--light", "directional:0,0,-1:1", "--error", "0.01%", "--sweep-points", "300"]
    picture = ["-o", str(tmp_path / "a.png"), "--size", "16x16"]
    for command in (["solve", str(tiny.PATH), *arguments], ["render", str(tiny.PATH), *arguments, *picture]):
        assert cli.main(command) == 0
        assert "warning: error 0.01% is not certain: the estimate is" in capsys.readouterr().out
        assert cli.main([*command, "--strict"]) == 3


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["render", "{sphere}", "-o", "a.bmp"], ["a.bmp", ".png", ".exr"]),
        (["render", "{sphere}", "-o", "{folder}/none/a.png"], ["none"]),
        (["render", "{sphere}", "-o", "{folder}/a.png", "--material", "granite"], ["granite", "marble"]),
        (["render", "{sphere}", "-o", "{folder}/a.png", "--light", "laser:1"], ["laser", "directional"]),
        (["render", "{sphere}", "-o", "{folder}/a.png", "--view", "10"], ["10"]),
        (["render", "{sphere}", "-o", "{folder}/a.png", "--size", "99999x4"], ["99999"]),
        (["render", "{sphere}", "-o", "{folder}/a.png", "--device", "abacus"], ["abacus", "found"]),
        (["solve", "{folder}/missing.qgraph"], ["missing.qgraph"]),
        (["solve", "{sphere}", "--field", "field.txt"], ["field.txt", ".npz"]),
        (["solve", "{sphere}", "--field", "{folder}/none/field.npz"], ["none"]),
        (["solve", "{sphere}", "--json", "{folder}/none/report.json"], ["none"]),
        (["bench", "--random-order", "{sphere}"], ["--random-order"]),
        (["bench", "--sizes", "500"], ["--sizes", "--scaling"]),
        (["bench", "--passes", "--chart", "{folder}"], ["--chart", "--solvers"]),
        (["bench", "{folder}/missing.qgraph", "--passes"], ["missing.qgraph"]),
    ],
)
def test_mistakes_are_one_line_and_exit_with_1(sphere, tmp_path, capsys, arguments, words):
    arguments = [argument.format(sphere=sphere, folder=tmp_path) for argument in arguments]
    assert cli.main(arguments) == 1
    captured = capsys.readouterr()
    assert captured.err.startswith("quadgraph: error: ")
    assert captured.err.count("\n") == 1
    for word in words:
        assert word in captured.err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "change",
    [
        {"source": 5},
        {"mesher": []},
        {"levels": [None, {"vertices": "x"}]},
        {"repairs": 3},
        {"tools": []},
        {"unit_mm": "x"},
    ],
)
def test_info_names_metadata_that_no_bake_writes(tmp_path, capsys, change):
    path = tmp_path / "odd.qgraph"
    qgraph_file.write_sections(path, tiny.metadata(tiny.graphs()) | change, tiny.all_sections())
    assert cli.main(["info", str(path)]) == 1
    said = capsys.readouterr().err
    assert f"{path}: metadata: not what a bake writes" in said
    assert len(said) < 500 + len(str(path))


@pytest.mark.parametrize("key", ["vertices", "surface_vertices", "tets", "faces", "volume_mm3", "area_mm2"])
def test_info_holds_what_is_stated_of_levels_against_the_sections(tmp_path, capsys, key):
    path = tmp_path / "odd.qgraph"
    metadata = tiny.metadata(tiny.graphs())
    metadata["levels"][1][key] += 1
    qgraph_file.write_sections(path, metadata, tiny.all_sections())
    assert cli.main(["info", str(path)]) == 1
    assert f"levels/1/{key}: {metadata['levels'][1][key]} stated" in capsys.readouterr().err


def test_a_pipe_is_no_body(tmp_path, capsys):
    """Nobody writes into it: reading it would never end."""
    os.mkfifo(tmp_path / "pipe.qgraph")
    assert cli.main(["info", str(tmp_path / "pipe.qgraph")]) == 1
    assert "pipe.qgraph: cannot be read (no regular file)" in capsys.readouterr().err


def test_info_prints_what_the_encoding_of_its_output_lacks():
    run = subprocess.run(
        [sys.executable, "-m", "quadgraph.cli", "info", tiny.PATH],
        env=os.environ | {"PYTHONIOENCODING": "ascii", "LC_ALL": "C"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    assert r"18.43\xb0" in run.stdout


def test_info_prints_no_escapes_of_a_file(tmp_path, capsys):
    path = tmp_path / "odd.qgraph"
    odd = {
        "generator": "\x1b[31mred\x07",
        "mesher": {"name": "\x1b]0;x", "version": "", "options": "", "grading": None},
    }
    qgraph_file.write_sections(path, tiny.metadata(tiny.graphs()) | odd, tiny.all_sections())
    assert cli.main(["info", str(path)]) == 0
    assert "\x1b" not in capsys.readouterr().out
