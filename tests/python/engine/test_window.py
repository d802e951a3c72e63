"""The real window on a display in memory, under a hand (xdotool) and an eye on that memory."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from PIL import Image

import tiny
from baked import write_levels
from engine_program import ENGINE
from shapes import icosphere

PROGRAMS = ("Xvfb", "xdotool")
MISSING = [name for name in PROGRAMS if shutil.which(name) is None]
pytestmark = [
    pytest.mark.skipif(ENGINE is None, reason="quadgraph-engine is not built: run tools/setup"),
    pytest.mark.skipif(bool(MISSING), reason=f"not installed: {', '.join(MISSING)} (tools/packages.txt)"),
]

PANEL = 340  # pixels of the panel's width at a scale of 1
FIELD = 437  # height at which materials are typed
SIZE = (900, 600)
LIGHTS = ["--light", "directional:-0.94,-0.1,0.34:1"]  # from azimuth 110
# Where a test does not say otherwise: a settled picture takes a tenth of the time, without a ground. No target of
# --converge, or else a picture at rest goes on changing.
QUICK = {"--converge": "0", "--samples": "4", "--sweep-points": "1000", "--radiance": "lambertian"}
# The same in a scene file.
QUICK_SCENE = {
    "picture": {"samples": 4, "radiance": "lambertian", "ground": False},
    "solver": {"sweep_points": 1000},
}


class Server(NamedTuple):
    """A display: its name, the file of what is on its screen, and its process."""

    name: str
    memory: Path
    pid: int


@contextlib.contextmanager
def display(folder: Path) -> Iterator[Server]:
    """An X server that draws into a file in the folder, without a pointer in the picture.

    A key that is held down does not repeat: the window would have something to do for as long.
    """
    read, write = os.pipe()
    screen = ("-screen", "0", "1280x900x24", "-nocursor", "-r", "-fbdir", str(folder))
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(write), *screen, "-nolisten", "tcp"],
        pass_fds=[write],
        stderr=subprocess.DEVNULL,
    )
    os.close(write)
    try:
        with os.fdopen(read) as pipe:
            yield Server(f":{pipe.readline().strip()}", folder / "Xvfb_screen0", server.pid)
    finally:
        server.terminate()
        server.wait(timeout=10)


def sleeps(pid: int) -> bool:
    """Whether no thread of a process has anything to do; not while one ends."""
    try:
        stats = [file.read_text() for file in Path(f"/proc/{pid}/task").glob("*/stat")]
    except (FileNotFoundError, ProcessLookupError):
        return False
    return all(stat.rpartition(")")[2].split()[0] in "SI" for stat in stats)


def screen_of(memory: Path) -> np.ndarray:
    """What is in such a file, (height, width, 3): an X window dump, whose pixels are blue, green, red and a rest."""
    header = np.fromfile(memory, ">u4", 25)
    size, width, height, line, colours = header[[0, 4, 5, 12, 19]].tolist()
    rows = np.fromfile(memory, np.uint8, height * line, offset=size + 12 * colours).reshape(height, line)
    return rows[:, : 4 * width].reshape(height, width, 4)[..., 2::-1]


class Patience:
    """So many seconds of both cores for a process, or ten times as long by the clock: busy machines are waited for."""

    def __init__(self, process: subprocess.Popen, seconds: float):
        self.times = Path(f"/proc/{process.pid}/stat")
        self.computed = self._computed() + 2 * seconds
        self.clock = time.monotonic() + 10 * seconds

    def _computed(self) -> float:
        user, system = self.times.read_text().rpartition(")")[2].split()[11:13]
        return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")

    def left(self) -> bool:
        return self._computed() < self.computed and time.monotonic() < self.clock


class Hand:
    """A running window and what can be done to it."""

    def __init__(
        self,
        server: Server,
        folder: Path,
        *arguments: str,
        body: Path = tiny.PATH,
        program: tuple[str, ...] = (),
        size: tuple[int, int] = SIZE,
    ):
        if body.suffix != ".json":
            arguments += tuple(word for option in QUICK.items() if option[0] not in arguments for word in option)
            arguments += () if "--ground" in arguments else ("--no-ground",)
        self.environment = os.environ | {"DISPLAY": server.name}
        self.environment.pop("WAYLAND_DISPLAY", None)
        self.server = server
        self.process = subprocess.Popen(
            [*(program or (str(ENGINE),)), str(body), "--validation", *arguments],
            env=self.environment,
            cwd=folder,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
        )
        self.window = self.do("search", "--sync", "--onlyvisible", "--name", "QuadGraph").split()[0]
        self.do("windowmove", self.window, "0", "0", "windowsize", "--sync", self.window, *map(str, size))

    def patience(self, seconds: float) -> Patience:
        return Patience(self.process, seconds)

    def do(self, *arguments: str) -> str:
        """Run xdotool."""
        return subprocess.run(
            ["xdotool", *arguments], env=self.environment, capture_output=True, text=True, check=True, timeout=30
        ).stdout

    def keys(self, *keys: str) -> None:
        """Press keys one after the other."""
        self.do("key", "--delay", "30", *keys)

    def drag(self, x: int, y: int, button: int = 1, held: str | None = None) -> None:
        """From the middle of the picture by so many pixels, with a key held down."""
        middle = (PANEL + (SIZE[0] - PANEL) // 2, SIZE[1] // 2)
        press = ["keydown", held] if held else []
        release = ["keyup", held] if held else []
        self.do(
            "mousemove", *map(str, middle), *press, "mousedown", str(button), "sleep", "0.05",
            "mousemove_relative", "--", str(x // 2), str(y // 2), "sleep", "0.05",
            "mousemove_relative", "--", str(x - x // 2), str(y - y // 2), "sleep", "0.05",
            "mouseup", str(button), *release,
        )  # fmt: skip

    def look(self) -> np.ndarray:
        """What is on the screen, (height, width, 3)."""
        return screen_of(self.server.memory).astype(int)

    def busy(self) -> bool:
        """Whether it says in its title that the picture is not the converged one."""
        assert self.process.poll() is None, self.process.communicate()
        return self.do("getwindowname", self.window).rstrip().endswith("...")

    def sleeps(self) -> bool:
        """Whether neither display nor window has anything left to do, in the order in which events go."""
        return sleeps(self.server.pid) and sleeps(self.process.pid)

    def settle(self) -> None:
        """Wait until the last thing done is seen and the picture has converged."""
        seen, quiet = time.monotonic() + 3, 0
        while not self.busy() and quiet < 4 and time.monotonic() < seen:
            time.sleep(0.02)
            quiet = quiet + 1 if self.sleeps() else 0  # what is done and changes no picture
        self.calm()

    def calm(self) -> None:
        """Wait until the picture of what has been seen has converged."""
        patience = self.patience(60)
        quiet = 0
        while quiet < 3:  # a change that has just come may not be in the title yet
            quiet = 0 if self.busy() else quiet + 1
            assert patience.left(), "the picture does not settle"
            time.sleep(0.05)

    def screen(self) -> np.ndarray:
        """The whole screen once it has settled and neither window nor display has anything left to do: what was
        presented may be seen later.
        """
        self.settle()
        patience = self.patience(20)
        before, quiet = screen_of(self.server.memory), 0
        while quiet < 3:
            time.sleep(0.1)
            now = screen_of(self.server.memory)
            seen = now[: SIZE[1], PANEL : SIZE[0]]
            same = seen.any() and np.array_equal(seen, before[: SIZE[1], PANEL : SIZE[0]])
            quiet = quiet + 1 if same and self.sleeps() and not self.busy() else 0
            assert patience.left(), "no picture is seen, or it changes by itself"
            before = now
        return now.astype(int)

    def picture(self) -> np.ndarray:
        """The part without the panel, once it has settled."""
        return self.screen()[: SIZE[1], PANEL : SIZE[0]]

    def other_picture(self, before: np.ndarray) -> np.ndarray:
        """The same once it is another one, for which it waits: a busy machine sees keys late."""
        patience = self.patience(20)
        while np.array_equal(now := self.picture(), before) and patience.left():
            time.sleep(0.1)
        return now

    def close(self, key: str = "q") -> None:
        """Quit by key, without saving; the program must end well."""
        self.keys(key, "d")  # asked only where something was changed
        output, errors = self.process.communicate(timeout=20)
        assert (self.process.returncode, output, errors) == (0, "", "")


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """A display for all tests."""
    with display(tmp_path_factory.mktemp("display")) as found:
        yield found


@pytest.fixture
def open_window(server: Server, tmp_path: Path) -> Iterator:
    """Opens windows, and closes what a failed test has left open."""
    hands: list[Hand] = []

    def start(*arguments: str, **how: Any) -> Hand:
        hands.append(Hand(server, tmp_path, *arguments, **how))
        return hands[-1]

    yield start
    for hand in hands:
        if hand.process.poll() is None:
            hand.process.kill()
            hand.process.communicate()


def sides(picture: np.ndarray) -> tuple[float, float]:
    """Mean brightness left and right of the upright edge that a cube turns to the viewer."""
    row, column = picture.shape[0] // 2, picture.shape[1] // 2
    rows = slice(row - 40, row + 40)
    return picture[rows, column - 100 : column - 30].mean(), picture[rows, column + 30 : column + 100].mean()


def test_a_hand_at_the_window(open_window, tmp_path: Path):
    """Light dragged, material, view, size, picture to file, quit: each changes what it should, where it should."""
    look = ["--exposure", "2", "--view", "45,15", "--radiance", "gathered", "--ground"]
    hand = open_window("--material", "sigma_s_prime=2,sigma_a=.3,eta=1.3", *look, *LIGHTS)
    first = hand.picture()
    left, right = sides(first)
    assert right > 1.2 * left

    hand.drag(-460, 0, held="ctrl")  # as far as a flat side needs to be lit by itself
    dragged = hand.picture()
    left, right = sides(dragged)
    assert left > 1.2 * right
    corner = np.s_[:40, -40:]  # the background does not know the light
    assert np.array_equal(first[corner], dragged[corner])

    hand.keys("m")
    stone = hand.picture()
    changed = np.abs(stone - dragged).max(axis=2) > 8
    assert changed.mean() > 0.05
    assert not changed[corner].any()

    hand.drag(120, 60)
    turned = hand.picture()
    assert (np.abs(turned - stone).max(axis=2) > 8).mean() > 0.05

    hand.keys("v", "v", "v", "v", "v", "v")  # fluence on a plane: colours of their own, with a bar
    inside = hand.picture()
    saturation = inside.max(axis=2) - inside.min(axis=2)
    assert (saturation > 60).mean() > 0.05
    hand.keys("shift+v", "shift+v", "shift+v", "shift+v", "shift+v", "shift+v")
    assert np.array_equal(hand.picture(), turned)

    hand.keys("F12")
    written = tmp_path / "tiny-1.png"
    patience = hand.patience(20)
    while not (written.exists() and written.with_suffix(".exr").exists()) and patience.left():
        time.sleep(0.1)
    with Image.open(written) as image:
        assert image.size == (SIZE[0] - PANEL, SIZE[1])
        shot = np.asarray(image).astype(int)
    above_message = np.s_[: SIZE[1] - 80]
    assert np.abs(shot[above_message] - hand.picture()[above_message]).max() <= 1
    hand.close()


def test_a_stroke_of_the_brush_shows_where_it_went_and_can_be_taken_back(open_window, tmp_path: Path):
    """Painted to the right of the middle of a sphere, undone, redone, and written into a scene file."""
    body = write_levels(tmp_path / "ball.qgraph", [icosphere(3, 10), icosphere(2, 10)])
    front = ["--view", "0,0", "--light", "directional:0,0,-1:1"]
    hand = open_window("--material", "skin1", "--tone", "aces", "--exposure", "1", *front, body=body)
    before = hand.picture()
    hand.keys("p")
    hand.drag(100, 0)
    painted = hand.picture()
    darker = before.sum(axis=2) - painted.sum(axis=2)
    row, column = darker.shape[0] // 2, darker.shape[1] // 2
    stroke, beside = (
        darker[row - 4 : row + 4, column : column + 100],
        darker[row - 4 : row + 4, column - 100 : column - 60],
    )
    assert stroke.mean() > 20
    assert stroke.mean() > 3 * beside.mean()

    hand.keys("Escape")  # leaves the brush, whose ring is on the body
    painted = hand.picture()
    hand.keys("ctrl+z")
    assert np.abs(hand.picture() - before).max() <= 1
    hand.keys("ctrl+y")
    assert np.abs(hand.picture() - painted).max() <= 1
    hand.keys("ctrl+s")
    hand.settle()
    scene = json.loads((tmp_path / "ball-1.json").read_text())
    (edit,) = scene["edits"]
    ends = np.array([edit["stroke"][0], edit["stroke"][-1]])
    assert np.allclose(np.linalg.norm(ends, axis=1), 10, atol=0.1)
    assert np.allclose(ends[0], [0, 0, 10], atol=0.1)
    assert ends[1, 0] > 2
    hand.close()


def test_the_window_changes_its_size(open_window):
    """Smaller, larger, full screen and back, without the panel: the body stays whole and in the middle."""
    hand = open_window("--material", "wholemilk")
    hand.picture()
    for width, height in ((640, 480), (1200, 700)):
        hand.do("windowsize", "--sync", hand.window, str(width), str(height))
        body = hand.screen()[:height, PANEL:width].max(axis=2) > 90
        columns = np.flatnonzero(body.any(axis=0))
        assert abs((columns[0] + columns[-1]) / 2 - (width - PANEL) / 2) < 12
        assert body[height // 2, (width - PANEL) // 2]
    hand.keys("F10")
    body = hand.screen()[:700, :1200].max(axis=2) > 90
    columns = np.flatnonzero(body.any(axis=0))
    assert abs((columns[0] + columns[-1]) / 2 - 600) < 12
    hand.keys("F11")
    hand.settle()
    hand.keys("F11")
    hand.settle()
    hand.close("Escape")


def test_what_is_not_saved_is_asked_for_before_it_ends(open_window, tmp_path: Path):
    """By both keys; Esc leaves brush and question first, and where nothing was changed nothing is asked."""
    hand = open_window("--material", "wholemilk")
    before = hand.picture()
    hand.keys("Right", "p", "Escape", "m")  # a turned view is nothing to save
    changed = hand.other_picture(before)
    for key in ("Escape", "q"):
        hand.keys(key)
        asked = hand.other_picture(changed)
        assert not np.array_equal(asked, changed)
        hand.keys("Escape")
        assert np.array_equal(hand.other_picture(asked), changed)
    hand.keys("q", "s")
    output, errors = hand.process.communicate(timeout=20)
    assert (hand.process.returncode, output, errors) == (0, "", "")
    saved = tmp_path / "tiny-1.json"
    assert json.loads(saved.read_text())["material"] != "wholemilk"
    again = open_window(body=saved)
    again.picture()
    again.keys("Escape")
    assert again.process.wait(timeout=20) == 0


def test_a_wrong_material_is_told_and_changes_nothing(open_window):
    """Typed into the panel."""
    hand = open_window("--material", "wholemilk")
    hand.settle()
    before = hand.picture()
    hand.do("mousemove", "150", str(FIELD), "click", "--repeat", "2", "1", "type", "--delay", "20", "granite")
    hand.keys("Return")
    after = hand.picture()
    message = np.s_[-60:, :400]
    assert np.abs(after[message] - before[message]).max() > 60
    assert np.array_equal(after[:-110], before[:-110])  # the message names all materials, in five lines
    hand.close()
