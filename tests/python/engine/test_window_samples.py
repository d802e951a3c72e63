"""The window's picture comes to all its samples frame by frame, and hears the user between them."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
from PIL import Image
from test_window import SIZE, open_window, pytestmark, server

__all__ = ["open_window", "pytestmark", "server"]

LOOK = ["--material", "sigma_s_prime=2,sigma_a=.3/.1/.1,eta=1.3", "--view", "45,15", "--light", "directional:-1,0,0:3"]


def test_the_screen_comes_to_what_is_saved_by_any_curve_balance_and_lens(open_window, tmp_path: Path):
    tone = ["--tone", "agx", "--white-balance", "4200", "--exposure", "0.5"]
    hand = open_window(*LOOK, *tone, "--samples", "12", "--aperture", "0.5")
    seen = hand.picture()
    hand.keys("F12")
    written = tmp_path / "tiny-1.png"
    patience = hand.patience(20)
    while not (written.exists() and written.with_suffix(".exr").exists()) and patience.left():
        time.sleep(0.1)
    with Image.open(written) as image:
        assert image.info["tone"] == "agx"
        assert image.info["white balance"] == "4200 K"
        assert "aperture 0.5 mm" in image.info["camera"]
        shot = np.asarray(image).astype(int)
    assert np.abs(shot - seen).max() <= 1
    assert np.abs(shot[: SIZE[1] - 80] - hand.picture()[: SIZE[1] - 80]).max() <= 1
    hand.close()


def test_it_is_heard_long_before_all_samples_are_there(open_window):
    """Of 16,384 frames, which would take minutes."""
    hand = open_window(*LOOK, "--samples", "65536")
    time.sleep(2)
    patience = hand.patience(20)
    while not (before := hand.look()[: SIZE[1], 340 : SIZE[0]]).any():
        assert patience.left(), "no picture is seen"
        time.sleep(0.05)
    assert hand.busy()
    hand.keys("m")
    patience = hand.patience(20)
    while np.abs(hand.look()[: SIZE[1], 340 : SIZE[0]] - before).max() <= 40:
        assert patience.left(), "the material does not change"
        time.sleep(0.05)
    assert hand.busy()
    hand.close()


def test_a_picture_is_saved_whatever_the_user_does_meanwhile(open_window, tmp_path: Path):
    """Its solve takes a while, and other solves end where a key is pressed."""
    hand = open_window(*LOOK, "--correction", "--sweeps", "1", "--sweep-points", "20000")
    hand.picture()
    hand.keys("m", "F12")
    written = tmp_path / "tiny-1.exr"
    patience = hand.patience(60)
    while not written.exists():
        hand.keys("m")
        assert hand.process.poll() is None, hand.process.communicate()
        assert patience.left(), "the picture is not saved"
        time.sleep(0.1)
    hand.picture()
    hand.close()
