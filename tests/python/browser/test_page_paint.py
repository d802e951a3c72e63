"""What a page paints and cuts: by the window's brush, layer by layer, and back."""

from __future__ import annotations

import numpy as np
import pytest

import quadgraph
import two_cubes
from baked import write_levels
from quadgraph.base.errors import InputError
from quadgraph.browser import shown_scene
from quadgraph.browser.frame_loop import FrameLoop
from quadgraph.browser.inbox import Inbox, Message
from quadgraph.browser.shown_scene import ShownScene
from shapes import icosphere

MIDDLE, BESIDE = [0.5, 0.5], [0.01, 0.01]


@pytest.fixture(scope="module")
def ball(tmp_path_factory):
    return write_levels(tmp_path_factory.mktemp("bodies") / "ball.qgraph", [icosphere(2, 10), icosphere(1, 10)])


@pytest.fixture(scope="module")
def stage(ball):
    with quadgraph.Stage(device="cpu") as made:
        made.show(quadgraph.Scene(ball))
        yield made


@pytest.fixture
def shown(ball, stage):
    picture = {"width": 96, "height": 64, "ground": False}
    camera = {"azimuth": 0, "elevation": 0}
    scene = quadgraph.Scene(ball, material="wholemilk", lights=["ambient:1"], picture=picture, camera=camera)
    made = ShownScene(scene)
    stage.show(made.scene)
    return made


@pytest.fixture
def hand(shown, stage):
    """A hand that paints: places, and what it changes of the brush."""

    def paint(*places, begins=True, layer=0, **brush):
        stage.show(shown.scene)
        return shown.paint(stage, {**stage.usual_brush, "layer": layer, **brush}, list(places), begins)

    return paint


def names(shown):
    return [layer["name"] for layer in shown.layers]


def strokes(shown):
    return [layer["strokes"] for layer in shown.layers]


def test_a_stroke_lies_where_the_hand_went_and_is_one_step(shown, stage, hand):
    before = shown.document
    state = hand(MIDDLE)
    assert state["touched"]
    hand(*([0.5 + 0.02 * k, 0.5] for k in range(1, 6)), begins=False)
    (edit,) = shown.document["edits"]
    points = np.array(edit["stroke"])
    assert np.linalg.norm(points, axis=1) == pytest.approx(10, abs=0.4)  # on the ball
    assert points[0] == pytest.approx([0, 0, 10], abs=0.4)
    assert np.all(np.diff(points[:, 0]) > 0)
    assert strokes(shown) == [1]
    shown.undo()
    assert shown.document == before
    shown.redo()
    assert shown.document["edits"] == [edit]
    assert not shown.can_redo
    shown.undo()
    hand(MIDDLE)
    assert not shown.can_redo  # what was taken back is gone once something else is done
    with pytest.raises(InputError, match="nothing to redo"):
        shown.redo()


def test_paint_changes_the_light_there_and_undo_gives_it_back(shown, stage, hand):
    def middle():
        stage.show(shown.scene)
        stage.engine.solve(correction=False)
        return stage.render().scattered[32, 48]

    clean = middle()
    hand(MIDDLE, radius=4, depth=4, falloff=1)
    painted = middle()
    assert painted[1] < 0.6 * clean[1]  # red lets no green back
    hand(MIDDLE, tool="erase")
    assert middle() == pytest.approx(clean, rel=1e-6)
    shown.undo()
    assert middle() == pytest.approx(painted, rel=1e-6)


def test_what_begins_beside_the_body_paints_nothing(shown, hand):
    before = shown.document
    assert not hand(BESIDE, MIDDLE)["touched"]
    assert shown.document == before
    assert not shown.can_undo


def test_a_colour_is_picked_up(shown, hand):
    colour = [0.1, 0.5, 0.2]
    hand(MIDDLE, colour=colour)
    state = hand(MIDDLE, tool="pick")
    assert state["colour"] == pytest.approx(colour, abs=0.03)
    assert strokes(shown) == [1]


def test_a_mirrored_stroke_lies_on_both_sides_as_that_of_the_stage(shown, stage, hand):
    """The ball lies about the origin, seen along z; its faces have no mirror image."""
    places = [[0.55 + 0.01 * k, 0.4] for k in range(6)]
    start, brush = shown.scene, {**stage.usual_brush, "layer": 0, "mirror": "x"}
    hand(places[0], mirror="x")
    hand(*places[1:], begins=False, mirror="x")
    (edit,) = shown.document["edits"]
    here, there = np.array(edit["stroke"]), np.array(edit["mirrored"]["stroke"])
    assert len(here) > 1
    assert there == pytest.approx(here * [-1, 1, 1], abs=0.3)
    assert np.linalg.norm(there, axis=1) == pytest.approx(10, abs=0.4)
    stage.show(start)
    pixels = [(x * 96, y * 64) for x, y in places]
    assert stage.painted(brush, pixels)[0].to_dict()["edits"] == [edit]
    hand([0.45, 0.4], tool="erase")  # where the mirror image is
    assert strokes(shown) == [0]
    for axis, (x, y, z) in {"y": (1, -1, 1), "z": (1, 1, -1)}.items():
        hand([0.55, 0.4], mirror=axis)
        (edit,) = shown.document["edits"]
        (point,), (image,) = edit["stroke"], edit["mirrored"]["stroke"]
        assert image == pytest.approx(np.array(point) * [x, y, z], abs=0.3)
        shown.undo()
    hand([0.55, 0.4])
    assert "mirrored" not in shown.document["edits"][0]


def test_sides_of_the_mirror_have_the_names_of_the_window(stage):
    assert stage.mirrors == {"off": "off", "x": "left-right (X)", "y": "top-bottom (Y)", "z": "front-back (Z)"}


def test_rings_are_of_the_brush_on_the_body_and_on_its_seen_other_side(shown, stage):
    """Of an orthographic picture of the ball 24 mm high, in 64 pixels."""
    shown.set("/camera", {"azimuth": 0, "elevation": 0, "orthographic": 24})
    stage.show(shown.scene)
    brush = {**stage.usual_brush, "radius": 3}
    (ring,) = stage.brush_rings(brush, (48, 32))
    assert ring.mean(0) == pytest.approx([48, 32], abs=0.5)
    assert np.linalg.norm(ring - [48, 32], axis=1) == pytest.approx(3 * 64 / 24, rel=0.1)
    here, there = stage.brush_rings({**brush, "mirror": "x"}, (60, 26))
    assert here.mean(0) == pytest.approx([60, 26], abs=0.5)
    assert there.mean(0) == pytest.approx([36, 26], abs=1)
    assert len(stage.brush_rings({**brush, "mirror": "z"}, (60, 26))) == 1  # the other side is behind
    assert stage.brush_rings(brush, (1, 1)) == []
    for wrong in ({"radius": -1}, {"mirror": "w"}):
        with pytest.raises(InputError, match=next(iter(wrong))):
            stage.brush_rings({**brush, **wrong}, (48, 32))
    with pytest.raises(InputError, match="finite"):
        stage.brush_rings(brush, (float("nan"), 0))


def rings_asked(stage):
    return {"ring": {**stage.usual_brush, "mirror": "x"}, "at": [0.6, 0.5]}


def test_rings_are_told_during_a_solve_which_goes_on(shown, stage, monkeypatch):
    """And a change ends it."""
    told, solves, frames = [], [], []
    solve = stage.solve

    def solving():
        solves.append(len(told))
        assert len(solves) <= 2, "rings have ended it"
        loop.inbox.put(Message(rings_asked(stage), told.append))
        assert len(told) == len(solves)
        if len(solves) == 1:
            loop.inbox.put(Message({"set": "/material", "value": "marble"}, told.append))
            pytest.fail("the solve goes on")
        return solve()

    def show(frame):
        frames.append(frame)
        if frame.said["rest"]:
            raise KeyboardInterrupt

    loop = FrameLoop(stage, shown, show)
    monkeypatch.setattr(stage, "solve", solving)
    with pytest.raises(KeyboardInterrupt):
        loop.run()
    assert solves == [0, 1]
    assert [len(each["rings"]) for each in told] == [2, 2]
    assert frames[-1].scene["material"] == "marble"
    middle = np.mean(told[0]["rings"], axis=1)
    assert middle[0] == pytest.approx([0.6, 0.5], abs=0.02)
    assert middle[1] == pytest.approx([0.4, 0.5], abs=0.03)


def test_rings_that_are_asked_for_all_the_time_do_not_put_off_the_picture_at_rest(shown, stage, monkeypatch):
    loop = FrameLoop(stage, shown, lambda frame: None)
    told = []

    def ask_again(answer):
        told.append(answer)
        assert len(told) < 100_000, "there is no picture at rest"
        loop.inbox.put(Message(rings_asked(stage), ask_again))

    def solving():
        raise KeyboardInterrupt

    monkeypatch.setattr(stage, "solve", solving)
    monkeypatch.setattr(loop.inbox, "_wake", lambda: None)
    loop.inbox.put(Message(rings_asked(stage), ask_again))
    with pytest.raises(KeyboardInterrupt):
        loop.run()
    assert len(told) > 1


def test_of_rings_that_are_asked_for_the_newest_wait():
    inbox = Inbox(lambda: None)
    for number in range(100):
        inbox.put(Message({"ring": {}, "at": [number, 0]}, print))
    assert not inbox.waiting
    assert inbox.take(0) == []
    assert [message.content["at"][0] for message in inbox.take_rings()] == list(range(84, 100))
    assert inbox.take_rings() == []


def test_layers_are_added_named_hidden_moved_and_removed(shown, stage, hand):
    def change(what, layer=0, **value):
        stage.show(shown.scene)
        return shown.relayer(stage, {"layer": layer, "change": what, **value})["layer"]

    assert change("add") == 0
    assert change("add") == 1
    assert hand(MIDDLE, layer=1)["layer"] == 1
    assert change("name", 1, value="Veins") == 1
    change("opacity", 1, value=0.5)
    change("opacity", 1, value=0.25)
    assert names(shown) == ["Layer 1", "Veins"]
    assert strokes(shown) == [0, 1]
    assert shown.layers[1]["opacity"] == pytest.approx(0.25)
    shown.undo()
    assert shown.layers[1]["opacity"] == 1  # a slider that is drawn is one step
    change("visible", 1, value=False)
    before = shown.document
    with pytest.raises(InputError, match="'Veins' is hidden"):
        hand(MIDDLE, layer=1)
    assert shown.document == before
    assert change("down", 1) == 0
    assert names(shown) == ["Veins", "Layer 1"]
    assert change("remove", 0) == 0
    assert names(shown) == ["Layer 1"]
    shown.undo()
    assert names(shown) == ["Veins", "Layer 1"]


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"radius": -1}, "radius"),
        ({"radius": "1"}, "radius"),
        ({"radius": 1e9}, "radius"),
        ({"depth": 0}, "depth"),
        ({"colour": [2, 0, 0]}, "colour"),
        ({"colour": [1, 0]}, "colour"),
        ({"strength": 2}, "strength"),
        ({"distance": 0}, "distance"),
        ({"tool": "hammer"}, "tool"),
        ({"mirror": "w"}, "mirror"),
        ({"mirror": ["x"]}, "mirror"),
        ({"mirror": None}, "mirror"),
        ({"layer": 1}, "layer"),
        ({"layer": -1}, "layer"),
        ({"layer": 0.5}, "layer"),
        ({"image": "stolen.png"}, "image"),
    ],
)
def test_a_wrong_brush_is_refused_by_name(shown, hand, wrong, said):
    before = shown.document
    with pytest.raises(InputError, match=said):
        hand(MIDDLE, **wrong)
    assert shown.document == before


@pytest.mark.parametrize("places", [[], [[0.5]], [[0.5, "1"]], [[0.5, True]], "here", None, [[1e9, 0]], [MIDDLE] * 65])
def test_wrong_places_are_refused(shown, stage, places):
    with pytest.raises(InputError, match="at"):
        shown.paint(stage, {**stage.usual_brush, "layer": 0}, places, True)
    with pytest.raises(InputError, match="pick"):
        shown.body_at(stage, places)


def test_wrong_changes_of_layers_are_refused(shown, stage):
    for change in ({"change": "burn"}, {"change": "name"}, {"change": ["add"]}, {}, "add", {"change": "visible"}):
        with pytest.raises(InputError):
            shown.relayer(stage, {"layer": 0, **change} if isinstance(change, dict) else change)


def test_strokes_have_an_end(shown, hand, monkeypatch):
    monkeypatch.setattr(shown_scene, "MOST_STROKE_POINTS", 5)
    hand(MIDDLE)
    hand(MIDDLE)
    before = shown.document
    with pytest.raises(InputError, match="allowed are 5"):
        hand(MIDDLE)
    assert shown.document == before


def test_cuts_are_shown_by_shortest_path_and_then_by_what_was_before(shown):
    before = shown.document
    plane = {"type": "plane", "normal": [0, 0, 1], "offset": 2.0}
    shown.set("/cuts", [plane])
    assert shown.document["solver"]["method"] == "shortest-path"
    with pytest.raises(InputError, match="shortest-path alone"):
        shown.set("/solver/method", "fem")
    shown.set("/cuts", [{**plane, "offset": 3.0}])
    assert shown.document["cuts"][0]["offset"] == 3.0
    shown.undo()
    assert shown.document == before
    shown.redo()
    shown.set("/cuts", [])
    assert shown.document == before


def test_a_click_finds_the_body(stage):
    made = ShownScene(quadgraph.Scene(two_cubes.PATH, material="wax", camera={"azimuth": 0, "elevation": 0}))
    with quadgraph.Stage(device="cpu") as two:
        two.show(made.scene)
        found = [made.body_at(two, [x, 0.5]) for x in (0.3, 0.7)]
        assert found == ["left", "right"]
        assert made.body_at(two, BESIDE) is None
