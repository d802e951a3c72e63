"""`quadgraph sheet`: a table of bodies and materials, each where its words say."""

from __future__ import annotations

import json
import shutil

import numpy as np
import pytest
from PIL import Image

import tiny
from quadgraph import cli
from quadgraph.base.errors import InputError
from quadgraph.commands import contact_sheet, sheet

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

FAST = ["--no-correction", "--size", "40x30", "--device", "cpu", "--light", "ambient:1"]


@pytest.mark.parametrize(
    ("texts", "materials"),
    [
        (["jade,marble"], ["jade", "marble"]),
        (["marble,pattern=veins,period=3,jade"], ["marble,pattern=veins,period=3", "jade"]),
        (["sigma_s_prime=2,sigma_a=0.1", "jade", "a.npz"], ["sigma_s_prime=2,sigma_a=0.1", "jade", "a.npz"]),
    ],
)
def test_materials_are_joined_by_commas(texts, materials):
    assert sheet.split(texts) == materials


def test_an_empty_name_is_refused():
    with pytest.raises(InputError, match="an empty name"):
        sheet.split(["jade,,wax"])


def test_rows_are_bodies_and_columns_materials(tmp_path, capsys):
    shutil.copy(tiny.PATH, tmp_path / "other.qgraph")
    out, report = tmp_path / "sheet.png", tmp_path / "report.json"
    bodies = [str(tiny.PATH), str(tmp_path / "other.qgraph")]
    outputs = ["-o", str(out), "--json", str(report)]
    assert cli.main(["sheet", *bodies, "--materials", "ketchup,skimmilk,jade", *FAST, *outputs]) == 0
    assert "2 x 3 pictures" in capsys.readouterr().out
    made = [(each["body"], each["material"]) for each in json.loads(report.read_text())]
    assert made == [(body, material) for body in bodies for material in ("ketchup", "skimmilk", "jade")]
    with Image.open(out) as image:
        shown = np.asarray(image).astype(int)
    gap = contact_sheet.GAP
    assert shown.shape[1] == 3 * 40 + 4 * gap
    height = (shown.shape[0] - 3 * gap) // 2
    for row in range(2):
        top = gap + row * (height + gap) + 12
        cells = [shown[top : top + 6, gap + c * (40 + gap) + 17 : gap + c * (40 + gap) + 23] for c in range(3)]
        red, white, green = (cell.mean(axis=(0, 1)) for cell in cells)
        assert red[0] > 1.4 * red[2]
        assert white.min() > 0.8 * white.max()
        assert green[1] == green.max()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["other.qgraph", "report.json", "sheet.png"]


def test_the_material_is_marble_unless_one_is_asked_for(tmp_path, capsys):
    assert cli.main(["sheet", str(tiny.PATH), *FAST, "-o", str(tmp_path / "a.jpg")]) == 0
    assert "1 x 1 pictures" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--materials", "jade,marbel", "-o", "a.png"], "(did you mean 'marble'?)"),
        (["-o", "a.exr"], "a.exr: output must end in .png, .jpg or .jpeg"),
        (["-o", "a.png", "--size", "9000x9000"], "--size: found 9000x9000 for 1 pictures"),
        (["a.json", "-o", "a.png"], "a.json: a scene names its own material"),
        (["absent.qgraph", "-o", "a.png"], "absent.qgraph"),
    ],
)
def test_what_cannot_be_drawn_is_said(arguments, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert cli.main(["sheet", str(tiny.PATH), *arguments]) == 1
    captured = capsys.readouterr()
    assert said in captured.err
    assert captured.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
