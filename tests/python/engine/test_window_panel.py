"""The window's panel under a hand: a body that deforms, lights by their images, and stamps."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from PIL import Image
from test_window import QUICK_SCENE, SIZE, Hand, open_window, pytestmark, server

from baked import write_levels
from quadgraph.mesh.surface import Surface
from shapes import icosphere

__all__ = ["open_window", "pytestmark", "server"]

TALL = 890  # a window in which the section Shape is seen
# Heights in the mode Look:
SHAPE, TWIST = 737, 762  # a section to open and its first slider, with two lights
IMAGE = 562  # the name of an image, of the only light
PAINT, RADIUS, TO_DEPTH, MASK = 462, 612, 637, 687  # a section to open, and in it


def press(hand: Hand, y: int, *held: str) -> None:
    """Click into the panel at that height, once it is calm."""
    hand.calm()
    down, up = (["keydown", *held], ["keyup", *held]) if held else ([], [])
    hand.do("mousemove", "100", str(y), *down, "click", "1", *up)


def put(hand: Hand, y: int, text: str, *held: str) -> None:
    """Type into what is at that height, in place of what it said."""
    press(hand, y, *held)
    hand.keys("ctrl+a")
    hand.do("type", "--delay", "20", text)
    hand.keys("Return")


def width_at(picture: np.ndarray, share: float) -> int:
    """Pixels of the body in the row at that share of its height, from above."""
    body = picture.max(axis=2) > 60
    rows = np.flatnonzero(body.any(axis=1))
    return int(body[round(rows[0] + share * (rows[-1] - rows[0]))].sum())


def test_a_body_twists_where_it_should_and_comes_back(open_window, tmp_path: Path):
    """An ellipsoid of 20 x 20 x 10 mm, twisted by 90 degrees from its foot to its head."""
    ball = [icosphere(n, 10) for n in (3, 2)]
    body = write_levels(tmp_path / "egg.qgraph", [Surface(s.vertices * [1, 1, 0.5], s.triangles) for s in ball])
    look = ["--view", "0,0,300", "--fov", "8", "--exposure", "1", "--no-ground", "--background", "black"]
    light = ["--light", "directional:0,0,-1:1", "--light", "ambient:1", "--radiance", "lambertian"]
    hand = open_window("--material", "wholemilk", *look, *light, body=body)
    hand.do("windowsize", "--sync", hand.window, str(SIZE[0]), str(TALL))
    press(hand, SHAPE)
    before = hand.screen()[:TALL, 340 : SIZE[0]]

    def is_twisted(now: np.ndarray) -> bool:
        """By the ellipse across, seen from the front."""
        shares = np.array([0.2, 0.5, 0.8])
        turn = np.radians(90 * (1 - shares))
        found = [width_at(now, share) / width_at(before, share) for share in shares]
        return bool(np.abs(found - np.hypot(np.cos(turn), 0.5 * np.sin(turn))).max() < 0.04)

    put(hand, TWIST, "90", "ctrl")
    twisted = hand.screen()[:TALL, 340 : SIZE[0]]
    assert is_twisted(twisted)
    hand.keys("ctrl+z")
    assert np.abs(hand.screen()[:TALL, 340 : SIZE[0]] - before).max() <= 1
    hand.keys("ctrl+y")
    assert np.abs(hand.screen()[:TALL, 340 : SIZE[0]] - twisted).max() <= 1
    hand.keys("ctrl+s")
    hand.settle()
    (deformer,) = json.loads((tmp_path / "egg-1.json").read_text())["deformation"]
    assert (deformer["type"], deformer["degrees"]) == ("twist", 90)
    hand.close()


def test_a_projector_takes_the_image_that_is_typed(open_window, tmp_path: Path):
    """White at first, then dark on the left; a name that is none changes nothing."""
    write_levels(tmp_path / "ball.qgraph", [icosphere(3, 10), icosphere(2, 10)])
    texels = np.full((16, 16), 255, np.uint8)
    Image.fromarray(texels).save(tmp_path / "white.png")
    texels[:, :8] = 0
    Image.fromarray(texels).save(tmp_path / "half.png")
    light = {"type": "projector", "position": [0, 0, 80], "direction": [0, 0, -1], "angle": 20, "file": "white.png"}
    scene = {
        "body": "ball.qgraph",
        "material": "sigma_s_prime=5,sigma_a=.5",
        "lights": [{**light, "power": 100}],
        "camera": {"elevation": 0},
        "picture": QUICK_SCENE["picture"] | {"exposure": 2, "background": "black"},
        "solver": QUICK_SCENE["solver"],
    }
    (tmp_path / "lit.json").write_text(json.dumps(scene))
    hand = open_window(body=tmp_path / "lit.json")
    whole = hand.picture()

    middle = whole.shape[1] // 2
    left, right = np.s_[200:400, middle - 100 : middle - 40], np.s_[200:400, middle + 40 : middle + 100]

    put(hand, IMAGE, "half.png")
    half = hand.other_picture(whole)
    assert half[left].mean() < 0.4 * whole[left].mean()
    assert half[right].mean() > 0.8 * whole[right].mean()
    told = np.s_[-60:, :400]
    put(hand, IMAGE, "none.png")
    none = hand.other_picture(half)
    assert np.abs(none[told] - half[told]).max() > 60
    assert np.array_equal(none[:-80], half[:-80])
    hand.keys("ctrl+z")
    assert np.abs(hand.other_picture(none)[:-80] - whole[:-80]).max() <= 1
    hand.close()


def test_a_stamp_prints_its_mask_where_the_hand_lets_it_go(open_window, tmp_path: Path):
    """The upper half of a square of 8 mm, at first on the middle of a ball, then to its right and there undone."""
    body = write_levels(tmp_path / "ball.qgraph", [icosphere(4, 10), icosphere(3, 10)])
    texels = np.zeros((32, 32), np.uint8)
    texels[:16] = 255
    Image.fromarray(texels).save(tmp_path / "upper.png")
    look = ["--view", "0,0", "--radiance", "lambertian", "--light", "directional:0,0,-1:1", "--light", "ambient:.3"]
    hand = open_window("--material", "skin1", "--exposure", "2.6", "--no-ground", *look, body=body)
    hand.do("windowsize", "--sync", hand.window, str(SIZE[0]), str(TALL))
    press(hand, PAINT)
    put(hand, MASK, "none.png")
    told = hand.screen()[:TALL, 340 : SIZE[0]]
    put(hand, MASK, "upper.png")
    put(hand, RADIUS, "4", "ctrl")
    put(hand, TO_DEPTH, "3", "ctrl")
    before = hand.screen()[:TALL, 340 : SIZE[0]]
    assert np.abs(told[-60:, :400] - before[-60:, :400]).max() > 60
    hand.keys("p")

    def stamp(right: int) -> np.ndarray:
        """Pressed down in the middle, let go so many pixels beside it: how much darker each pixel is then."""
        hand.do("mousemove", str(620), str(TALL // 2), "mousedown", "1", "sleep", "0.2")
        hand.do("mousemove_relative", "--", str(right), "0", "sleep", "0.2", "mouseup", "1")
        return (before - hand.screen()[:TALL, 340 : SIZE[0]]).sum(axis=2)

    def printed(darker: np.ndarray, column: int) -> tuple[float, float]:
        row = TALL // 2
        columns = np.s_[column - 40 : column + 40]
        return darker[row - 70 : row - 30, columns].mean(), darker[row + 30 : row + 70, columns].mean()

    upper, lower = printed(stamp(0), 280)
    assert upper > 60
    assert lower < 0.2 * upper
    hand.keys("ctrl+z")
    darker = stamp(130)
    upper, lower = printed(darker, 410)
    assert upper > 60
    assert lower < 0.2 * upper
    assert printed(darker, 230)[0] < 0.2 * upper
    hand.keys("ctrl+s")
    hand.settle()
    (edit,) = json.loads((tmp_path / "ball-1.json").read_text())["edits"]
    assert edit["mask"] == "upper.png"
    centre, direction = np.array(edit["placement"]["centre"]), np.array(edit["placement"]["direction"])
    assert np.allclose(np.linalg.norm(centre), 10, atol=0.1)
    assert 3.5 < centre[0] < 7
    assert np.allclose(direction, -centre / 10, atol=0.05)
    hand.keys("Escape", "ctrl+z")  # without the brush, whose ring is on the body
    assert np.abs(hand.screen()[: TALL - 80, 340 : SIZE[0]] - before[:-80]).max() <= 1
    hand.close()
