"""Several bodies in the window under a hand: a click chooses the one whose material is changed."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from test_window import PANEL, SIZE, open_window, pytestmark, server
from test_window_panel import TALL, press, put

from quadgraph import Engine
from quadgraph.baking.bodies import BodyMesh, bake_bodies
from quadgraph.baking.pipeline import BakeOptions
from quadgraph.baking.placing import BodyPlacement
from quadgraph.base.errors import InputError
from shapes import icosphere, write_obj

__all__ = ["open_window", "pytestmark", "server"]

LEFT, RIGHT = (PANEL + 140, SIZE[1] // 2), (SIZE[0] - 140, SIZE[1] // 2)  # the middles of the balls
SHAPE, MOVE_Y = 687, 756  # heights of a section to open, and of a slider in it
BESIDE = (PANEL + 40, SIZE[1] - 200)
LOOK = ["--view", "0,0", "--radiance", "lambertian", "--light", "ambient:1", "--no-ground", "--exposure", "0"]
ORANGE = np.array([255, 170, 80])


@pytest.fixture(scope="module")
def balls(tmp_path_factory) -> Path:
    """Two balls beside each other."""
    folder = tmp_path_factory.mktemp("balls")
    mesh = write_obj(icosphere(2, 5.0), folder / "ball.obj")
    bodies = [BodyMesh("left", mesh, unit="mm"), BodyMesh("right", mesh, BodyPlacement((12.0, 0, 0)), "mm")]
    bake_bodies(bodies, folder / "balls.qgraph", BakeOptions(visibility_rays=32))
    return folder / "balls.qgraph"


def click(hand, place: tuple[int, int]) -> None:
    hand.do("mousemove", *map(str, place), "sleep", "0.1", "click", "1", "sleep", "0.2")


def outline(hand) -> np.ndarray:
    """Columns of the screen where the edge of a body is drawn, over some time."""
    patience = hand.patience(20)
    while patience.left():
        drawn = np.abs(hand.look()[: SIZE[1], : SIZE[0]] - ORANGE).max(axis=2) < 8
        if drawn[:, PANEL:].sum() > 100:
            return np.flatnonzero(drawn[:, PANEL:].any(axis=0)) + PANEL
    raise AssertionError("no edge of a body is seen")


def test_a_click_chooses_the_body_whose_material_the_keys_change(open_window, balls, tmp_path: Path):
    """One ball is clicked and gets the next material, then all get it from a click beside them; a drag chooses none."""
    hand = open_window("--material", "wax", *LOOK, body=balls)
    hand.picture()
    click(hand, RIGHT)
    columns = outline(hand)
    assert columns.min() > (LEFT[0] + RIGHT[0]) // 2
    assert columns.max() - columns.min() > 150
    hand.keys("m")
    hand.picture()
    hand.drag(60, 0)
    hand.keys("m", "ctrl+s")
    hand.settle()
    saved = json.loads((tmp_path / "balls-1.json").read_text())
    assert saved["material"] == "wax"
    assert list(saved["materials"]) == ["right"]
    assert saved["materials"]["right"] != "wax"
    hand.keys("Home")
    hand.picture()
    click(hand, BESIDE)
    hand.keys("m", "ctrl+s")
    hand.settle()
    saved = json.loads((tmp_path / "balls-2.json").read_text())
    assert saved["material"] != "wax"
    assert "materials" not in saved or not saved["materials"]
    hand.close()


def test_the_chosen_body_moves_by_a_slider_and_back_by_undo(open_window, balls, tmp_path: Path):
    hand = open_window("--material", "porcelain", *LOOK, body=balls)
    hand.do("windowsize", "--sync", hand.window, str(SIZE[0]), str(TALL))
    hand.picture()
    click(hand, (RIGHT[0], TALL // 2))
    press(hand, SHAPE)

    def heights():
        """Of the middle of the left and of the right ball, rows."""
        seen = hand.screen()[:TALL, PANEL : SIZE[0]].max(axis=2) > 100
        half = seen.shape[1] // 2
        return [np.flatnonzero(part[: TALL - 80].any(axis=1)).mean() for part in (seen[:, :half], seen[:, half:])]

    before = heights()
    assert abs(before[0] - before[1]) < 3
    put(hand, MOVE_Y, "4", "ctrl")
    moved = heights()
    assert moved[0] - moved[1] == pytest.approx(90, abs=10)  # 4 mm of 10 that are 224 pixels
    hand.keys("ctrl+s")
    hand.settle()
    saved = json.loads((tmp_path / "balls-1.json").read_text())
    assert saved["placements"] == {"right": {"position": [0, 4, 0], "rotation": [0, 0, 0]}}
    hand.keys("ctrl+z")
    after = heights()
    assert abs(after[0] - after[1]) < 3
    hand.close()


def test_python_says_which_body_a_pixel_shows(balls):
    with Engine(balls, device="cpu") as engine:
        size = {"width": SIZE[0] - PANEL, "height": SIZE[1]}
        for name, place in (("left", LEFT), ("right", RIGHT), (None, BESIDE)):
            assert engine.body_at(place[0] - PANEL, place[1], "0,0", **size) == name
        assert engine.body_at(RIGHT[0] - PANEL, RIGHT[1], "180,0", **size) == "left"  # from behind
        with pytest.raises(InputError, match="width"):
            engine.body_at(1, 1, width=0)
        with pytest.raises(InputError, match="finite"):
            engine.body_at(float("nan"), 1)
