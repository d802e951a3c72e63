"""`quadgraph materials`: numbers of the published table, and swatches that show what the numbers say."""

from __future__ import annotations

import json

import numpy as np
import pytest
import trimesh
from PIL import Image

import tiny
from quadgraph import cli
from quadgraph.commands import contact_sheet, reference_body

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

FAST = ["--body", str(tiny.PATH), "--no-correction", "--size", "40x30", "--device", "cpu"]


def test_json_has_all_names_with_their_coefficients_and_source(capsys):
    assert cli.main(["materials", "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)
    assert [each["name"] for each in listed] == _core.material_names()
    marble = next(each for each in listed if each["name"] == "marble")
    assert marble["sigma_s_prime"] == pytest.approx([2.19, 2.62, 3.00])
    assert marble["sigma_a"] == pytest.approx([0.0021, 0.0041, 0.0071])
    assert marble["mean_free_path"] == pytest.approx([1 / 2.1921, 1 / 2.6241, 1 / 3.0071])
    assert (marble["eta"], marble["pattern"]) == (pytest.approx(1.5), "none")
    measured = [each["name"] for each in listed if each["source"].startswith("measured: Jensen et al. 2001")]
    assert len(measured) == 12
    assert not any(each["source"].startswith("measured") for each in listed if each["name"] not in measured)
    assert next(each["roughness"] for each in listed if each["name"] == "porcelain") == pytest.approx(0.06)
    assert marble["roughness"] is None
    jade = next(each for each in listed if each["name"] == "jade")
    assert jade["mean_free_path"] == pytest.approx([0.8] * 3, rel=1e-5)
    assert jade["second_mean_free_path"] == pytest.approx([0.6] * 3, rel=1e-5)


def test_the_table_cuts_no_number_off(capsys):
    assert cli.main(["materials", "cream", "jade"]) == 0
    text = capsys.readouterr().out
    for words in ("7.38/5.47/3.15", "0.0002/0.0028/0.0163", "clouds", "Jensen et al. 2001, Figure 5", "made up"):
        assert words in text
    assert "apple" not in text


def test_a_sheet_has_a_swatch_for_each_in_its_colour(tmp_path, capsys):
    out = tmp_path / "sheet.png"
    assert cli.main(["materials", "ketchup", "skimmilk", *FAST, "--light", "ambient:1", "-o", str(out)]) == 0
    assert f"swatches: {out}" in capsys.readouterr().out
    with Image.open(out) as image:
        sheet = np.asarray(image.convert("RGB")).astype(int)
    gap = contact_sheet.GAP
    assert sheet.shape[1] == 2 * 40 + 3 * gap
    middle = sheet[gap + 10 : gap + 20]
    red, white = middle[:, gap + 15 : gap + 25], middle[:, 40 + 2 * gap + 15 : 40 + 2 * gap + 25]
    assert red[..., 0].mean() > 2 * red[..., 2].mean()
    assert white[..., 2].mean() > 0.7 * white[..., 0].mean()
    assert (sheet[gap + 30 :] != contact_sheet.GROUND).any()  # words


def test_a_colour_has_a_swatch_and_the_numbers_behind_it(tmp_path, capsys):
    out, text = tmp_path / "green.png", "reflectance=0.1/0.5/0.1,mean_free_path=0.5"
    assert cli.main(["materials", text, *FAST, "--light", "ambient:1", "-o", str(out), "--json"]) == 0
    (found,) = json.loads(capsys.readouterr().out)
    assert found["mean_free_path"] == pytest.approx([0.5] * 3, rel=1e-5)
    assert found["source"].startswith("own")
    with Image.open(out) as image:
        middle = np.asarray(image.convert("RGB")).astype(int)[20:26, 20:26].mean(axis=(0, 1))
    assert middle[1] > 1.3 * middle[0]
    assert middle[1] > 1.3 * middle[2]


def test_a_sheet_of_sizes_has_a_column_for_each(tmp_path):
    mesh, out = tmp_path / "cube.off", tmp_path / "sheet.png"
    trimesh.creation.box().export(mesh)
    fast = ["--body", str(mesh), *FAST[2:], "--light", "ambient:1", "-o", str(out)]
    assert cli.main(["materials", "gummy", "milk", "--sizes", "3mm,30cm", *fast]) == 0
    with Image.open(out) as image:
        sheet = np.asarray(image.convert("RGB")).astype(int)
    gap = contact_sheet.GAP
    assert sheet.shape[1] == 2 * 40 + 3 * gap
    thin, thick = (sheet[gap + 13 : gap + 18, left + 18 : left + 23] for left in (gap, 40 + 2 * gap))
    assert thick[..., 1].mean() < 0.6 * thin[..., 1].mean()  # green goes in the depth


def test_a_sheet_of_bodies_has_a_column_for_each(tmp_path):
    out = tmp_path / "sheet.png"
    assert cli.main(["materials", "milk", *FAST, *FAST[:2], "--light", "ambient:1", "-o", str(out)]) == 0
    with Image.open(out) as image:
        assert image.width == 2 * 40 + 3 * contact_sheet.GAP


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["-o", "a.png", "--size", "big"], "--size: found 'big', expected WIDTHxHEIGHT"),
        (["-o", "a.exr"], "a.exr: output must end in .png, .jpg or .jpeg"),
        (["-o", "a.png", "--size", "9000x9000"], "--size: found 9000x9000 for 31 pictures, allowed are"),
        (["-o", "a.png", "--unit", "mm"], "found without --body"),
        (["-o", "a.png", "--body", "absent.qgraph"], "absent.qgraph"),
        (["-o", "a.png", "--sizes", "9mm", "--body", "a.qgraph"], "--sizes: found with a.qgraph"),
        (["-o", "a.png", "--sizes", "9mm", "--body", "a.ply", "--longest", "8mm"], "--sizes: found beside"),
        (["marbel"], "did you mean 'marble'?"),
    ],
)
def test_what_cannot_be_drawn_is_said_before_any_work(arguments, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert cli.main(["materials", *arguments]) == 1
    captured = capsys.readouterr()
    assert said in captured.err
    assert captured.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_the_body_of_swatches_is_closed_and_symmetric():
    surface = reference_body.surface()
    assert not len(surface.topology.boundary)
    assert not len(surface.topology.non_manifold)
    assert surface.topology.balance.any() == 0
    assert (np.einsum("ij,ij->i", surface.doubled_normals, surface.corners.mean(axis=1)) > 0).mean() > 0.99


def test_words_are_fitted_with_dots_in_their_middle():
    shown = contact_sheet.fitted("a material with a name that has no room at all", 120, 12)
    assert "..." in shown
    assert contact_sheet.font(12).getlength(shown) <= 120
    assert shown.startswith("a")
    assert shown.endswith("l")
    assert contact_sheet.fitted("short", 120, 12) == "short"


def test_grids_leave_few_places_empty():
    for count in range(1, 40):
        columns = contact_sheet.columns_of(count)
        rows = -(-count // columns)
        assert rows * columns - count < max(columns, 2)
        assert rows <= columns + 2
