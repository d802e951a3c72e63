"""The page in Chromium stamps images of the visitor's machine and changes coefficients; the server takes no others."""

from __future__ import annotations

import io
import json
import shutil
import urllib.error
import urllib.request
import zipfile

import numpy as np
import pytest
from PIL import Image
from test_page_hands import LOOK, PageHand, green_at
from test_serve import PATIENCE, served, wait_for
from test_stamps import SIGNATURE, header, png

import quadgraph
from baked import write_levels
from quadgraph.browser import stamps
from shapes import icosphere


@pytest.fixture(scope="module")
def ball(tmp_path_factory):
    return write_levels(tmp_path_factory.mktemp("bodies") / "ball.qgraph", [icosphere(3, 10), icosphere(2, 10)])


@pytest.fixture
def beside(ball, tmp_path):
    """The ball in a folder with an image."""
    shutil.copy(ball, tmp_path / "ball.qgraph")
    (tmp_path / "white.png").write_bytes(png())
    return tmp_path / "ball.qgraph"


@pytest.fixture
def halves(tmp_path_factory):
    """An image of a visitor: black at the left, white at the right."""
    two = np.zeros((64, 64, 3), np.uint8)
    two[:, 32:] = 255
    path = tmp_path_factory.mktemp("visitor") / "halves.png"
    Image.fromarray(two).save(path)
    return path


def page_of(address, path):
    return address.replace("/?", f"/{path}?")


def send(address, content, name="sent.png"):
    """Status and answer of the server to an image."""
    asked = urllib.request.Request(page_of(address, "stamp") + f"&name={name}", data=content, method="POST")
    try:
        with urllib.request.urlopen(asked, timeout=PATIENCE) as answer:
            return answer.status, json.load(answer)
    except urllib.error.HTTPError as error:
        return error.code, json.load(error)


def test_the_server_takes_images_and_no_others(beside):
    folder = beside.parent
    before = {path: path.read_bytes() for path in folder.iterdir()}
    with served(beside) as (_, address):
        assert send(address, png()) == (200, {"image": "sent.png"})
        for name in ("white.png", "..%2F..%2Fwhite.png"):
            status, answer = send(address, png(9 + len(name)), name)
            assert status == 200
            assert answer["image"] not in ("white.png", "sent.png")
        for content, status, said in (
            (SIGNATURE + header(60_000, 60_000), 400, "60000x60000 texels"),
            (png()[:-20], 400, "cut off"),
            (b"no image", 400, "no PNG"),
            (bytes(stamps.MOST_SENT_BYTES + 1), 413, "allowed are 1 to"),
            (iter([bytes(1 << 20)] * 5), 413, "allowed are 1 to"),  # of a length that is not said
            (b"", 413, "allowed are 1 to"),
        ):
            found, answer = send(address, content)
            assert (found, said in answer["refused"]) == (status, True), answer
        with pytest.raises(urllib.error.HTTPError) as error:
            urllib.request.urlopen(page_of(address, "stamp").partition("?")[0], data=png(), timeout=PATIENCE)
        assert error.value.code == 403
    assert {path: path.read_bytes() for path in folder.iterdir()} == before


def test_an_image_of_the_visitor_is_stamped_and_saved_with_the_scene(browser, beside, halves, tmp_path):
    from selenium.webdriver.support.ui import Select

    with served(beside, "--material", "wholemilk", *LOOK) as (_, address):
        hand = PageHand(browser, address)
        clean = hand.picture()
        hand.open("Paint")
        assert [option.text for option in Select(hand.find("mask")).options] == ["none", "white.png"]
        hand.find("paints").click()
        hand.slide(radius=2, depth=2)  # powers of two of those at first
        hand.find("image-file").send_keys(str(halves))
        wait_for(lambda: Select(hand.find("mask")).first_selected_option.text == "halves.png")
        stamped = hand.after(lambda: hand.drag((-60, 0), (60, 0)))
        assert hand.says("said.layers[0].strokes") == 1
        assert green_at(stamped, 25, 0) < 0.7 * green_at(clean, 25, 0)
        assert green_at(stamped, -60, 0) > 1.2 * green_at(stamped, 60, 0)
        with pytest.raises(urllib.error.HTTPError) as error:
            urllib.request.urlopen(page_of(address, "scene.json"), timeout=PATIENCE)
        assert error.value.code == 409
        assert "halves.png" in error.value.read().decode()
        link = hand.find("save-scene").get_attribute("href")
        assert "scene.zip" in link
        with zipfile.ZipFile(io.BytesIO(urllib.request.urlopen(link, timeout=PATIENCE).read())) as archive:
            archive.extractall(tmp_path / "saved")
        hand.after(hand.find("undo").click)
        assert "scene.json" in hand.find("save-scene").get_attribute("href")
        assert hand.errors() == []
    (edit,) = quadgraph.SceneFile(tmp_path / "saved" / "scene.json").at(0).to_dict()["edits"]  # without the server
    assert edit["mask"] == str(tmp_path / "saved" / "halves.png")


def test_a_hostile_image_is_refused_on_the_page(browser, beside, tmp_path_factory):
    folder = tmp_path_factory.mktemp("visitor")
    hostile = folder / "hostile.png"
    hostile.write_bytes(SIGNATURE + header(60_000, 60_000))
    large = folder / "large.png"
    large.write_bytes(bytes(stamps.MOST_SENT_BYTES + 1))
    with served(beside, *LOOK) as (_, address):
        hand = PageHand(browser, address)
        hand.open("Paint")
        for file, said in ((hostile, "60000x60000 texels"), (large, "more than 4 MiB")):
            hand.find("image-file").send_keys(str(file))
            wait_for(lambda said=said: said in hand.find("trouble").text)
            assert hand.find("mask").get_attribute("value") == ""
            assert hand.says("images") == ["white.png"]
        (entry,) = hand.errors()
        assert "400" in entry["message"]  # of the first: the page itself refuses the other


def test_a_pattern_and_coefficients_are_painted_by_the_page(browser, beside):
    from selenium.webdriver.support.ui import Select

    with served(beside, "--material", "wholemilk", *LOOK) as (_, address):
        hand = PageHand(browser, address)
        clean = hand.picture()
        hand.open("Paint")
        hand.open("Pattern, coefficients")
        hand.find("paints").click()
        hand.slide(radius=2, depth=2)
        Select(hand.find("pattern")).select_by_visible_text("white.png")
        hand.find("by-coefficients").click()
        assert not hand.find("brush-colour").is_displayed()
        Select(hand.find("operation")).select_by_visible_text("add")
        hand.numbers("sigma_a", 0, 3, 0)
        painted = hand.after(lambda: hand.drag((0, 0)))
        assert hand.says("brush.coefficients") == {"operation": "add", "sigma_a": [0, 3, 0]}
        assert green_at(painted, 0, 0) < 0.7 * green_at(clean, 0, 0)
        assert painted[..., 0].max() > 0.9 * clean[..., 0].max()  # red is as it was
        saved = json.load(urllib.request.urlopen(page_of(address, "scene.json"), timeout=PATIENCE))
        (edit,) = saved["edits"]
        assert edit["image"] == str(beside.parent / "white.png")
        assert (edit["operation"], edit["sigma_a"]) == ("add", [0, 3, 0])
        assert "sigma_s_prime" not in edit
        hand.find("sigma_a").click()  # neither is changed any more
        hand.drag((0, 0))
        wait_for(lambda: "found neither" in hand.find("trouble").text)
        assert hand.errors() == []
