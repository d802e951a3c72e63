"""`quadgraph serve`: the server as a stranger meets it, and the page in headless Chromium."""

from __future__ import annotations

import asyncio
import json
import os
import re
import signal
import subprocess
import sys
import time
import urllib.error
import urllib.request
from contextlib import contextmanager

import pytest

import quadgraph
from baked import write_levels
from quadgraph.base.errors import InputError
from shapes import icosphere

aiohttp = pytest.importorskip("aiohttp", reason="aiohttp is not installed: pip install 'quadgraph[serve]'")
PATIENCE = 120  # s: a machine that does much else
TOKEN = "a-token-of-the-tests"


@pytest.fixture(scope="module")
def ball(tmp_path_factory):
    return write_levels(tmp_path_factory.mktemp("bodies") / "ball.qgraph", [icosphere(3, 10), icosphere(2, 10)])


@contextmanager
def served(ball, *options, port=0):
    """The process, and the address that it says."""
    command = [sys.executable, "-m", "quadgraph.cli", "serve", str(ball), "--material", "skin1", "--device", "cpu"]
    process = subprocess.Popen(
        [*command, "--size", "96x96", "--sweep-points", "300", "--port", str(port), *options],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "QUADGRAPH_SERVE_TOKEN": TOKEN},
    )
    try:
        address = process.stdout.readline().strip()
        assert address, process.stderr.read()
        yield process, address
    finally:
        process.kill()
        process.communicate()


def talk(address, conversation):
    """Hold a conversation over the page's WebSocket."""

    async def held():
        async with aiohttp.ClientSession() as session, session.ws_connect(address.replace("/?", "/live?")) as socket:
            return await asyncio.wait_for(conversation(socket), PATIENCE)

    return asyncio.run(held())


async def heard(socket, wanted):
    """What is said next that `wanted` takes; of frames the pictures are left out, and each is acknowledged."""
    async for message in socket:
        if message.type == aiohttp.WSMsgType.TEXT:
            said = json.loads(message.data)
            if "frame" in said:
                await socket.send_json({"shown": said["frame"]["serial"]})
            if wanted(said):
                return said
    raise AssertionError("the server has ended")


def is_frame(rest):
    return lambda said: "frame" in said and said["frame"]["rest"] == rest


def refused(address):
    with pytest.raises(urllib.error.HTTPError) as error:
        urllib.request.urlopen(address, timeout=PATIENCE)
    return error.value.code


def test_a_scene_is_shown_changed_and_saved(ball):
    async def conversation(socket):
        hello = (await heard(socket, lambda said: "hello" in said))["hello"]
        first = (await heard(socket, is_frame(True)))["frame"]
        await socket.send_json({"gesture": "orbit", "right": 25, "up": 0})
        moved = (await heard(socket, is_frame(False)))["frame"]
        await socket.send_json({"set": "/material", "value": "marble"})
        await heard(socket, is_frame(False))
        at_rest = (await heard(socket, is_frame(True)))["frame"]
        await socket.send_json({"set": "/solver/certify", "value": 100})
        why = (await heard(socket, lambda said: "refused" in said))["refused"]
        await socket.send_str("no JSON")
        await heard(socket, lambda said: "a JSON object is expected" in said.get("refused", ""))
        return hello, first, moved, at_rest, why

    with served(ball) as (_, address):
        hello, first, moved, at_rest, why = talk(address, conversation)
        assert hello["file"] == "ball.qgraph"
        assert "jade" in hello["materials"]
        assert re.fullmatch(r"error \d\S*%, unlit \d\S*%", first["error"])
        turned = (first["scene"]["camera"]["azimuth"] - moved["scene"]["camera"]["azimuth"]) % 360
        assert turned == pytest.approx(25)
        assert at_rest["scene"]["material"] == "marble"
        assert at_rest["undo"]
        assert "a page may set" in why
        saved = json.load(urllib.request.urlopen(address.replace("/?", "/scene.json?"), timeout=PATIENCE))
        assert quadgraph.Scene.from_dict(saved).material == "marble"
        picture = urllib.request.urlopen(address.replace("/?", "/picture.png?"), timeout=PATIENCE).read()
        assert picture.startswith(b"\x89PNG")
        page = urllib.request.urlopen(address, timeout=PATIENCE)
        assert "default-src 'none'" in page.headers["Content-Security-Policy"]
        assert TOKEN not in page.read().decode()


def test_who_does_not_have_the_token_sees_nothing(ball):
    with served(ball) as (_, address):
        for path in ("/", "/live", "/scene.json", "/scene.zip", "/picture.png", "/film"):
            place = address.partition("/?")[0] + path
            assert refused(place) == 403
            assert refused(f"{place}?token=another") == 403
        assert address.startswith("http://127.0.0.1:")


def test_it_hears_while_it_solves_and_drops_what_nobody_waits_for(ball):
    """A picture of so many samples takes many minutes: nothing is at rest before this has ended."""

    async def conversation(socket):
        brush = (await heard(socket, lambda said: "hello" in said))["hello"]["brush"]
        await heard(socket, is_frame(False))
        serials = []
        for step in range(3):
            await asyncio.sleep(0.6)  # it has begun with the picture at rest
            await socket.send_json({"ping": step})
            await heard(socket, lambda said, step=step: said.get("pong") == step)
            await socket.send_json({"ring": brush, "at": [0.5, 0.5]})
            assert (await heard(socket, lambda said: "rings" in said))["rings"]
            await socket.send_json({"set": "/lights/0/irradiance", "value": 0.001 * (step + 1)})
            frame = (await heard(socket, lambda said: "frame" in said))["frame"]
            assert not frame["rest"]
            assert frame["scene"]["lights"][0]["irradiance"] == pytest.approx(0.001 * (step + 1))
            serials.append(frame["serial"])
        return serials

    with served(ball, "--light", "lamps", "--samples", "65536", "--size", "768x768") as (process, address):
        serials = talk(address, conversation)
        assert serials == sorted(set(serials))
        process.send_signal(signal.SIGINT)
        assert process.wait(PATIENCE) == 130


HOSTILE = [
    "[1]",
    "[" * 60_000,
    '{"set": "/material", "value": "\\ud800"}',
    '{"set": "/picture/roughness", "value": NaN}',
    '{"set": "/picture/roughness", "value": 1e999}',
    '{"set": "/picture/roughness", "value": {"a": [[[]]]}}',
    '{"set": "/lights/0", "value": null}',
    '{"set": "/lights/-1/irradiance", "value": 1}',
    '{"set": "/lights/99999999999999999999/irradiance", "value": 1}',
    '{"set": "/lights/~2", "value": 1}',
    '{"set": "/material\\u0000", "value": "jade"}',
    '{"set": "/material", "value": "jade\\u0000"}',
    '{"set": "/material", "value": ["jade"]}',
    '{"set": "/camera", "value": 7}',
    '{"set": {"a": 1}, "value": 7}',
    '{"gesture": "orbit", "right": "1"}',
    '{"gesture": "orbit", "right": 1e300}',
    '{"gesture": ["orbit"], "right": 1}',
    '{"gesture": "turn", "light": 1e9}',
    '{"gesture": "turn", "light": 99}',
    '{"add": ["point"]}',
    '{"add": "environment"}',
    '{"do": "undo"}',
    '{"do": "redo"}',
    '{"pick": [0.5]}',
    '{"pick": {"x": 1}}',
    '{"pick": [1e300, 0]}',
    '{"paint": "red", "at": [[0.5, 0.5]], "begins": true}',
    '{"paint": {}, "at": [[0.5, 0.5]], "begins": true}',
    '{"paint": {"tool": "paint"}, "at": 7, "begins": true}',
    '{"paint": {"tool": "paint"}, "at": [[0.5, 0.5]], "begins": "yes"}',
    '{"paint": {"tool": "paint", "mirror": "x" }, "at": [[0.5, 0.5]], "begins": true}',
    '{"paint": {"tool": [[[]]]}, "at": [[0.5, 0.5]]}',
    '{"paint": {"tool": "paint", "mask": "/etc/passwd"}, "at": [[0.5, 0.5]], "begins": true}',
    '{"paint": {"tool": "paint", "pattern": {"a": 1}}, "at": [[0.5, 0.5]], "begins": true}',
    '{"paint": {"tool": "paint", "coefficients": [[[]]]}, "at": [[0.5, 0.5]], "begins": true}',
    '{"ring": 7, "at": [0.5, 0.5]}',
    '{"ring": {"tool": "paint"}, "at": [0.5, 0.5]}',
    '{"ring": {"tool": "paint"}, "at": [[0.5, 0.5]]}',
    '{"ring": {"tool": "paint"}}',
    '{"layers": {"layer": 0, "change": "remove all"}}',
    '{"layers": {"layer": 7, "change": "add"}}',
    '{"layers": {"layer": 0, "change": "name", "value": "\\u0000"}}',
    '{"layers": [0]}',
    '{"set": "/edits", "value": [{"operation": "add", "sigma_a": 1, "image": "/etc/passwd"}]}',
    '{"set": "/cuts", "value": [{"type": "plane", "normal": [0, 0, 0], "offset": 0}]}',
    '{"set": "/cuts", "value": 7}',
    '{"set": "/materials/nobody", "value": "jade"}',
    '{"set": "/materials", "value": ["jade"]}',
    '{"set": "/solver/method", "value": "magic"}',
    '{"film": 7}',
    '{"film": {"turn": "camera", "seconds": 5, "suffix": "../../a.mp4"}}',
    '{"film": {"turn": [[[]]], "seconds": 1e300, "suffix": null}}',
]


def test_hostile_messages_are_refused_and_change_nothing(ball):
    async def conversation(socket):
        before = (await heard(socket, is_frame(True)))["frame"]["scene"]
        for text in HOSTILE:
            await socket.send_str(text)
            await heard(socket, lambda said: "refused" in said)
        await socket.send_json({"gesture": "orbit", "right": 1, "up": 0})
        after = (await heard(socket, is_frame(False)))["frame"]["scene"]
        return before, after

    with served(ball) as (_, address):
        before, after = talk(address, conversation)
        assert after | {"camera": before["camera"]} == before


def test_a_page_paints_cuts_and_is_told_why_there_is_no_picture(ball):
    async def conversation(socket):
        hello = (await heard(socket, lambda said: "hello" in said))["hello"]
        await heard(socket, is_frame(True))
        brush = {**hello["brush"], "layer": 0, "mirror": "x"}
        await socket.send_json({"paint": brush, "at": [[0.01, 0.01]], "begins": True})
        beside = (await heard(socket, lambda said: "painted" in said))["painted"]
        await socket.send_json({"paint": brush, "at": [[0.5, 0.5]], "begins": True})
        await socket.send_json({"paint": brush, "at": [[0.55, 0.5], [0.6, 0.5]], "begins": False})
        on_it = (await heard(socket, lambda said: "painted" in said))["painted"]
        await socket.send_json({"do": "end"})
        painted = (await heard(socket, lambda said: is_frame(False)(said) and said["frame"]["layers"]))["frame"]
        await socket.send_json({"layers": {"layer": 0, "change": "visible", "value": False}})
        assert (await heard(socket, lambda said: "layered" in said))["layered"]["layer"] == 0
        await socket.send_json({"paint": brush, "at": [[0.5, 0.5]], "begins": True})
        hidden = (await heard(socket, lambda said: "refused" in said))["refused"]
        await socket.send_json({"set": "/solver/method", "value": "polygrid"})
        trouble = await heard(socket, lambda said: "frame" in said and "trouble" in said["frame"])
        await socket.send_json({"do": "undo"})
        after = (await heard(socket, lambda said: "frame" in said and "width" in said["frame"]))["frame"]
        await socket.send_json({"pick": [0.5, 0.5]})
        picked = (await heard(socket, lambda said: "picked" in said))["picked"]
        return hello, beside, on_it, painted, hidden, trouble["frame"]["trouble"], after, picked

    with served(ball) as (_, address):
        hello, beside, on_it, painted, hidden, trouble, after, picked = talk(address, conversation)
        assert hello["bodies"] == []
        assert hello["methods"][-1] == "shortest-path"
        assert "polygrid" not in hello["methods"]
        assert (beside["touched"], on_it["touched"]) == (False, True)
        assert painted["layers"] == [{"name": "Layer 1", "visible": True, "opacity": 1.0, "strokes": 1}]
        assert "edits" not in painted["scene"]
        assert "'Layer 1' is hidden" in hidden
        assert "polygrid" in trouble
        assert after["scene"]["solver"]["method"] == "fem"
        assert picked == ""
        saved = json.load(urllib.request.urlopen(address.replace("/?", "/scene.json?"), timeout=PATIENCE))
        (layer,) = saved["edits"]
        assert len(layer["edits"][0]["stroke"]) > 1
        assert hello["mirrors"]["x"] == "left-right (X)"
        with quadgraph.Stage(device="cpu") as stage:  # which paints the same
            stage.show(quadgraph.Scene.from_dict(saved | {"edits": []}))
            width, height = (saved["picture"][side] for side in ("width", "height"))
            brush = {**stage.usual_brush, "layer": 0, "mirror": "x"}
            scene, _ = stage.painted(brush, [(x * width, 0.5 * height) for x in (0.5, 0.55, 0.6)])
        assert json.loads(json.dumps(scene.to_dict()["edits"])) == layer["edits"]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--port", "70000"], "allowed are 0 to 65535"),
        (["--host", "192.0.2.1"], "cannot be listened at"),
    ],
)
def test_wrong_places_are_named(ball, options, said):
    command = [sys.executable, "-m", "quadgraph.cli", "serve", str(ball), "--material", "skin1", "--device", "cpu"]
    done = subprocess.run([*command, *options], capture_output=True, text=True, timeout=PATIENCE)
    assert done.returncode != 0
    assert said in done.stderr
    assert "Traceback" not in done.stderr


def test_a_notebook_shows_it_in_a_cell(ball, monkeypatch):
    monkeypatch.setenv("QUADGRAPH_SERVE_TOKEN", TOKEN)
    scene = quadgraph.Scene(ball, material="skin1", picture={"width": 96, "height": 96})
    with quadgraph.BrowserView(scene, device="cpu") as view:
        assert f'src="{view.address}"' in view._repr_html_()
        assert TOKEN not in repr(view)
        frame = talk(view.address, lambda socket: heard(socket, lambda said: "frame" in said))["frame"]
        assert frame["scene"]["material"] == "skin1"
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(view.address, timeout=PATIENCE)
    with pytest.raises(InputError, match=r"nowhere\.qgraph"):
        quadgraph.BrowserView("nowhere.qgraph")
    with pytest.raises(InputError, match="height"):
        quadgraph.BrowserView(scene, height=1)


def shown(browser):
    return int(browser.execute_script("return document.body.dataset.shown || 0"))


def wait_for(condition):
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, "the page did not get there"
        time.sleep(0.05)


def test_the_page_orbits_changes_the_material_and_comes_back(browser, ball):
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.support.ui import Select

    def find(name):
        return browser.find_element("id", name)

    def at_rest():
        return browser.execute_script("return document.body.dataset.state") == "rest"

    def camera():
        return browser.execute_script("return said.scene.camera.azimuth")

    browser.set_window_size(900, 600)
    with served(ball) as (process, address):
        port = int(re.search(r":(\d+)/", address)[1])
        browser.get(address)
        wait_for(lambda: shown(browser) > 0 and at_rest())
        assert find("file").text == "ball.qgraph"
        assert re.search(r"error .*%", find("error").text)
        before = camera()
        view = find("view")
        ActionChains(browser).move_to_element(view).click_and_hold().move_by_offset(50, 0).release().perform()
        wait_for(lambda: camera() != before)
        assert (before - camera()) % 360 == pytest.approx(20)
        Select(find("material")).select_by_value("marble")
        wait_for(lambda: browser.execute_script("return said.scene.material") == "marble" and at_rest())
        assert find("material-text").get_attribute("value") == "marble"
        Select(find("coat")).select_by_value("water")
        wait_for(lambda: browser.execute_script("return said.scene.material") == "marble,coat=water")
        wait_for(lambda: find("coat").get_attribute("value") == "water")
        assert find("material").get_attribute("value") == "marble"
        find("undo").click()
        wait_for(lambda: find("coat").get_attribute("value") == "")
        find("undo").click()
        wait_for(lambda: browser.execute_script("return said.scene.material") == "skin1")
        process.kill()
        process.wait()
        wait_for(lambda: "trying again" in find("status").text)
        with served(ball, port=port):
            wait_for(lambda: browser.execute_script("return document.body.dataset.state") != "away")
            wait_for(at_rest)
            assert browser.execute_script("return said.scene.material") == "skin1"
    errors = [entry for entry in browser.get_log("browser") if "WebSocket" not in entry["message"]]
    assert errors == []
