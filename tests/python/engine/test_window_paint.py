"""The window's layers of strokes and its mirror under a hand: what is painted, hidden, and seen on the other side."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from test_window import PANEL, SIZE, open_window, pytestmark, server
from test_window_panel import PAINT, RADIUS, TALL, press, put

from baked import write_levels
from shapes import icosphere

__all__ = ["open_window", "pytestmark", "server"]

MIRROR, LEFT_RIGHT = 712, 758  # the list of mirrors, and an entry of it while it is open
ADD_SECOND, EYE_OF_TOP = 806, (36, 766)  # the button while there is one layer; an eye of the list
BEFORE_MESSAGE = np.s_[: TALL - 80]


def test_two_layers_are_painted_and_one_is_hidden_and_shown(open_window, tmp_path: Path):
    """A stroke on both sides of a ball in one layer, one across its middle in another, which is hidden and shown."""
    body = write_levels(tmp_path / "ball.qgraph", [icosphere(3, 10), icosphere(2, 10)])
    look = ["--view", "0,0", "--radiance", "lambertian", "--light", "directional:0,0,-1:1", "--light", "ambient:.3"]
    hand = open_window("--material", "wholemilk", "--exposure", "1", "--no-ground", *look, body=body)
    hand.do("windowsize", "--sync", hand.window, str(SIZE[0]), str(TALL))
    middle = PANEL + (SIZE[0] - PANEL) // 2, TALL // 2

    def picture() -> np.ndarray:
        return hand.screen()[:TALL, PANEL : SIZE[0]]

    def stroke(right: int, down: int) -> None:
        """So far from the middle of the ball, 40 pixels downwards."""
        hand.do("mousemove", str(middle[0] + right), str(middle[1] + down), "sleep", "0.2", "mousedown", "1")
        hand.do("sleep", "0.2", "mousemove_relative", "0", "40", "sleep", "0.2", "mouseup", "1")
        hand.do("mousemove", "100", "20")  # no ring on the body

    def painted(now: np.ndarray, before: np.ndarray, right: int, down: int) -> float:
        """How much less green and blue there is about that stroke."""
        rows = np.s_[middle[1] + down : middle[1] + down + 40]
        column = middle[0] - PANEL + right
        return float((before - now)[rows, column - 8 : column + 8, 1:].mean())

    press(hand, PAINT)
    put(hand, RADIUS, "2", "ctrl")
    press(hand, MIRROR)
    press(hand, LEFT_RIGHT)
    before = picture()
    hand.keys("p")
    stroke(100, -20)
    both = picture()
    assert painted(both, before, 100, -20) > 40
    assert painted(both, before, -100, -20) > 0.6 * painted(both, before, 100, -20)
    assert painted(both, before, 0, -20) < 0.5 * painted(both, before, 100, -20)
    hand.do("mousemove", "27", str(ADD_SECOND), "click", "1", "sleep", "0.3")
    stroke(0, -100)
    whole = picture()
    assert painted(whole, before, 0, -100) > 40
    hand.do("mousemove", *map(str, EYE_OF_TOP), "click", "1", "sleep", "0.3")
    assert np.abs(hand.other_picture(whole[: SIZE[1]]) - both[: SIZE[1]]).max() <= 1
    hand.do("mousemove", *map(str, EYE_OF_TOP), "click", "1", "mousemove", "100", "20", "sleep", "0.3")
    assert np.abs(picture() - whole).max() <= 1
    hand.keys("ctrl+s")
    hand.settle()
    lower, upper = json.loads((tmp_path / "ball-1.json").read_text())["edits"]
    assert (lower["name"], upper["name"], upper["visible"]) == ("Layer 1", "Layer 2", True)
    (sides,) = lower["edits"]
    assert len(sides["stroke"]) > 1
    here, there = np.array(sides["stroke"]), np.array(sides["mirrored"]["stroke"])
    assert np.allclose(there, here * [-1, 1, 1], atol=0.2)  # the icosphere's faces have no mirror image
    assert np.allclose(np.linalg.norm(there, axis=1), 10, atol=0.15)
    hand.keys("ctrl+z", "ctrl+z", "ctrl+z", "ctrl+z", "ctrl+z")
    assert np.abs(picture()[BEFORE_MESSAGE] - before[BEFORE_MESSAGE]).max() <= 1
    hand.close()
