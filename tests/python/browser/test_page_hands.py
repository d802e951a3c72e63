"""The page in Chromium under a hand: it paints, takes back, cuts, changes the method and clicks on bodies."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image
from test_serve import served, shown, wait_for

from baked import write_levels
from quadgraph.baking.bodies import BodyMesh, bake_bodies
from quadgraph.baking.pipeline import BakeOptions
from quadgraph.baking.placing import BodyPlacement
from shapes import icosphere, write_obj

SIZE = (900, 700)
LOOK = ["--view", "0,0", "--light", "ambient:1", "--exposure", "0", "--no-ground", "--radiance", "lambertian"]


@pytest.fixture(scope="module")
def ball(tmp_path_factory):
    return write_levels(tmp_path_factory.mktemp("bodies") / "ball.qgraph", [icosphere(3, 10), icosphere(2, 10)])


@pytest.fixture(scope="module")
def balls(tmp_path_factory):
    """Two balls beside each other."""
    folder = tmp_path_factory.mktemp("balls")
    mesh = write_obj(icosphere(2, 5.0), folder / "ball.obj")
    bodies = [BodyMesh("left", mesh, unit="mm"), BodyMesh("right", mesh, BodyPlacement((12.0, 0, 0)), "mm")]
    bake_bodies(bodies, folder / "balls.qgraph", BakeOptions(visibility_rays=32))
    return folder / "balls.qgraph"


class PageHand:
    """What can be done to a page, and what it shows."""

    def __init__(self, browser, address):
        self.browser = browser
        browser.set_window_size(*SIZE)
        browser.get(address)
        self.settle(0)

    def find(self, name):
        return self.browser.find_element("id", name)

    def says(self, expression):
        return self.browser.execute_script(f"return {expression}")

    def settle(self, serial):
        """Wait for a picture at rest after that one."""
        wait_for(lambda: shown(self.browser) > serial and self.says("document.body.dataset.state") == "rest")

    def after(self, act):
        """The picture at rest after that, (h, w, 3)."""
        before = shown(self.browser)
        act()
        self.settle(before)
        return self.picture()

    def picture(self):
        """What is seen, rings of the brush apart."""
        self.browser.execute_script("$('rings').style.display = 'none'")
        png = self.find("view").screenshot_as_png
        self.browser.execute_script("$('rings').style.display = ''")
        return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(float)

    def rings(self):
        """Of the brush, as (left, top, right, bottom) from the middle of the picture."""
        box = "(r => [r.x, r.y, r.right, r.bottom])(each.getBoundingClientRect())"
        found = np.array(self.says(f"[...document.querySelectorAll('#rings .line')].map((each) => {box})"))
        view = self.says("(r => [r.x + r.width / 2, r.y + r.height / 2])($('view').getBoundingClientRect())")
        return found - np.tile(view, 2) if len(found) else found

    def open(self, *summaries):
        for summary in self.browser.find_elements("tag name", "summary"):
            if summary.text in summaries:
                summary.click()

    def drag(self, start, *moves):
        from selenium.webdriver.common.action_chains import ActionChains

        hand = ActionChains(self.browser).move_to_element_with_offset(self.find("view"), *start).click_and_hold()
        for move in moves:
            hand.move_by_offset(*move)
        hand.release().perform()

    def slide(self, **values):
        """Move sliders to values, by the names that they have."""
        for name, value in values.items():
            moved = f"$('{name}').value = {value}; $('{name}').dispatchEvent(new Event('input'))"
            self.browser.execute_script(moved)

    def numbers(self, coefficient, *values):
        """Type the numbers by which the brush changes a coefficient."""
        line = self.find(coefficient).find_element("xpath", "../..")
        for field, value in zip(line.find_elements("css selector", "[type=number]"), values, strict=True):
            field.clear()
            field.send_keys(str(value))

    def errors(self):
        return [entry for entry in self.browser.get_log("browser") if "WebSocket" not in entry["message"]]


def green_at(picture, right, down):
    """Mean green about a place, counted from the middle of the picture."""
    row, column = picture.shape[0] // 2 + down, picture.shape[1] // 2 + right
    return picture[row - 4 : row + 5, column - 4 : column + 5, 1].mean()


def test_a_stroke_is_seen_undone_and_hidden_with_its_layer(browser, ball):
    with served(ball, "--material", "wholemilk", *LOOK) as (_, address):
        hand = PageHand(browser, address)
        clean = hand.picture()
        hand.open("Paint")
        hand.find("paints").click()
        azimuth = hand.says("said.scene.camera.azimuth")
        painted = hand.after(lambda: hand.drag((-20, 0), (20, 0), (20, 0)))
        assert hand.says("said.scene.camera.azimuth") == azimuth  # a stroke turns nothing
        assert hand.says("said.layers[0].strokes") == 1
        assert green_at(painted, 0, 0) < 0.7 * green_at(clean, 0, 0)
        assert green_at(painted, 0, 120) == pytest.approx(green_at(clean, 0, 120), rel=0.1)
        undone = hand.after(hand.find("undo").click)
        assert green_at(undone, 0, 0) == pytest.approx(green_at(clean, 0, 0), abs=1.5)
        again = hand.after(hand.find("redo").click)
        assert green_at(again, 0, 0) == pytest.approx(green_at(painted, 0, 0), abs=1.5)
        hidden = hand.after(browser.find_element("css selector", "#layers .eye").click)
        assert green_at(hidden, 0, 0) == pytest.approx(green_at(clean, 0, 0), abs=1.5)
        hand.drag((0, 0), (5, 0))
        wait_for(lambda: "is hidden" in hand.find("trouble").text)
        turned = hand.says("said.scene.camera.azimuth")
        hand.drag((-hand.find("view").size["width"] // 2 + 5, 0), (50, 0))  # it begins beside the ball
        wait_for(lambda: hand.says("said.scene.camera.azimuth") != turned)
        assert hand.errors() == []


def test_a_mirrored_stroke_is_seen_on_both_sides(browser, ball):
    from selenium.webdriver.support.ui import Select

    with served(ball, "--material", "wholemilk", *LOOK) as (_, address):
        hand = PageHand(browser, address)
        clean = hand.picture()
        hand.open("Paint")
        hand.find("paints").click()
        mirror = Select(hand.find("mirror"))
        assert [option.text for option in mirror.options][:2] == ["off", "left-right (X)"]
        mirror.select_by_value("x")
        hand.slide(radius=1, depth=1)  # powers of two of those at first
        painted = hand.after(lambda: hand.drag((100, -20), (0, 20), (0, 20)))
        wait_for(lambda: len(hand.rings()) == 2)
        here, there = hand.rings()
        assert (here[:2] + here[2:]) / 2 == pytest.approx([100, 20], abs=6)  # where the pointer stays
        assert there == pytest.approx(here[[2, 1, 0, 3]] * [-1, 1, -1, 1], abs=8)
        hand.drag((-hand.find("view").size["width"] // 2 + 4, 0))  # beside the ball
        wait_for(lambda: len(hand.rings()) == 0)
        for aside in (100, -100):
            assert green_at(painted, aside, 0) < 0.7 * green_at(clean, aside, 0)
        assert green_at(painted, 0, -180) == pytest.approx(green_at(clean, 0, -180), rel=0.1)
        assert hand.says("said.layers[0].strokes") == 1
        assert hand.errors() == []


def test_a_cut_shows_the_inside_and_the_method_changes_and_comes_back(browser, ball):
    from selenium.webdriver.support.ui import Select

    with served(ball, *LOOK) as (_, address):
        hand = PageHand(browser, address)
        hand.open("Cut", "Lab")
        whole = hand.picture()
        before = shown(browser)
        hand.find("cut").click()
        wait_for(lambda: hand.says("said.scene.solver.method") == "shortest-path" and shown(browser) > before)
        hand.settle(before)
        cut = hand.picture()
        assert np.abs(cut - whole)[..., 1].max() > 20
        assert not hand.find("method").is_enabled()
        browser.execute_script("$('cut-offset').value = -6; $('cut-offset').dispatchEvent(new Event('input'))")
        wait_for(lambda: abs(hand.says("said.scene.cuts[0].offset") + 6) < 0.2)
        hand.find("cut").click()
        wait_for(lambda: hand.says("said.scene.solver.method") == "fem")
        hand.after(lambda: Select(hand.find("method")).select_by_value("quadgraph-fv"))
        assert hand.says("said.scene.solver.method") == "quadgraph-fv"
        assert hand.errors() == []


def test_a_click_chooses_the_body_that_the_material_goes_to(browser, balls):
    from selenium.webdriver.support.ui import Select

    with served(balls, *LOOK) as (_, address):
        hand = PageHand(browser, address)
        aside = hand.find("view").size["width"] // 4
        hand.drag((aside, 0))
        wait_for(lambda: hand.says("body") == "right")
        assert hand.find("badge").text == "Body: right"
        assert Select(hand.find("body")).first_selected_option.text == "right"
        hand.after(lambda: Select(hand.find("material")).select_by_value("marble"))
        assert hand.says("said.scene.materials") == {"right": "marble"}
        slide = "$('position-1').value = 3; $('position-1').dispatchEvent(new Event('input'))"
        before = hand.picture()
        moved = hand.after(lambda: browser.execute_script(slide))
        assert hand.says("said.scene.placements.right.position") == pytest.approx([0, 3, 0], abs=0.1)
        assert np.abs(moved - before).max() > 50
        hand.after(hand.find("undo").click)
        hand.drag((-hand.find("view").size["width"] // 2 + 4, 0))
        wait_for(lambda: hand.says("body") == "")
        assert hand.find("material-text").get_attribute("value") == "skin1"
        hand.after(lambda: Select(hand.find("material")).select_by_value("wax"))
        assert not hand.says("said.scene.materials")
        assert hand.errors() == []
