"""The window's mode Look under a hand: a file that is typed, before and after, the turntable, paint; the mode Lab."""

from __future__ import annotations

import json
import time
from pathlib import Path

import numpy as np
from test_window import PANEL, QUICK_SCENE, SIZE, Hand, open_window, pytestmark, server

import tiny
from baked import write_levels
from shapes import icosphere

__all__ = ["open_window", "pytestmark", "server"]

OPEN, FILE = 158, 183  # a section to open, and the name in it
PAINT, ERASE = 462, 512  # a section to open, and the row of its tools
LOOK = ["--no-ground", "--exposure", "1", "--light", "directional:0,0,-1:1", "--light", "ambient:.3"]
ABOVE_MESSAGE = np.s_[: SIZE[1] - 110]


def click(hand: Hand, x: int, y: int) -> None:
    hand.calm()
    hand.do("mousemove", str(x), str(y), "click", "1", "sleep", "0.3")


def type_file(hand: Hand, name: str) -> None:
    """Into the section Open, which is open."""
    click(hand, 100, FILE)
    hand.keys("ctrl+a")
    hand.do("type", "--delay", "20", name)
    hand.keys("Return")


def test_a_scene_that_is_typed_is_opened_and_what_is_none_changes_nothing(open_window, tmp_path: Path):
    picture = QUICK_SCENE["picture"] | {"exposure": 1}
    scene = {"body": str(tiny.PATH), "material": "jade", "camera": {"azimuth": 70}, **QUICK_SCENE, "picture": picture}
    (tmp_path / "jade.json").write_text(json.dumps(scene))
    (tmp_path / "torn.json").write_text("{")
    plain = open_window(body=tmp_path / "jade.json")
    wanted = plain.picture()
    plain.close()
    hand = open_window("--material", "wholemilk", *LOOK)
    before = hand.picture()
    click(hand, 100, OPEN)
    for wrong in ("torn.json", "none.qgraph", "notes.txt"):
        type_file(hand, wrong)
        told = hand.other_picture(before)
        assert np.abs(told[-60:, :400] - before[-60:, :400]).max() > 60
        assert np.abs(told[ABOVE_MESSAGE] - before[ABOVE_MESSAGE]).max() <= 1
    hand.keys("Escape", "m")
    hand.other_picture(told)
    type_file(hand, "jade.json")  # asks, for the material is not saved
    hand.settle()
    hand.keys("d")
    opened = hand.other_picture(told)
    patience = hand.patience(20)
    while np.abs(opened - wanted).max() > 1 and patience.left():
        opened = hand.picture()
    assert np.abs(opened - wanted).max() <= 1
    assert hand.do("getwindowname", hand.window).startswith("jade.json - QuadGraph")
    hand.keys("m")
    changed = hand.other_picture(opened)
    hand.keys("q")  # the answer was for the file
    assert not np.array_equal(hand.other_picture(changed), changed)
    hand.close()


def test_before_is_seen_while_its_key_is_held(open_window):
    hand = open_window("--material", "wholemilk", *LOOK)
    before = hand.picture()
    hand.keys("m")
    after = hand.other_picture(before)
    hand.do("keydown", "c")
    held = hand.other_picture(after)
    assert np.abs(held[60:] - before[60:]).max() <= 1  # below the words that say so
    hand.do("keyup", "c")
    assert np.abs(hand.other_picture(held) - after).max() <= 1
    hand.close()


def test_the_turntable_turns_until_it_is_left(open_window, tmp_path: Path):
    hand = open_window("--material", "wholemilk", "--view", "0,15", *LOOK)
    hand.picture()
    hand.keys("t")
    seen = []
    patience = hand.patience(60)
    while len(seen) < 4:
        now = hand.look()[: SIZE[1], PANEL : SIZE[0]]
        if not any(np.array_equal(now, one) for one in seen):
            seen.append(now)
        assert patience.left(), "nothing turns"
    hand.keys("Escape", "ctrl+s")
    saved = tmp_path / "tiny-1.json"
    while not saved.exists():
        assert patience.left(), "the scene is not saved"
        time.sleep(0.05)
    assert json.loads(saved.read_text())["camera"]["azimuth"] != 0
    still = hand.picture()
    assert np.array_equal(hand.picture(), still)
    hand.keys("Escape")  # a turned view is nothing to ask for
    assert hand.process.wait(timeout=20) == 0


def test_paint_is_red_where_it_is_put_and_erased_where_it_is_touched(open_window, tmp_path: Path):
    body = write_levels(tmp_path / "ball.qgraph", [icosphere(4, 10), icosphere(3, 10)])
    hand = open_window("--material", "wholemilk", "--view", "0,0", *LOOK, body=body)
    before = hand.picture()
    hand.keys("p")
    hand.drag(60, 0)
    hand.do("mousemove", "350", "10")  # the ring is where the pointer is
    painted = hand.other_picture(before)
    row, column = before.shape[0] // 2, before.shape[1] // 2
    stroke = np.s_[row - 3 : row + 3, column + 10 : column + 50]
    red, green, _ = painted[stroke].reshape(-1, 3).mean(axis=0)
    assert red > 1.5 * green
    click(hand, 100, PAINT)
    click(hand, 90, ERASE)
    hand.do("mousemove", str(PANEL + column + 30), str(row), "click", "1", "sleep", "0.3", "mousemove", "350", "10")
    assert np.abs(hand.other_picture(painted) - before).max() <= 1
    hand.keys("Escape")
    hand.close()


def test_lab_has_more_than_look(open_window):
    """Another panel beside the same picture, and the same panel again after a way back."""
    hand = open_window("--material", "wholemilk", *LOOK)
    look = hand.screen()[: SIZE[1], : SIZE[0]]
    click(hand, 84, 58)
    lab = hand.screen()[: SIZE[1], : SIZE[0]]
    below = np.s_[150:, :PANEL]
    assert (np.abs(lab[below] - look[below]).max(axis=2) > 40).mean() > 0.05
    assert np.array_equal(lab[:, PANEL:], look[:, PANEL:])
    click(hand, 24, 58)
    again = hand.screen()[: SIZE[1], : SIZE[0]]
    assert np.array_equal(again[below], look[below])
    hand.close()
