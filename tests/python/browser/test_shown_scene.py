"""What a page may change of a scene, step by step, and back."""

from __future__ import annotations

import numpy as np
import pytest

import quadgraph
import two_cubes
from baked import write_levels
from quadgraph.base.errors import InputError
from quadgraph.browser.inbox import Inbox, Message
from quadgraph.browser.shown_scene import ALLOWED, ShownScene
from shapes import icosphere

SIZE = {"width": 128, "height": 96}


@pytest.fixture(scope="module")
def ball(tmp_path_factory):
    return write_levels(tmp_path_factory.mktemp("bodies") / "ball.qgraph", [icosphere(2, 10), icosphere(1, 10)])


@pytest.fixture(scope="module")
def stage(ball):
    with quadgraph.Stage(device="cpu") as made:
        made.show(quadgraph.Scene(ball, material="skin1"))  # opens the device
        yield made


@pytest.fixture
def shown(ball, stage):
    lamps = quadgraph.default_lights()
    scene = quadgraph.Scene(ball, material="skin1", lights=lamps, picture=SIZE)
    made = ShownScene(quadgraph.SceneFile(scene).at(0))
    stage.show(made.scene)
    return made


def test_a_value_is_set_and_undone(shown):
    before = shown.document
    assert not shown.can_undo
    shown.set("/material", "marble")
    shown.set("/lights/0/irradiance", [1, 2, 3])
    assert shown.document["material"] == "marble"
    assert list(shown.document["lights"][0]["irradiance"]) == [1, 2, 3]
    shown.undo()
    assert shown.document == {**before, "material": "marble"}
    shown.undo()
    assert shown.document == before
    with pytest.raises(InputError, match="nothing to undo"):
        shown.undo()


def test_a_material_is_that_of_all_bodies_or_of_the_one_that_is_named():
    scene = quadgraph.Scene(two_cubes.PATH, material="skin1", materials={"left": "jade"}, lights=[])
    made = ShownScene(scene, two_cubes.NAMES)
    before = made.document
    made.set("/material", "marble")
    assert made.document["material"] == "marble"
    assert "materials" not in made.document
    made.undo()
    assert made.document == before
    assert before["materials"] == {"left": "jade"}
    made.set("/materials/right", "wax")
    assert made.document["materials"] == {"left": "jade", "right": "wax"}
    for pointer, value, said in (
        ("/materials/lid", "wax", "lid"),
        ("/materials/0", "wax", "0"),
        ("/materials", {"lid": "wax"}, "the file has left, right"),
        ("/materials/left", "stolen.npz", "names no new files"),
        ("/materials", {"left": "stolen.npz"}, "names no new files"),
        ("/materials/left", {"volume": "stolen.npz"}, "names no new files"),
    ):
        with pytest.raises(InputError, match=said):
            made.set(pointer, value)
    plane = {"type": "plane", "normal": [0, 0, 1], "offset": 2.0}
    made.set("/cuts", [plane])
    assert made.document["solver"]["method"] == "shortest-path"
    made.set("/materials/left", "jade")
    assert made.document["cuts"]
    for _ in range(3):
        made.undo()
    assert made.document == before


def test_a_body_is_put_elsewhere_by_parts_of_its_placement():
    made = ShownScene(quadgraph.Scene(two_cubes.PATH, material="wax", lights=[]), two_cubes.NAMES)
    before = made.document
    for x in (1.0, 2.0):
        made.set("/placements/right/position", [x, 0, 0])
    made.set("/placements/right/rotation", [0, 0, 45])
    assert made.document["placements"] == {"right": {"position": (2, 0, 0), "rotation": (0, 0, 45)}}
    for pointer, value, said in (
        ("/placements/lid/position", [1, 0, 0], "the file has left, right"),
        ("/placements", {"lid": {}}, "the file has left, right"),
        ("/placements/right/scale", 2, "scale"),
        ("/placements/right/position", [1e9, 0, 0], "position"),
        ("/placements/right/position", "up", "position"),
        ("/placements/right/position/0", 1, "position"),
        ("/placements/right", 7, "right"),
    ):
        with pytest.raises(InputError, match=said):
            made.set(pointer, value)
    made.undo()
    made.undo()
    assert made.document == before


def test_a_slider_that_is_drawn_is_one_step(shown):
    for value in (0.2, 0.3, 0.4):
        shown.set("/picture/roughness", value)
    shown.end_step()
    shown.set("/picture/roughness", 0.5)
    shown.undo()
    assert shown.document["picture"]["roughness"] == pytest.approx(0.4)
    shown.undo()
    assert not shown.can_undo


def test_camera_and_size_are_no_steps_and_stay(shown, stage):
    shown.set("/picture/tone", "agx")
    shown.move(stage, "orbit", 30, 5, 0)
    shown.set("/picture/width", 200)
    shown.undo()
    assert shown.document["picture"]["tone"] == "agx-punchy"
    assert shown.document["picture"]["width"] == 200
    assert shown.document["camera"]["elevation"] == pytest.approx(5)
    shown.restore()
    assert shown.document["camera"]["elevation"] == pytest.approx(10)
    assert shown.document["picture"]["width"] == 200
    shown.undo()
    assert shown.document["picture"]["tone"] == "agx-punchy"


def test_hands_do_what_they_do_in_the_window(shown, stage):
    start = shown.document["camera"]
    shown.move(stage, "orbit", 30, 5, 0)
    assert shown.document["camera"]["azimuth"] == pytest.approx(start["azimuth"] - 30)
    shown.move(stage, "zoom", 0, 1, 0)
    near = shown.document["camera"]["distance"]
    stage.show(shown.scene)
    shown.move(stage, "zoom", 0, 1, 0)
    assert shown.document["camera"]["distance"] == pytest.approx(0.875 * near)
    shown.move(stage, "pan", 0.1, 0, 0)
    assert np.linalg.norm(shown.document["camera"]["target"]) > 0.5
    before = [np.array(light["direction"]) for light in shown.document["lights"][:2]]
    shown.move(stage, "turn", 40, 0, 1)
    after = [np.array(light["direction"]) for light in shown.document["lights"][:2]]
    assert after[0] == pytest.approx(before[0])
    assert np.degrees(np.arccos(after[1] @ before[1])) > 5


def test_added_lights_light_the_middle_alike(shown, stage):
    for kind in ("directional", "point", "ambient"):
        shown.add_light(stage, kind)
    key, *_, directional, point, _ambient = shown.document["lights"]
    assert directional == key
    there = np.linalg.norm(point["position"])  # the ball lies about the origin
    assert np.array(point["power"]) / (4 * np.pi * there**2) == pytest.approx(np.array(key["irradiance"]), rel=1e-3)
    shown.undo()
    assert len(shown.document["lights"]) == 5


@pytest.mark.parametrize(
    ("pointer", "value", "said"),
    [
        ("/body", "other.qgraph", "a page may set"),
        ("/solver/certify", 1e9, "a page may set"),
        ("/picture/samples", 16000, "a page may set"),
        (None, 1, "a page may set"),
        ("/material", "stolen.npz", "names no new files"),
        ("/material", {"volume": "stolen.npz"}, "names no new files"),
        ("/lights", [{"type": "environment", "file": "stolen.hdr", "radiance": 1}], "names no new files"),
        ("/lights/0/file", "stolen.hdr", "names no new files"),
        ("/edits", [], "a page may set"),
        ("/cuts", [{"type": "plane", "normal": [0, 0, 0], "offset": 1}], "normal"),
        ("/cuts", [{"type": "sphere", "centre": [0, 0, 0], "radius": 1}] * 300, "allowed are 256"),
        ("/lights", [{"type": "ambient", "irradiance": 1}] * 300, "allowed are 256"),
        ("/picture/width", 5000, "64 to 2048"),
        ("/picture/width", True, "64 to 2048"),
        ("/picture/height", "12", "64 to 2048"),
        ("/lights/7/irradiance", 1, "/lights"),
        ("/material", "no-such-thing", "no-such-thing"),
        ("/camera/fov", 1e9, "field of view"),
    ],
)
def test_what_a_page_may_not_changes_nothing(shown, pointer, value, said):
    before = shown.document
    with pytest.raises(InputError, match=said):
        shown.set(pointer, value)
    assert shown.document == before
    assert not shown.can_undo


def test_all_that_is_allowed_is_there(shown):
    for pointer in ALLOWED:
        left_out = {"picture": {"roughness": 0.3} | shown.document["picture"], "materials": {}, "placements": {}}
        found = shown.document | left_out
        for name in pointer.split("/")[1:]:
            found = found[name]
        shown.set(pointer, found)


def test_the_roughness_is_the_pictures_or_the_materials(shown):
    assert shown.roughness is None
    shown.set("/material", "marble,roughness=.2")
    assert shown.roughness == pytest.approx(0.2)
    shown.set("/picture/roughness", 0.4)
    assert shown.roughness == pytest.approx(0.4)


@pytest.mark.parametrize(
    "wrong",
    [("spin", 1, 1, 0), ("orbit", "x", 1, 0), ("orbit", float("nan"), 1, 0), ("turn", 1, 1, 9), ("turn", 1, 1, -1)],
)
def test_wrong_gestures_are_refused(shown, stage, wrong):
    with pytest.raises(InputError):
        shown.move(stage, *wrong)


def test_gestures_that_wait_become_one():
    woken, refused = [], []
    inbox = Inbox(lambda: woken.append(1))
    for content in (
        {"gesture": "orbit", "right": 1, "up": 2},
        {"gesture": "orbit", "right": 3, "up": 4},
        {"gesture": "turn", "light": 1, "right": 1, "up": 0},
        {"gesture": "turn", "light": 2, "right": 1, "up": 0},
        {"set": "/material", "value": "jade"},
        {"set": "/material", "value": "wax"},
    ):
        inbox.put(Message(content, refused.append))
    found = [message.content for message in inbox.take(0)]
    assert found[0] == {"gesture": "orbit", "right": 4, "up": 6}
    assert [content.get("light") for content in found[1:3]] == [1, 2]
    assert found[3:] == [{"set": "/material", "value": "wax"}]
    assert len(woken) == 6
    for number in range(300):
        inbox.put(Message({"set": f"/lights/{number}"}, refused.append))
    assert len(inbox.take(0)) == 256
    assert len(refused) == 44
    assert "waiting already" in refused[0]["refused"]


def test_places_of_a_stroke_that_wait_become_one_message_of_at_most_64():
    inbox, brush = Inbox(lambda: None), {"tool": "paint"}
    inbox.put(Message({"paint": brush, "at": [[0, 0]], "begins": True}, print))
    for number in range(70):
        inbox.put(Message({"paint": brush, "at": [[number, 0]], "begins": False}, print))
    inbox.put(Message({"paint": brush, "at": "nowhere", "begins": False}, print))
    inbox.put(Message({"paint": {"tool": "erase"}, "at": [[1, 0]], "begins": False}, print))
    found = [message.content for message in inbox.take(0)]
    assert [len(content["at"]) for content in found] == [64, 7, 7, 1]
    assert found[0]["begins"] is True
    assert found[1]["at"][0] == [63, 0]
