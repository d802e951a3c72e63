"""`quadgraph compare`: numbers of known differences, pictures side by side, and what cannot be compared."""

from __future__ import annotations

import json

import numpy as np
import OpenEXR
import pytest
from PIL import Image

import tiny
from quadgraph import cli
from quadgraph.commands import contact_sheet, difference

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

FAST = ["--no-correction", "--size", "40x30", "--device", "cpu"]


def write_exr(path, values: np.ndarray):
    """A picture (h, w, 3), float32."""
    head = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(head, {"RGB": values.astype(np.float32)}).write(str(path))
    return path


def gradient() -> np.ndarray:
    """A picture (12, 20, 3) whose left half is dark, rising to the right in the other half."""
    picture = np.zeros((12, 20, 3))
    picture[:, 10:] = np.linspace(0.1, 1, 10)[None, :, None] * [1.0, 0.5, 0.25]
    return picture


def compared(capsys, a, b, *arguments: object) -> dict:
    assert cli.main(["compare", str(a), str(b), "--json", *map(str, arguments)]) == 0
    return json.loads(capsys.readouterr().out)


def test_a_factor_is_the_same_relative_difference_everywhere(tmp_path, capsys):
    a, b = write_exr(tmp_path / "a.exr", gradient()), write_exr(tmp_path / "b.exr", 1.1 * gradient())
    found = compared(capsys, a, b)
    assert found["relative_rms"]["whole"] == pytest.approx(0.1, rel=1e-5)
    assert found["relative_rms"]["dimmest"] == pytest.approx(0.1, rel=1e-5)
    assert (found["size"], found["lit"], found["radiance"]) == ([20, 12], 0.5, True)
    rms = np.sqrt((gradient()[:, 10:] ** 2).mean())
    assert found["most"] == pytest.approx(0.1 / rms, rel=1e-5)
    assert found["where"][0] == 19


def test_the_dimmest_third_is_told_apart():
    a = gradient()
    b = a.copy()
    b[:, 10:13] *= 1.5  # the three dimmest of ten columns that are lit
    found = difference.measure(a, b)
    squares = np.array([1, 4, 9, 16])  # of the four columns up to the quantile
    assert found.dimmest == pytest.approx(np.sqrt(0.25 * squares[:3].sum() / squares.sum()))
    assert found.dimmest > 3 * found.whole
    assert (found.signed[:, 10:13] > 0).all()
    assert not found.signed[:, 13:].any()


def test_a_picture_against_itself_has_no_difference(tmp_path, capsys):
    out = tmp_path / "a.png"
    assert cli.main(["render", str(tiny.PATH), *FAST, "-o", str(out)]) == 0
    capsys.readouterr()
    found = compared(capsys, out, out, "-o", tmp_path / "sheet.png")
    assert found["relative_rms"] == {"whole": 0, "dimmest": 0}
    assert found["radiance"] is False
    with Image.open(tmp_path / "sheet.png") as sheet, Image.open(out) as picture:
        larger = np.asarray(picture.resize((240, 180), Image.Resampling.NEAREST))
        gap = contact_sheet.GAP
        shown = np.asarray(sheet)
        np.testing.assert_array_equal(shown[gap : gap + 180, gap : gap + 240], larger)
        np.testing.assert_array_equal(shown[gap : gap + 180, 2 * gap + 240 : 2 * gap + 480], larger)
        assert sheet.width == 3 * 240 + 4 * gap


def test_bodies_and_scenes_are_rendered_alike(tmp_path, capsys):
    scene = tmp_path / "a.json"
    scene.write_text(json.dumps({"body": str(tiny.PATH), "lights": [{"type": "ambient", "irradiance": 1}]}))
    options = [*FAST, "--material", "skin1", "--light", "ambient:1", "--view", "10,20"]
    found = compared(capsys, tiny.PATH, scene, *options)
    assert found["relative_rms"]["whole"] == 0
    assert found["size"] == [40, 30]
    assert cli.main(["render", str(tiny.PATH), *options, "-o", str(tmp_path / "a.exr")]) == 0
    capsys.readouterr()
    assert compared(capsys, tmp_path / "a.exr", scene, *options)["relative_rms"]["whole"] < 1e-6
    other = compared(capsys, tmp_path / "a.exr", scene, *options, "--material", "marble")
    assert other["relative_rms"]["whole"] > 0.1


def test_files_are_shown_as_they_are_rendered_with_what_is_behind_them(tmp_path):
    options = ["--no-correction", "--size", "240x180", "--device", "cpu", "--exposure", "1"]
    exr, png, sheet = tmp_path / "a.exr", tmp_path / "a.png", tmp_path / "sheet.png"
    # With the ground's light and shadow, and a body that is seen through.
    clear = ["--material", "sigma_s_prime=.01,sigma_a=.01,eta=1.1", "--ground"]
    assert cli.main(["render", str(tiny.PATH), *options, *clear, "-o", str(exr), "-o", str(png)]) == 0
    assert cli.main(["compare", str(exr), str(exr), "--exposure", "1", "-o", str(sheet)]) == 0
    shown, rendered = (np.asarray(Image.open(path).convert("RGB")).astype(int) for path in (sheet, png))
    gap = contact_sheet.GAP
    assert np.abs(shown[gap : gap + 180, gap : gap + 240] - rendered).max() <= 1
    assert _core.read_channels(exr, ["A"]).shape == (180, 240, 1)
    assert _core.read_channels(exr, ["A", "depth.Z"]) is None


def test_an_alpha_that_is_not_a_number_is_refused(tmp_path, capsys):
    path = tmp_path / "a.exr"
    pixels = np.full((12, 20, 4), 0.5, np.float32)
    pixels[3, 4, 3] = np.nan
    head = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(head, {"RGBA": pixels}).write(str(path))
    assert cli.main(["compare", str(path), str(path), "-o", str(tmp_path / "b.png")]) == 1
    assert f"{path}: texel (4, 3): found nan" in capsys.readouterr().err
    assert not (tmp_path / "b.png").exists()


def test_colours_say_which_is_brighter_and_the_bar_how_much():
    low, none, high = difference.coloured(np.array([-2.0, 0, 2.0]), 2.0).astype(int)
    assert low[2] > low[0]
    assert high[0] > high[2]
    assert none.max() < 30
    np.testing.assert_array_equal(difference.coloured(np.array([5.0]), 2.0)[0], high)  # beyond the scale
    np.testing.assert_array_equal(difference.coloured(np.array([5.0]), 1e-320)[0], high)
    bar = difference.bar(240, 0.0125).astype(int)
    row = bar[len(bar) // 2]
    assert (difference.bar(240, 1.2e-4)[:, :3] == contact_sheet.line("", 240, 1)[0, 0]).all()  # no number is cut off
    assert row[75, 2] > row[75, 0]
    assert row[164, 0] > row[164, 2]


def test_people_are_told(tmp_path, capsys):
    a, b = write_exr(tmp_path / "a.exr", gradient()), write_exr(tmp_path / "b.exr", 1.1 * gradient())
    out = tmp_path / "c.jpg"
    assert cli.main(["compare", str(a), str(b), "--scale", "0.05", "-o", str(out)]) == 0
    said = capsys.readouterr().out
    assert "relative RMS: 10% whole, 10% dimmest third of the 50% of pixels that are lit" in said
    assert f"comparison: {out}" in said
    with Image.open(out) as sheet:
        assert sheet.format == "JPEG"


def test_a_sheet_that_is_too_large_is_refused_and_numbers_are_told(tmp_path, monkeypatch, capsys):
    a = write_exr(tmp_path / "a.exr", gradient())
    monkeypatch.setattr(contact_sheet, "MOST_PIXELS", 3 * 12 * 20 - 1)
    assert cli.main(["compare", str(a), str(a), "-o", str(tmp_path / "b.png")]) == 1
    assert "three pictures of 20x12 pixels, a sheet has room for 719 in all" in capsys.readouterr().err
    assert compared(capsys, a, a)["most"] == 0


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["a.exr", "a.png"], "one is radiance, the other tone mapped"),
        (["a.exr", "small.exr"], "20x12 and 4x4 pixels, the same size is wanted"),
        (["black.exr", "a.exr"], "black all over"),
        (["a.exr", "a.exr", "-o", "c.exr"], "c.exr: output must end in .png, .jpg or .jpeg"),
        (["a.png", "a.png", "-o", "a.png"], "is read"),
        (["a.exr", "a.exr", "--material", "jade"], "--material: found with two pictures"),
        (["a.exr", "absent.exr"], "absent.exr"),
        (["a.exr", "a.txt"], "a.txt"),
    ],
)
def test_what_cannot_be_compared_is_said(arguments, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write_exr(tmp_path / "a.exr", gradient())
    write_exr(tmp_path / "black.exr", 0 * gradient())
    write_exr(tmp_path / "small.exr", gradient()[:4, -4:])
    Image.new("RGB", (20, 12), "white").save("a.png")
    before = sorted(path.name for path in tmp_path.iterdir())
    assert cli.main(["compare", *arguments]) == 1
    captured = capsys.readouterr()
    assert said in captured.err
    assert captured.err.count("\n") == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == before
