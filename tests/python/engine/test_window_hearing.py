"""The window hears while it computes: what a hand does is answered amid a solve at rest, not when that has ended."""

from __future__ import annotations

import json
import signal
import time
from pathlib import Path

import numpy as np
import pytest
from test_window import FIELD, PANEL, SIZE, Hand, open_window, pytestmark, server

from baked import write_levels
from shapes import icosphere

__all__ = ["open_window", "pytestmark", "server"]

LOOK = ["--view", "0,0", "--no-ground", "--radiance", "lambertian", "--light", "directional:0,0,-1:1"]
KEYS = 6


@pytest.fixture
def hand(open_window, tmp_path: Path) -> Hand:
    """A window whose solves at rest take seconds: with many points, in few draws."""
    body = write_levels(tmp_path / "ball.qgraph", [icosphere(4, 10), icosphere(3, 10)])
    return open_window("--material", "skin1", "--sweep-points", "150000", "--sweeps", "2", *LOOK, body=body)


def time_of_solve(hand: Hand) -> float:
    """Seconds from a key that changes the light until the picture has converged."""
    hand.settle()
    start = time.monotonic()
    hand.keys("bracketright")
    hand.settle()
    return time.monotonic() - start


def wait_until(seen, hand: Hand, what: str) -> None:
    patience = hand.patience(60)
    while not seen():
        assert hand.process.poll() is None, hand.process.communicate()
        assert patience.left(), what
        time.sleep(0.005)


def middle(hand: Hand) -> np.ndarray:
    """Where the shortcuts are shown, in its part of the picture that is not on the body."""
    return hand.look()[60 : SIZE[1] - 60, PANEL + 20 : PANEL + 80]


def begin_solve(hand: Hand) -> None:
    """Change the light, and wait until its solve at rest has begun: a quarter of a second after the last change."""
    hand.keys("bracketleft")
    wait_until(hand.busy, hand, "no solve begins")
    time.sleep(0.5)


def test_keys_are_answered_amid_a_solve_and_do_not_end_it(hand: Hand):
    """Six of them, each seen before the next, take less than the one solve that is being made: to wait for the end of
    a solve takes a whole one for each, and so does one that begins anew after each key, however slow the machine is.
    """
    whole = time_of_solve(hand)
    begin_solve(hand)
    plain = middle(hand)
    start = time.monotonic()
    for number in range(KEYS):
        hand.keys("F1")
        shown = number % 2 == 0
        wait_until(lambda shown=shown: np.array_equal(middle(hand), plain) != shown, hand, "F1 is not heard")
        assert hand.busy()  # the solve goes on
    taken = time.monotonic() - start
    print(f"\n{1000 * taken / KEYS:.0f} ms a key, {whole:.1f} s a solve")
    assert taken < whole
    hand.calm()
    hand.close()


def test_what_is_changed_amid_a_solve_is_done_at_once(hand: Hand, tmp_path: Path):
    """The eye goes round, and the scene is saved from there, in less time than the solve takes that this ends."""
    whole = time_of_solve(hand)
    begin_solve(hand)
    start = time.monotonic()
    hand.keys(*["Right"] * KEYS, "ctrl+s")
    saved = tmp_path / "ball-1.json"
    wait_until(saved.exists, hand, "the scene is not saved")
    assert time.monotonic() - start < whole
    assert json.loads(saved.read_text())["camera"]["azimuth"] == pytest.approx(-7.5 * KEYS)
    hand.calm()
    hand.close()


def test_what_is_done_while_a_picture_is_begun_stays_in_its_order(hand: Hand, tmp_path: Path):
    """F12 comes together with a click into a field: what follows amid the solve of the picture is typed."""
    hand.do("mousemove", "150", str(FIELD))
    hand.settle()
    hand.process.send_signal(signal.SIGSTOP)
    typed = ["ctrl+a", *"marble", "Return"]
    hand.do("keydown", "F12", "mousedown", "1", "mouseup", "1", "keyup", "F12", "key", *typed)
    hand.process.send_signal(signal.SIGCONT)
    hand.settle()
    hand.keys("Escape", "ctrl+s")
    wait_until((tmp_path / "ball-1.json").exists, hand, "nothing is saved")
    assert json.loads((tmp_path / "ball-1.json").read_text())["material"] == "marble"
    hand.close()
