"""Films that pages ask for: begun, said how far they are, cancelled, handed over, and limited."""

from __future__ import annotations

import io
import json
import time
import urllib.request
from pathlib import Path

import pytest
from PIL import Image
from test_page_hands import PageHand
from test_serve import PATIENCE, heard, refused, served, talk, wait_for

import quadgraph
import tiny
from quadgraph.base.errors import InputError
from quadgraph.browser import films as module
from quadgraph.browser.films import Films

FAST = ["--no-correction", "--samples", "4", "--size", "64x64", "--no-ground", "--light", "directional:0,0,-1:1"]
GIF = {"turn": "camera", "seconds": 5, "suffix": ".gif"}


@pytest.fixture
def films(monkeypatch):
    """Films of a frame a second, of which the shortest have five."""
    monkeypatch.setattr(module, "RATE", 1)
    with Films("cpu") as films:
        yield films


def scene(**picture):
    lights = [quadgraph.DirectionalLight((0, 0, -1), 1.0)]
    picture = {"width": 33, "height": 47, "samples": 4, "converge": 0.01, **picture}
    made = quadgraph.Scene(tiny.PATH, lights=lights, picture=picture, solver={"correction": False})
    return quadgraph.SceneFile(made).at(0).to_dict()


def followed(films):
    """All that is said of the film until it has ended."""
    said, until = [films.state], time.monotonic() + PATIENCE
    while films.making:
        assert time.monotonic() < until, "the film does not end"
        if films.follow():
            said.append(films.state)
        time.sleep(0.01)
    return said


def makers(folder):
    """Processes that make a film in a folder."""
    found = []
    for words in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            said = words.read_bytes()
        except OSError:  # it has ended
            continue
        if b"turntable" in said and str(folder).encode() in said:
            found.append(words.parent.name)
    return found


def test_a_film_is_made_of_the_scene_with_even_sides_and_told_frame_by_frame(films, monkeypatch):
    assert films.state == {"is": "none"}
    films.begin(scene(), GIF)
    with pytest.raises(InputError, match="one is being made"):
        films.begin(scene(), GIF)
    said = followed(films)
    done = [each["done"] for each in said if each["is"] == "making"]
    assert done == sorted(set(done))
    assert all(each["frames"] == 5 for each in said if each["is"] == "making")
    assert said[-1] == {"is": "ready", "suffix": ".gif", "bytes": films.made.stat().st_size}
    with Image.open(films.made) as image:
        assert (image.n_frames, image.size) == (5, (32, 46))
    assert not films.follow()
    first = films.made
    monkeypatch.chdir(tiny.PATH.parent)  # where the scene's files are looked for
    films.begin({**scene(), "body": tiny.PATH.name}, {**GIF, "turn": "light"})
    assert followed(films)[-1]["is"] == "ready"
    films.begin(scene(width=4096, height=64), {**GIF, "turn": "body"})
    assert not first.exists()
    assert json.loads((films.folder / "scene.json").read_text())["picture"]["width"] == module.MOST_SIDE
    films.cancel()
    assert films.state == {"is": "none"}
    assert films.made is None
    assert makers(films.folder) == []
    assert list(films.folder.glob("*film*")) == []


def test_the_frames_of_the_file_are_filmed_of_the_scene_as_it_is_shown(monkeypatch):
    turning = {"path": "/camera/azimuth", "keys": [[0, 0], [2, 40]]}
    document = {**scene(), "frames": 3, "frames_per_second": 4, "tracks": [turning]}
    own = quadgraph.core.scene_file(json.dumps(document))
    with Films("cpu", own) as films:
        assert films.turns == ("camera", "body", "light", "frames")
        films.begin({**scene(), "material": "jade"}, {**GIF, "turn": "frames"})
        written = json.loads((films.folder / "scene.json").read_text())
        assert (written["material"], written["frames"], len(written["tracks"])) == ("jade", 3, 1)
        said = followed(films)
        assert {each["frames"] for each in said if each["is"] == "making"} == {3}
        with Image.open(films.made) as image:
            assert (image.n_frames, image.size, image.info["duration"]) == (3, (32, 46), 250)
    refuses = pytest.raises(InputError, match=r"allowed are camera, body, light$")
    with Films("cpu") as films, refuses:
        films.begin(scene(), {**GIF, "turn": "frames"})


@pytest.mark.parametrize(
    ("wanted", "said"),
    [
        (7, "allowed is an object of turn, seconds, suffix"),
        ({"turn": "camera"}, "allowed is an object of"),
        ({**GIF, "output": "/etc/passwd"}, "allowed is an object of"),
        ({**GIF, "seconds": 5.0}, "seconds: found 5.0, allowed are 5, 10, 15"),
        ({**GIF, "seconds": 10**9}, "seconds"),
        ({**GIF, "turn": ["body"]}, "turn"),
        ({**GIF, "suffix": "/../a.gif"}, "suffix"),
    ],
)
def test_what_no_film_may_be_is_refused(films, wanted, said):
    with pytest.raises(InputError, match=said):
        films.begin(scene(), wanted)
    assert not films.making
    assert films.state == {"is": "none"}


def test_why_there_is_no_film_is_told_and_the_next_is_begun(films, monkeypatch):
    films.begin({**scene(), "body": "nowhere.qgraph"}, GIF)
    failed = followed(films)[-1]
    assert failed["is"] == "failed"
    assert "nowhere.qgraph" in failed["why"]
    assert str(films.folder) not in failed["why"]
    monkeypatch.setattr(module, "MOST_BYTES", -1)
    films.begin(scene(), GIF)
    assert "larger than" in followed(films)[-1]["why"]
    assert makers(films.folder) == []


def test_films_go_with_their_folder_while_one_is_made(films):
    films.begin(scene(), GIF)
    assert films.making
    folder = films.folder
    films.close()
    assert makers(folder) == []
    assert not folder.exists()


def is_film(state):
    return lambda said: said.get("film", {}).get("is") == state


def test_pages_are_told_of_a_film_and_fetch_it_while_frames_go_on():
    async def conversation(socket):
        await heard(socket, lambda said: "frame" in said)
        await socket.send_json({"film": GIF})
        await heard(socket, is_film("making"))
        await socket.send_json({"film": GIF})
        why = (await heard(socket, lambda said: "refused" in said))["refused"]
        await socket.send_json({"gesture": "orbit", "right": 25, "up": 0})
        await heard(socket, lambda said: "frame" in said and not said["frame"]["rest"])
        ready = (await heard(socket, is_film("ready")))["film"]
        return why, ready

    with served(tiny.PATH, *FAST, "--exposure", "0") as (_, address):
        place = address.replace("/?", "/film?")
        assert refused(place) == 404
        assert refused(place.partition("?")[0]) == 403
        why, ready = talk(address, conversation)
        assert "one is being made" in why
        answer = urllib.request.urlopen(place, timeout=PATIENCE)
        assert answer.headers["Content-Disposition"] == 'attachment; filename="film.gif"'
        film = answer.read()
        assert len(film) == ready["bytes"]
        with Image.open(io.BytesIO(film)) as image:
            assert (image.n_frames, image.size) == (120, (64, 64))


def test_a_film_is_cancelled_and_ends_with_the_server(tmp_path, monkeypatch):
    monkeypatch.setenv("TMPDIR", str(tmp_path))

    async def cancelled(socket):
        await heard(socket, lambda said: "frame" in said)
        await socket.send_json({"film": {**GIF, "seconds": 15}})
        await heard(socket, is_film("making"))
        assert len(makers(tmp_path)) == 1
        await socket.send_json({"film": "cancel"})
        await heard(socket, is_film("none"))
        assert makers(tmp_path) == []
        await socket.send_json({"film": {**GIF, "seconds": 15}})
        await heard(socket, is_film("making"))

    with served(tiny.PATH, *FAST) as (process, address):
        talk(address, cancelled)
        assert len(makers(tmp_path)) == 1
        process.terminate()
        process.wait(PATIENCE)
        assert makers(tmp_path) == []
        assert list(tmp_path.glob("quadgraph-films-*")) == []


def test_the_page_saves_a_film_and_can_cancel_one(browser, tmp_path):
    from selenium.webdriver.support.ui import Select

    with served(tiny.PATH, *FAST) as (_, address):
        hand = PageHand(browser, address)
        browser.execute_cdp_cmd("Page.setDownloadBehavior", {"behavior": "allow", "downloadPath": str(tmp_path)})
        hand.open("Film")
        for name, value in (("turn", "body"), ("seconds", "5"), ("suffix", ".gif")):
            Select(hand.find(f"film-{name}")).select_by_value(value)
        state = "document.body.dataset.film"
        hand.find("save-film").click()
        wait_for(lambda: hand.says(state) == "making")
        assert not hand.find("save-film").is_enabled()
        wait_for(lambda: "of 120 frames" in hand.find("film-text").text)
        hand.find("cancel-film").click()
        wait_for(lambda: hand.says(state) == "none")
        assert not hand.find("filming").is_displayed()
        browser.execute_script("set('/picture/width', 64); set('/picture/height', 64)")
        wait_for(lambda: hand.says("said.scene.picture.height") == 64)
        hand.find("save-film").click()
        wait_for(lambda: (tmp_path / "film.gif").exists())
        with Image.open(tmp_path / "film.gif") as image:
            assert image.n_frames == 120
        assert hand.find("film").is_displayed()
        assert hand.errors() == []
