"""The window's picture goes on converging at rest, and is the quick one again where something moves."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
from PIL import Image
from test_window import PANEL, open_window, pytestmark, server

__all__ = ["open_window", "pytestmark", "server"]

SIZE = (640, 320)  # of the window: a solve that joins the mean draws the picture anew
NOTE = 60  # pixels at the top, where it says how far it has come
LOOK = ["--material", "sigma_s_prime=.4,sigma_a=.05,eta=1.3", "--view", "45,15,6.83", "--light", "directional:-1,0,0:3"]
QUICK = ["--sweep-points", "300", "--samples", "16", "--no-ground", "--exposure", "1", "--background", "black"]
QUICK += ["--radiance", "gathered"]  # whose error it is that the picture comes to


def body_of(hand) -> np.ndarray:
    return hand.look()[NOTE : SIZE[1], PANEL : SIZE[0]]


def wait_for(hand, what: str, seen) -> None:
    patience = hand.patience(60)
    while not seen():
        assert hand.process.poll() is None, hand.process.communicate()
        assert patience.left(), what
        time.sleep(0.1)


def seconds_until(hand, what: str, seen) -> float:
    begun = time.monotonic()
    wait_for(hand, what, seen)
    return time.monotonic() - begun


def test_the_turntable_begins_amid_a_solve_for_the_mean(open_window):
    slow = ["--sweep-points", "40000", "--sweeps", "4", "--samples", "4", "--no-ground", "--radiance", "gathered"]
    hand = open_window(*LOOK, *slow, "--converge", "0.1%", size=SIZE)
    hand.settle()
    settled = body_of(hand)
    solve = seconds_until(hand, "no solve joins the mean", lambda: not np.array_equal(body_of(hand), settled))
    before = body_of(hand)
    hand.keys("t")
    took = seconds_until(hand, "nothing turns", lambda: np.abs(body_of(hand) - before).max() > 60)
    print(f"a solve for the mean takes {solve:.1f} s; turning began after {took:.1f} s")
    assert took < solve / 2
    hand.keys("Escape")
    hand.close()


def test_a_picture_at_rest_goes_on_to_its_error_and_is_saved_with_its_noise(open_window, tmp_path: Path):
    plain = open_window(*LOOK, *QUICK, size=SIZE)
    before = plain.screen()[NOTE : SIZE[1], PANEL : SIZE[0]]
    corner = plain.look()[:NOTE, PANEL : SIZE[0]]
    plain.close()
    hand = open_window(*LOOK, *QUICK, "--converge", "0.1%", size=SIZE)
    wait_for(hand, "no word of convergence", lambda: np.abs(hand.look()[:NOTE, PANEL : SIZE[0]] - corner).max() > 40)
    wait_for(hand, "the picture stays as it was", lambda: not np.array_equal(body_of(hand), before))
    assert not hand.busy()  # the picture that it began with is the settled one
    for number in range(1, 30):
        hand.keys("F12")
        written = tmp_path / f"tiny-{number}.exr"
        wait_for(hand, "nothing is saved", written.exists)
        with Image.open(written.with_suffix(".png")) as image:
            made_by, shot = image.info["transport correction"], np.asarray(image).astype(int)
        if "mean of" in made_by:
            break
        time.sleep(0.5)
    assert "mean of" in made_by
    assert b"standard_error.R" in written.read_bytes()
    lit = before.sum(axis=-1) > 30
    assert lit.any()
    jump = shot[NOTE:][lit].mean() / before[lit].mean()
    assert abs(jump - 1) < 0.01
    hand.keys("Right")
    wait_for(hand, "nothing moves", lambda: np.abs(body_of(hand) - shot[NOTE:]).max() > 40)
    hand.close()
