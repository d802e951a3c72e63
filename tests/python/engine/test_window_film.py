"""Films from the window: what makes them beside it, how far it is, and how it ends."""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from test_window import PANEL, QUICK_SCENE, SIZE, open_window, pytestmark, server
from test_window_look import click

import tiny

__all__ = ["open_window", "pytestmark", "server"]

FILM, SHOWS, LAST_SHOWN, FORMAT = 787, 812, 784, 862  # of a body in the studio: a section to open, and rows of it
CANCEL = (140, 83)  # in the panel
LOOK = ["--no-ground", "--exposure", "1", "--light", "directional:0,0,-1:1"]
CORNER = np.s_[20:40, -80:-24]  # of the picture, above the body, where it is said how far a film is
# In the place of quadgraph: says that it has begun, and films for as long as the test wants.
MAKER = """#!{python}
import json, os, signal, sys, time
from pathlib import Path
folder = Path({folder!r})
words = sys.argv[1:]
def end(*_):
    (folder / "ended").touch()
    sys.exit(130)
signal.signal(signal.SIGTERM, end)
progress = Path(words[words.index("--progress") + 1])
fresh = progress.with_suffix(".new")
fresh.write_text('{{"done": 3, "frames": 12, "seconds_left": 8}}')
fresh.replace(progress)
told = {{"words": words, "scene": json.loads(Path(words[1]).read_text()), "nice": os.nice(0)}}
(folder / "told.new").write_text(json.dumps(told))
(folder / "told.new").replace(folder / "told.json")
while not (folder / "go").exists():
    time.sleep(0.02)
Path(words[-1]).write_text("a film")
"""


class Maker:
    """What the program in the place of quadgraph has been told, and the temporary folder of the window."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch):
        self.folder, self.temporary = folder / "maker", folder / "temporary"
        self.folder.mkdir()
        self.temporary.mkdir()
        program = self.folder / "quadgraph"
        program.write_text(MAKER.format(python=sys.executable, folder=str(self.folder)))
        program.chmod(0o755)
        monkeypatch.setenv("PATH", str(self.folder), prepend=os.pathsep)
        monkeypatch.setenv("TMPDIR", str(self.temporary))

    def begun(self, hand) -> dict:
        told = self.folder / "told.json"
        wait(hand, told.exists, "no film is begun")
        return json.loads(told.read_text())

    def left(self) -> list[Path]:
        """What the window keeps for a film."""
        return list(self.temporary.glob("quadgraph-film-*"))


def wait(hand, condition: Callable[[], bool], complaint: str) -> None:
    patience = hand.patience(15)
    while not condition():
        assert patience.left(), complaint
        time.sleep(0.05)


@pytest.fixture
def maker(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Maker:
    return Maker(tmp_path, monkeypatch)


def seen(hand, wanted: Callable[[np.ndarray], bool]) -> None:
    """Wait until the picture is as wanted."""
    wait(hand, lambda: wanted(hand.look()[: SIZE[1], PANEL : SIZE[0]]), "the picture does not become so")


def differs(before: np.ndarray, where: tuple):
    return lambda now: np.abs(now[where] - before[where]).max() > 60


def test_a_film_is_of_the_scene_as_it_was_and_the_window_goes_on(open_window, maker: Maker, tmp_path: Path):
    hand = open_window("--material", "wholemilk", *LOOK, size=(SIZE[0] + 1, SIZE[1] + 1))
    before = hand.picture()
    hand.keys("F9")
    told = maker.begun(hand)
    seen(hand, differs(before, CORNER))
    *words, film = told["words"]
    assert words[:1] + words[2:9] == ["turntable", "--turn", "camera", "--frames", "240", "--seconds", "10", "--device"]
    assert film == "tiny-1.mp4"
    assert told["nice"] == min(os.nice(0) + 10, 19)
    picture = told["scene"]["picture"]
    assert (picture["width"], picture["height"], picture["converge"]) == (SIZE[0] - PANEL, SIZE[1], 0)
    hand.keys("m", "ctrl+s")
    wait(hand, lambda: (tmp_path / "tiny-1.json").exists(), "the scene is not saved")
    assert told["scene"]["material"] == "wholemilk" != json.loads((tmp_path / "tiny-1.json").read_text())["material"]
    hand.keys("F9")  # one at a time
    (maker.folder / "go").touch()
    wait(hand, lambda: not maker.left(), "the film does not end")
    assert (tmp_path / "tiny-1.mp4").read_text() == "a film"
    seen(hand, lambda now: np.abs(now[CORNER] - before[CORNER]).max() <= 60)
    hand.close()
    assert not (maker.folder / "ended").exists()
    assert not (tmp_path / "tiny-2.mp4").exists()


def test_a_film_is_cancelled_and_another_one_begun(open_window, maker: Maker, tmp_path: Path):
    hand = open_window("--material", "wholemilk", *LOOK)
    hand.picture()
    hand.keys("F9")
    maker.begun(hand)
    click(hand, *CANCEL)
    wait(hand, (maker.folder / "ended").exists, "the film is not cancelled")
    wait(hand, lambda: not maker.left(), "the film does not end")
    (maker.folder / "told.json").unlink()
    (maker.folder / "go").touch()
    click(hand, *CANCEL)  # which says Save film again
    maker.begun(hand)
    wait(hand, lambda: (tmp_path / "tiny-2.mp4").exists(), "there is no film")
    assert not (tmp_path / "tiny-1.mp4").exists()
    hand.close()


def test_closing_asks_first_and_ends_the_film(open_window, maker: Maker):
    hand = open_window("--material", "wholemilk", *LOOK)
    before = hand.picture()
    hand.keys("F9")
    maker.begun(hand)
    seen(hand, differs(before, CORNER))
    middle = np.s_[200:280, 100:-100]
    hand.keys("q")
    seen(hand, differs(before, middle))
    hand.keys("s", "Escape")  # there is nothing to save
    seen(hand, lambda now: np.abs(now[middle] - before[middle]).max() <= 60)
    assert not (maker.folder / "ended").exists()
    hand.keys("q")
    seen(hand, differs(before, middle))
    hand.keys("d")
    assert hand.process.communicate(timeout=60) == ("", "")
    assert hand.process.returncode == 0
    assert (maker.folder / "ended").exists()
    assert maker.left() == []


def test_a_film_ends_with_a_window_that_is_killed(open_window, maker: Maker):
    hand = open_window("--material", "wholemilk", *LOOK)
    hand.picture()
    hand.keys("F9")
    maker.begun(hand)
    hand.process.kill()
    hand.process.wait()
    until = time.monotonic() + 60
    while not (maker.folder / "ended").exists():
        assert time.monotonic() < until, "the film goes on"
        time.sleep(0.05)


def test_without_quadgraph_on_the_path_it_is_said_what_to_run(open_window, maker: Maker, tmp_path: Path, monkeypatch):
    folders = [folder for folder in os.get_exec_path() if not (Path(folder) / "quadgraph").exists()]
    monkeypatch.setenv("PATH", os.pathsep.join(folders))
    hand = open_window("--material", "wholemilk", *LOOK)
    before = hand.picture()
    hand.keys("F9")
    seen(hand, differs(before, np.s_[-60:, :400]))
    assert maker.left() == []
    hand.close()


def test_frames_of_a_scene_become_a_film_with_what_was_changed(open_window, tmp_path: Path, monkeypatch):
    """By quadgraph itself: three frames as .gif, chosen in the panel, of another material than in the file."""
    monkeypatch.setenv("PATH", str(Path(sys.executable).parent), prepend=os.pathsep)
    scene = {"body": str(tiny.PATH), "material": "wholemilk", "frames": 3, **QUICK_SCENE}
    scene["tracks"] = [{"path": "/camera/azimuth", "keys": [[0, 0], [3, 90]]}]
    (tmp_path / "moves.json").write_text(json.dumps(scene))
    hand = open_window(body=tmp_path / "moves.json", size=(700, 890))
    hand.settle()
    hand.keys("m")
    hand.settle()
    click(hand, 100, FILM)
    click(hand, 100, SHOWS)
    click(hand, 60, LAST_SHOWN)
    click(hand, 84, FORMAT - 25)  # there are no seconds to choose
    hand.keys("ctrl+s", "F9")
    film = tmp_path / "tiny-1.gif"
    wait(hand, lambda: film.exists(), "there is no film")
    with Image.open(film) as image:
        assert (image.n_frames, image.size) == (3, (700 - PANEL, 890))
    hand.close()
