"""The printed board: its true size in every kind of file, found again where it was drawn, and refused where wrong."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from quadgraph.acquisition.board import corners, drawing
from quadgraph.acquisition.board.board import Board
from quadgraph.cli import main

pytest.importorskip("cv2", reason="OpenCV is not installed: pip install 'quadgraph[capture]'")

HOLLOW = Board(hollow=(3, 3))
DOTS = 8  # a mm


def rectangles(path: Path) -> tuple[list[tuple[float, ...]], tuple[float, float]]:
    """Rectangles x, y, width, height, mm from the upper left, with their grey; and the page's size, mm."""
    text = path.read_bytes().decode("latin-1")
    number = r"([-\d.]+)"
    if path.suffix == ".svg":
        size = re.search(rf'width="{number}mm" height="{number}mm"', text)
        box = rf'<rect x="{number}" y="{number}" width="{number}" height="{number}"( fill="#fff")?/>'
        found = re.findall(box, text)
        return [(*map(float, each[:4]), 1.0 if each[4] else 0.0) for each in found], (float(size[1]), float(size[2]))
    mm = 25.4 / 72
    box = re.search(rf"/MediaBox \[0 0 {number} {number}\]", text)
    high = float(box[2]) * mm
    result = []
    for grey, *corner in re.findall(rf"^([01]) g {number} {number} {number} {number} re f$", text, re.MULTILINE):
        x, y, w, h = (float(each) * mm for each in corner)
        result.append((x, high - y - h, w, h, float(grey)))
    return result, (float(box[1]) * mm, high)


def drawn(path: Path) -> np.ndarray:
    """The page as a picture, DOTS a mm."""
    if path.suffix == ".png":
        picture = Image.open(path)
        assert picture.info["dpi"][0] == pytest.approx(600, abs=0.01)
        size = [round(side / 600 * 25.4 * DOTS) for side in picture.size]
        return np.asarray(picture.resize(size, Image.Resampling.BOX), float) / 255
    found, (width, height) = rectangles(path)
    page = np.ones((round(height * DOTS), round(width * DOTS)))
    for x, y, w, h, grey in found:
        page[round(y * DOTS) : round((y + h) * DOTS), round(x * DOTS) : round((x + w) * DOTS)] = grey
    return page


@pytest.mark.parametrize("suffix", [".pdf", ".svg", ".png"])
def test_the_drawn_board_is_found_where_it_is_drawn(tmp_path, suffix):
    path = tmp_path / f"board{suffix}"
    assert main(["capture", "board", "-o", str(path), "--hollow", "3x3", "--page", "letter"]) == 0
    found = corners.find(HOLLOW, drawn(path))
    assert len(found.numbers) >= 36 - 4 * 4 + 8  # all but those of the hollow
    # True size: places are those of the board, moved.
    flat = HOLLOW.corners()[found.numbers] * [1, -1, 1]
    off = found.places / DOTS - flat[:, :2]
    assert np.abs(off - off.mean(axis=0)).max() < 0.03
    left, top = off.mean(axis=0) - [0, HOLLOW.size[1]]
    assert left == pytest.approx((215.9 - 175 - 11) / 2, abs=0.6 / DOTS)
    assert 5 < top < 279.4 - HOLLOW.size[1] - 5


@pytest.mark.parametrize("suffix", [".pdf", ".svg"])
def test_rulers_are_as_long_as_they_say(tmp_path, suffix):
    path = tmp_path / f"board{suffix}"
    drawing.write(path, drawing.page_of(Board(), "a4"), "board")
    found, size = rectangles(path)
    np.testing.assert_allclose(size, (210, 297), atol=1e-3)
    thin = np.array([each for each in found if min(each[2:4]) < 0.5])
    for across in (0, 1):
        ticks = thin[thin[:, 2 + across] < 0.5]
        middles = np.sort(ticks[:, across] + ticks[:, 2 + across] / 2)
        assert len(middles) == 151
        np.testing.assert_allclose(middles - middles[0], np.arange(151), atol=2e-3)


def test_the_page_says_what_it_is(tmp_path):
    path = tmp_path / "board.pdf"
    drawing.write(path, drawing.page_of(HOLLOW, "a4"), "board")
    text = path.read_bytes().decode("latin-1")
    assert "QuadGraph board 7x9, square 25 mm, marker 18 mm, dictionary 5x5_50, hollow 3x3." in text
    assert "Check: each ruler is 150 mm." in text
    start = int(text.rsplit("startxref\n", 1)[1].split("\n")[0])
    assert text[start:].startswith("xref\n0 7\n")
    for number, line in enumerate(text[start:].split("\n")[3:9], 1):
        assert text[int(line[:10]) :].startswith(f"{number} 0 obj")


def test_rulers_that_measure_otherwise_scale_the_board():
    shrunk = Board(printed=(147.0, 148.5))
    np.testing.assert_allclose(shrunk.corners(), Board().corners() * [0.98, 0.99, 1], rtol=1e-12)


WRONG = [
    (["--squares", "2x9"], "columns: found 2, allowed are 3 to 40"),
    (["--marker", "24"], "marker: found 24, allowed are 10 to 23.75 mm"),
    (["--dictionary", "8x8"], "dictionary: found 8x8, allowed are 4x4_50"),
    (["--squares", "12x12", "--square", "14", "--marker", "10"], "72 markers wanted, 5x5_50 has 50"),
    (["--hollow", "4x3"], "hollow: found 4 columns of 7"),
    (["--square", "30", "--marker", "20"], "board of 210 x 270 mm found, a4 has room for"),
]


@pytest.mark.parametrize(("options", "said"), WRONG)
def test_a_board_that_cannot_be_is_refused(tmp_path, capsys, options, said):
    assert main(["capture", "board", "-o", str(tmp_path / "board.pdf"), *options]) == 1
    assert said in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_other_endings_are_refused(tmp_path, capsys):
    assert main(["capture", "board", "-o", str(tmp_path / "board.jpg")]) == 1
    assert "output must end in .pdf, .svg, .png" in capsys.readouterr().err


def test_without_opencv_the_extra_is_named(tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "cv2", None)
    assert main(["capture", "board", "-o", str(tmp_path / "board.pdf")]) == 1
    assert "pip install 'quadgraph[capture]'" in capsys.readouterr().err


def test_a_photograph_without_a_board_has_no_corners():
    noise = np.random.default_rng(0).uniform(size=(200, 300))
    assert not len(corners.find(Board(), noise).numbers)
    assert not len(corners.find(Board(), np.zeros((200, 300))).numbers)
