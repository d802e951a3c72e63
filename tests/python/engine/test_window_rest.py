"""A window at rest draws nothing, and what is to be seen anew is drawn.

Frames are seen by a mark that is put into the memory of the screen: the next frame covers it.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from test_window import FIELD, SIZE, Hand, open_window, pytestmark, server
from test_window_preview import labelled, preview, say, seen, wait_until

__all__ = ["open_window", "preview", "pytestmark", "server"]

LOOK = ["--material", "skin1", "--exposure", "1", "--no-ground"]
MARK = (4, SIZE[0] - 4)  # row and column of a pixel of the background, in the window's upper right corner
WAKES = 6  # of a window that waits: at rest twice a second, as a preview ten times


def place(hand: Hand) -> int:
    """Where the mark is in the file of the screen: an X window dump."""
    size, line, colours = np.fromfile(hand.server.memory, ">u4", 25)[[0, 12, 19]].tolist()
    return size + 12 * colours + MARK[0] * line + 4 * MARK[1]


def mark(hand: Hand) -> None:
    with hand.server.memory.open("r+b") as memory:
        memory.seek(place(hand))
        memory.write(bytes([1, 254, 1]))
    assert marked(hand)


def marked(hand: Hand) -> bool:
    return bool((hand.look()[MARK] == (1, 254, 1)).all())


def wakes(hand: Hand) -> int:
    """How often the thread of the window has waited for something so far."""
    lines = Path(f"/proc/{hand.process.pid}/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("voluntary_ctxt_switches"))


def wait_for_wakes(hand: Hand) -> None:
    """Wait until it has looked several times for something to do, and has done it."""
    before = wakes(hand)
    wait_until(lambda: wakes(hand) >= before + WAKES and hand.sleeps(), hand)


def test_a_window_at_rest_draws_nothing_until_something_is_done(open_window):
    hand = open_window(*LOOK)
    hand.picture()
    mark(hand)
    wait_for_wakes(hand)
    assert marked(hand)
    hand.keys("Right")
    wait_until(lambda: not marked(hand), hand)
    hand.close()


def test_a_preview_draws_nothing_until_there_is_news(open_window, preview: Path, tmp_path: Path):
    news = tmp_path / "news.json"
    hand = open_window("--preview", str(news), *LOOK, body=preview)
    assert labelled(hand.picture())
    mark(hand)
    wait_for_wakes(hand)
    assert marked(hand)
    say(news, progress="level 0: 1,234 tets")
    wait_until(lambda: not marked(hand), hand)
    hand.picture()
    hand.close()


def test_what_was_hidden_is_drawn_again(open_window):
    """The window itself, and what another window was over."""
    hand = open_window(*LOOK)
    before = hand.picture()
    hand.do("windowunmap", "--sync", hand.window)
    assert not hand.look()[: SIZE[1], : SIZE[0]].any()
    hand.do("windowmap", "--sync", hand.window)
    wait_until(lambda: np.array_equal(seen(hand), before), hand)
    hand.close()


def test_a_cursor_goes_on_blinking(open_window):
    """Where a material is being typed frames go on though nothing is done."""
    hand = open_window(*LOOK)
    hand.picture()
    hand.do("mousemove", "150", str(FIELD), "click", "1")
    hand.picture()
    mark(hand)
    wait_until(lambda: not marked(hand), hand)
    hand.keys("Escape")
    hand.picture()
    hand.close()
