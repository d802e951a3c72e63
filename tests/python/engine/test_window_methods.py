"""Every method in one window: key G while a hand goes on turning the light, and cuts by the knife."""

from __future__ import annotations

import json
import time
from pathlib import Path

import numpy as np
from test_window import PANEL, SIZE, Hand, open_window, pytestmark, server

import grids

__all__ = ["open_window", "pytestmark", "server"]

METHODS = ("fem", "quadgraph-fv", "quadgraph-fdm", "polygrid", "polygrid-divergence", "shortest-path")
ACROSS = 340  # pixels of a drag that takes the light from 50 degrees right of the eye to as far left of it
BRIGHTER = 1.5  # times the other side


def sides(picture: np.ndarray) -> tuple[float, float]:
    """Mean brightness left and right of the ball's middle, half a radius and more away from it."""
    row, column = picture.shape[0] // 2, picture.shape[1] // 2
    rows = slice(row - 60, row + 60)
    return picture[rows, column - 200 : column - 110].mean(), picture[rows, column + 110 : column + 200].mean()


def wait_for_light(hand: Hand, left: bool) -> np.ndarray:
    """The first picture whose brighter side is that one."""
    patience = hand.patience(60)
    while True:
        picture = hand.look()[: SIZE[1], PANEL : SIZE[0]]  # settled or not
        dark, bright = sides(picture)[:: -1 if left else 1]
        if bright > BRIGHTER * dark:
            return picture
        assert patience.left(), f"the bright side does not follow the light: {sides(picture)}"


def written(folder: Path, number: int) -> dict:
    """The scene that Ctrl+S writes."""
    path = folder / f"polygrid-{number}.json"
    deadline = time.monotonic() + 20
    while not path.exists():
        assert time.monotonic() < deadline, f"{path.name} is not written"
        time.sleep(0.05)
    return json.loads(path.read_text())


def test_one_key_goes_through_all_methods_while_the_light_is_dragged(open_window, tmp_path: Path):
    """On one body, a polygrid's file; in a single drag the light swings to the other side with every method."""
    look = ["--view", "0,0", "--no-ground", "--exposure", "-1", "--path-cells", "24"]
    light = ["--light", "directional:-0.766,0,-0.643:1"]
    hand = open_window("--material", "sigma_s_prime=2,sigma_a=.3,eta=1.3", *look, *light, body=grids.PATH)
    hand.settle()
    wait_for_light(hand, left=False)
    middle = PANEL + (SIZE[0] - PANEL) // 2, SIZE[1] // 2
    hand.do("mousemove", *map(str, middle), "keydown", "ctrl", "mousedown", "1", "sleep", "0.1", "keyup", "ctrl")
    pictures = {}
    for number, method in enumerate(METHODS):
        if number > 0:
            hand.keys("g")
        left = number % 2 == 0
        hand.do("mousemove_relative", "--", str(-ACROSS if left else ACROSS), "0")
        pictures[method] = wait_for_light(hand, left)
        hand.keys("ctrl+s")
        assert written(tmp_path, number + 1)["solver"].get("method", "fem") == method
    hand.do("mouseup", "1")
    last = hand.picture()
    assert sides(last)[1] > BRIGHTER * sides(last)[0]  # an even number of turns
    hand.keys("g")
    assert not np.array_equal(hand.picture(), last)  # linear elements again
    hand.keys("ctrl+s")
    assert written(tmp_path, len(METHODS) + 1)["solver"].get("method", "fem") == "fem"
    for one, other in (("fem", "quadgraph-fdm"), ("fem", "polygrid-divergence"), ("polygrid", "shortest-path")):
        found = [pictures[name] for name in (one, other)]
        mirrored = METHODS.index(one) % 2 != METHODS.index(other) % 2
        assert np.abs(found[0] - (found[1][:, ::-1] if mirrored else found[1])).max() > 8
    hand.close()


def test_the_knife_cuts_along_a_stroke_and_undo_heals(open_window, tmp_path: Path):
    """Downwards from the middle of a ball: what lies to the right of the hand's way is the half to the left.

    Paths are equal to rounding, pictures therefore to a code, whatever was relaxed first.
    """
    look = ["--view", "0,0", "--no-ground", "--exposure", "-1", "--path-cells", "24", "--method", "shortest-path"]
    light = ["--light", "directional:-0.1,0,-1:1"]
    hand = open_window("--material", "sigma_s_prime=2,sigma_a=.3,eta=1.3", *look, *light, body=grids.PATH)
    whole = hand.picture()
    hand.keys("k")
    hand.drag(0, 200)
    cut = hand.picture()
    column = whole.shape[1] // 2
    changed = np.abs(cut - whole).max(axis=2) > 8
    ball = np.abs(whole - whole[5, 5]).max(axis=2) > 60
    assert ball[:, : column - 5].any()
    assert changed[:, : column - 5][ball[:, : column - 5]].mean() > 0.9
    assert changed[:, column + 60 :].mean() < 0.02  # far from the cut the other half is as it was
    hand.keys("ctrl+z")
    assert np.abs(hand.picture() - whole).max() <= 1
    hand.drag(0, 3)  # a slip of the hand
    assert np.abs(hand.picture() - whole).max() <= 1
    hand.drag(0, 200)
    assert np.abs(hand.picture() - cut).max() <= 1
    hand.keys("ctrl+s")
    found = written(tmp_path, 1)["cuts"]
    assert [each["type"] for each in found] == ["plane"]
    assert np.allclose(found[0]["normal"], [-1, 0, 0], atol=1e-3)
    hand.close()
