"""The window hears while it computes: what a hand does is answered amid a solve at rest, not when that has ended."""

from __future__ import annotations

import contextlib
import ctypes
import json
import signal
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from test_window import FIELD, PANEL, SIZE, Hand, Server, display, pytestmark, server

from baked import write_levels
from shapes import icosphere

__all__ = ["pytestmark", "server"]

LOOK = ["--view", "0,0", "--no-ground", "--radiance", "lambertian", "--light", "directional:0,0,-1:1"]
KEYS = 6


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the window saves."""
    return tmp_path_factory.mktemp("hearing")


@contextlib.contextmanager
def ended(opened: Hand) -> Iterator[Hand]:
    """A window that ends with the tests, well where they did."""
    try:
        yield opened
        opened.close()
    finally:
        opened.process.kill()
        opened.process.communicate()


@pytest.fixture(scope="module")
def hand(server: Server, folder: Path) -> Iterator[Hand]:
    """A window for all tests, whose solves at rest take seconds: with many points, in few draws."""
    body = write_levels(folder / "ball.qgraph", [icosphere(4, 10), icosphere(3, 10)])
    options = ("--material", "skin1", "--sweep-points", "150000", "--sweeps", "2")
    with ended(Hand(server, folder, *options, *LOOK, body=body)) as opened:
        yield opened


@pytest.fixture(scope="module")
def whole(hand: Hand) -> float:
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


def saved_after(hand: Hand, folder: Path, act) -> dict:
    """The scene that the window saves once that is done."""
    before = set(folder.glob("ball-*.json"))
    act()
    wait_until(lambda: set(folder.glob("ball-*.json")) > before, hand, "the scene is not saved")
    (path,) = set(folder.glob("ball-*.json")) - before
    return json.loads(path.read_text())


def test_keys_are_answered_amid_a_solve_and_do_not_end_it(hand: Hand, whole: float):
    """Six of them, each seen before the next, take less than the one solve that is being made: to wait for the end of
    a solve takes a whole one for each, and so does one that begins anew after each key, however slow the machine is.
    """
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


def test_what_is_changed_amid_a_solve_is_done_at_once(hand: Hand, whole: float, folder: Path):
    """The eye goes round, and the scene is saved from there, in less time than the solve takes that this ends."""
    begin_solve(hand)
    start = time.monotonic()
    saved = saved_after(hand, folder, lambda: hand.keys(*["Right"] * KEYS, "ctrl+s"))
    assert time.monotonic() - start < whole
    assert saved["camera"]["azimuth"] == pytest.approx(-7.5 * KEYS)
    hand.calm()


# What takes long on each device: on lavapipe, which computes a pass in one piece, passes of the solve, and at first to
# compile them.
SLOW = {
    "cpu": ("--sweep-points", "50000", "--radiance", "gathered", "--samples", "8", "--ground"),
    "llvmpipe": ("--no-correction", "--samples", "1", "--no-ground"),
}


@pytest.fixture(params=[("cpu", 4), ("llvmpipe", 4), pytest.param(("cpu", 7), marks=pytest.mark.long)])
def opening(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Hand]:
    """A window on a display of its own, just opened on a body of which nothing is known yet: the largest has 160
    thousand vertices on its surface.
    """
    device, fineness = request.param
    body = write_levels(tmp_path / "ball.qgraph", [icosphere(fineness, 10), icosphere(3, 10)])
    options = ("--material", "marble-veins", "--device", device, *SLOW[device])
    with display(tmp_path) as own, ended(Hand(own, tmp_path, *options, body=body)) as opened:
        yield opened


class Keyboard:
    """Presses keys by the library that xdotool has: to start that takes longer than most answers."""

    CONTROL, S = 0xFFE3, 0x73  # X's keysyms

    def __init__(self, hand: Hand):
        self._x, self._test = ctypes.CDLL("libX11.so.6"), ctypes.CDLL("libXtst.so.6")
        self._x.XOpenDisplay.restype = ctypes.c_void_p
        self._display = ctypes.c_void_p(self._x.XOpenDisplay(hand.environment["DISPLAY"].encode()))

    def move(self, down: bool, *keysyms: int) -> None:
        """All of them, in this order."""
        for keysym in keysyms:
            key = self._x.XKeysymToKeycode(self._display, ctypes.c_ulong(keysym))
            self._test.XTestFakeKeyEvent(self._display, key, int(down), ctypes.c_ulong(0))
        self._x.XFlush(self._display)

    def close(self) -> None:
        self._x.XCloseDisplay(self._display)


def test_it_answers_from_the_first_moment_to_the_last(opening: Hand, tmp_path: Path):
    """What is made once for a body, rows, trees and tables, is made in pieces as solves are. The longest answer is a
    small part of what is waited for.
    """
    start, answers, begun = time.monotonic(), [], False
    with contextlib.closing(Keyboard(opening)) as keyboard:
        while not begun or opening.busy():
            begun = begun or opening.busy()
            pressed = time.monotonic()
            saved_after(opening, tmp_path, lambda: keyboard.move(True, keyboard.CONTROL, keyboard.S))
            answers.append(time.monotonic() - pressed)
            keyboard.move(False, keyboard.S, keyboard.CONTROL)
            for scene in tmp_path.glob("ball-*.json"):  # to look through hundreds takes a core that the window wants
                scene.unlink()
            time.sleep(0.05)
    whole = time.monotonic() - start
    worst, usual = 1000 * max(answers), 1000 * float(np.median(answers))
    print(f"\n{worst:.0f} ms at most, {usual:.0f} as a rule, {len(answers)} answers in {whole:.1f} s")
    assert max(answers) < whole / 8


def test_what_is_done_while_a_picture_is_begun_stays_in_its_order(hand: Hand, folder: Path):
    """F12 comes together with a click into a field: what follows amid the solve of the picture is typed."""
    hand.do("mousemove", "150", str(FIELD))
    hand.settle()
    hand.process.send_signal(signal.SIGSTOP)
    typed = ["ctrl+a", *"marble", "Return"]
    hand.do("keydown", "F12", "mousedown", "1", "mouseup", "1", "keyup", "F12", "key", *typed)
    hand.process.send_signal(signal.SIGCONT)
    hand.settle()
    saved = saved_after(hand, folder, lambda: hand.keys("Escape", "ctrl+s"))
    assert saved["material"] == "marble"
