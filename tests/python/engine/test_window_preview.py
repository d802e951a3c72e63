"""The window of a mesh that is being baked: a preview, and the body in its place once there is one."""

from __future__ import annotations

import json
import signal
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from test_window import LIGHTS, PANEL, SIZE, Hand, open_window, pytestmark, server

from baked import write_levels
from quadgraph import cli
from quadgraph.baking import bare
from quadgraph.mesh.surface import Surface
from shapes import icosphere, write_obj

__all__ = ["open_window", "pytestmark", "server"]

VIEW = (sys.executable, "-m", "quadgraph.cli", "view", "--longest", "20mm")
MATERIAL = ["--material", "skin1", "--exposure", "1", "--no-ground"]
LABEL = np.s_[8:60]  # rows in which the preview says that it is one


def labelled(picture: np.ndarray) -> bool:
    """Whether the orange letters of a preview are over the picture."""
    red, green, blue = (picture[LABEL][..., channel] for channel in range(3))
    return bool(((red > 200) & (green > 120) & (green < 190) & (blue < 120)).sum() > 100)


def seen(hand: Hand) -> np.ndarray:
    """The part without the panel as it is now."""
    return hand.look()[: SIZE[1], PANEL : SIZE[0]]


def wait_until(what, hand: Hand, seconds: float = 60):
    """What it gives once that is something."""
    patience = hand.patience(seconds)
    while not (found := what()):
        assert hand.process.poll() is None, hand.process.communicate()
        assert patience.left(), "it does not happen"
        time.sleep(0.05)
    return found


def say(news: Path, **what: str) -> None:
    """Replace the news whole, as the bake does."""
    news.with_suffix(".new").write_text(json.dumps(what))
    news.with_suffix(".new").replace(news)


@pytest.fixture
def preview(tmp_path: Path) -> Path:
    """A ball of 20 mm without levels."""
    path = tmp_path / "ball.qgraph"
    bare.write(write_obj(icosphere(3, 10), tmp_path / "ball.obj"), path, unit="mm")
    return path


def test_a_preview_changes_over_to_its_body_and_keeps_what_the_user_did(open_window, preview: Path, tmp_path: Path):
    """Turned, another material, then baked: the picture of a window that was opened so, and the same scene."""
    news = tmp_path / "news.json"
    hand = open_window("--preview", str(news), *MATERIAL, *LIGHTS, body=preview)
    first = hand.picture()
    assert labelled(first)
    say(news, progress="level 0: 1,234 tets")
    wait_until(lambda: not np.array_equal(seen(hand)[LABEL], first[LABEL]), hand)
    hand.drag(120, 60)
    hand.keys("m")
    hand.picture()
    hand.keys("ctrl+s")  # the file of a preview is nothing to come back to
    hand.picture()
    assert not (tmp_path / "ball-1.json").exists()

    (tmp_path / "baked").mkdir()
    body = write_levels(tmp_path / "baked" / "ball.qgraph", [icosphere(3, 10), icosphere(2, 10)])
    say(news, body=str(body))
    wait_until(lambda: not labelled(seen(hand)), hand)
    baked = hand.picture()
    hand.keys("ctrl+s")
    wait_until((tmp_path / "ball-1.json").exists, hand)
    scene = json.loads((tmp_path / "ball-1.json").read_text())
    assert (scene["body"], scene["solver"]["method"]) == ("baked/ball.qgraph", "fem")
    assert scene["material"] != "skin1"
    hand.keys("ctrl+z")
    undone = hand.picture()
    assert not labelled(undone)
    assert (np.abs(undone - baked).max(axis=2) > 8).mean() > 0.05
    hand.close()
    again = open_window(body=tmp_path / "ball-1.json")
    assert np.abs(again.picture()[: SIZE[1] - 80] - baked[: SIZE[1] - 80]).max() <= 1
    again.close()


@pytest.mark.parametrize(
    "said",
    [
        {"failed": "the surface is open"},
        pytest.param({"body": "nowhere.qgraph"}, marks=pytest.mark.long),
        pytest.param({"told": "?"}, marks=pytest.mark.long),
    ],
)
def test_a_preview_stays_and_says_why_there_is_no_body(open_window, preview: Path, tmp_path: Path, said):
    """Whatever went wrong, the body itself or the news of it, the window goes on."""
    news = tmp_path / "news.json"
    hand = open_window("--preview", str(news), *MATERIAL, *LIGHTS, body=preview)
    first = hand.picture()
    say(news, **said)
    wait_until(lambda: not np.array_equal(seen(hand)[LABEL], first[LABEL]), hand)
    after = hand.picture()
    assert labelled(after)
    below = np.s_[SIZE[1] // 2 :]  # however many lines the reason takes
    assert np.abs(after - first)[below].max() <= 1
    hand.drag(120, 60)
    assert not np.array_equal(hand.picture()[below], after[below])
    hand.close()


@pytest.fixture
def places(tmp_path: Path, monkeypatch) -> tuple[Path, Path]:
    """The cache of bodies, and where temporary files go."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("TMPDIR", str(tmp_path / "temporary"))
    (tmp_path / "temporary").mkdir()
    return tmp_path / "cache" / "quadgraph" / "bodies", tmp_path / "temporary"


def running(folder: Path) -> list[str]:
    """Command lines of processes that name something in a folder."""
    found = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            text = path.read_bytes().replace(b"\0", b" ").decode(errors="replace")
        except OSError:
            continue
        if str(folder) in text:
            found.append(text)
    return found


def wait_for_label(hand: Hand) -> None:
    wait_until(lambda: labelled(seen(hand)), hand)


def test_a_mesh_is_seen_at_once_and_then_baked(open_window, places, tmp_path: Path):
    """By the command line: a preview, its body, which is kept, and a second window that has it from the first."""
    cache, temporary = places
    mesh = write_obj(icosphere(3, 10), tmp_path / "ball.obj")
    hand = open_window(*MATERIAL, *LIGHTS, body=mesh, program=VIEW)
    wait_for_label(hand)
    wait_until(lambda: list(cache.glob("*/ball.qgraph")), hand, 120)
    wait_until(lambda: not labelled(seen(hand)), hand)
    baked = hand.picture()
    hand.keys("q")
    output, errors = hand.process.communicate(timeout=20)
    assert (hand.process.returncode, output) == (0, "")
    assert "level 0: " in errors
    assert "kept for the next time" in errors
    assert not list(temporary.iterdir())
    again = open_window(*MATERIAL, *LIGHTS, body=mesh, program=VIEW)
    assert np.abs(again.picture() - baked).max() <= 1
    again.close()


@pytest.mark.parametrize("options", [[], pytest.param(["--method", "shortest-path"], marks=pytest.mark.long)])
def test_a_saved_scene_of_a_mesh_outlives_the_cache(open_window, places, tmp_path: Path, options):
    """Seen as a preview that is baked, and by shortest paths, of which nothing is kept."""
    cache, temporary = places
    mesh = write_obj(icosphere(2, 10), tmp_path / "ball.obj")
    hand = open_window(*MATERIAL, *LIGHTS, *options, body=mesh, program=VIEW)
    if not options:
        wait_until(lambda: list(cache.glob("*/ball.qgraph")), hand, 120)
        wait_until(lambda: not labelled(seen(hand)), hand)
    shown = hand.picture()
    hand.keys("ctrl+s")
    wait_until((tmp_path / "ball-1.json").exists, hand)
    assert json.loads((tmp_path / "ball-1.json").read_text())["body"] == "ball.qgraph"
    hand.keys("q")
    assert hand.process.wait(timeout=20) == 0
    assert cli.main(["cache", "clear"]) == 0
    assert not list(temporary.iterdir())
    again = open_window(body=tmp_path / "ball-1.json")
    assert np.abs(again.picture()[: SIZE[1] - 80] - shown[: SIZE[1] - 80]).max() <= 1
    again.close()


@pytest.mark.parametrize(("end", "status"), [("close", 0), (signal.SIGINT, 130)])
def test_whatever_ends_the_window_ends_the_bake_and_leaves_nothing(open_window, places, tmp_path: Path, end, status):
    cache, temporary = places
    hand = open_window(*MATERIAL, *LIGHTS, body=write_obj(icosphere(6, 10), tmp_path / "large.obj"), program=VIEW)
    wait_for_label(hand)
    assert running(temporary)
    if end == "close":
        hand.keys("q")
    else:
        hand.process.send_signal(end)
    errors = hand.process.communicate(timeout=20)[1]
    assert hand.process.returncode == status
    assert ("interrupted" in errors) == (status != 0)
    assert not list(temporary.iterdir())
    assert not list(cache.glob("*/*"))
    assert not running(temporary)


def test_a_mesh_that_cannot_be_baked_stays_a_preview(open_window, places, tmp_path: Path):
    """With the reason on the terminal, and an exit status that says so."""
    ball = icosphere(3, 10)
    mesh = write_obj(Surface(ball.vertices, ball.triangles[60:]), tmp_path / "open.obj")
    hand = open_window(*MATERIAL, *LIGHTS, body=mesh, program=VIEW)
    assert hand.process.stderr is not None
    while "quadgraph: error: " not in hand.process.stderr.readline():
        assert hand.process.poll() is None
    assert labelled(hand.picture())
    hand.keys("q")
    hand.process.communicate(timeout=20)
    assert hand.process.returncode == 1
    assert not list(places[1].iterdir())
