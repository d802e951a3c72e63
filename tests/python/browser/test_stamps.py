"""Images that a page's brush stamps, and coefficients that it changes: what is taken, and what the scene becomes."""

from __future__ import annotations

import io
import json
import struct
import zipfile
import zlib
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, PngImagePlugin

import quadgraph
from baked import write_levels
from quadgraph.base.errors import InputError
from quadgraph.browser import shown_scene, stamps
from quadgraph.browser.shown_scene import ShownScene
from quadgraph.browser.stamps import Stamps
from shapes import icosphere

MIDDLE = [0.5, 0.5]
SIGNATURE = b"\x89PNG\r\n\x1a\n"


def png(width=8, height=8, colour=(255, 255, 255), **options):
    made = io.BytesIO()
    Image.new("RGB", (width, height), colour).save(made, "PNG", **options)
    return made.getvalue()


def chunk(kind, content):
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))


def header(width, height):
    return chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))


@pytest.fixture(scope="module")
def ball(tmp_path_factory):
    return write_levels(tmp_path_factory.mktemp("bodies") / "ball.qgraph", [icosphere(2, 10), icosphere(1, 10)])


@pytest.fixture
def folder(tmp_path):
    """A folder beside whose scene there are a black and white image and what is none."""
    two = np.zeros((8, 8, 3), np.uint8)
    two[:, 4:] = 255
    Image.fromarray(two).save(tmp_path / "right.png")
    (tmp_path / "notes.txt").write_text("no image")
    (tmp_path / "folder.png").mkdir()
    return tmp_path


@pytest.fixture
def known(folder):
    with Stamps(folder) as made:
        yield made


@pytest.fixture(scope="module")
def stage(ball):
    with quadgraph.Stage(device="cpu") as made:
        made.show(quadgraph.Scene(ball))
        yield made


@pytest.fixture
def shown(ball, stage, known):
    picture = {"width": 96, "height": 64, "ground": False}
    camera = {"azimuth": 0, "elevation": 0}
    scene = quadgraph.Scene(ball, material="wholemilk", lights=["ambient:1"], picture=picture, camera=camera)
    made = ShownScene(scene, stamps=known)
    stage.show(made.scene)
    return made


@pytest.fixture
def hand(shown, stage):
    def paint(*places, begins=True, **brush):
        stage.show(shown.scene)
        return shown.paint(stage, {**stage.usual_brush, "layer": 0, **brush}, list(places), begins)

    return paint


def exitance_about_middle(stage, scene):
    """Mean green on a strip left and right of the middle of the picture."""
    stage.show(scene)
    stage.engine.solve(correction=False)
    green = stage.render().scattered[..., 1]
    return green[28:36, 40:46].mean(), green[28:36, 50:56].mean()


def test_a_mask_is_stamped_where_the_hand_lets_it_go(shown, stage, hand, folder):
    clean = exitance_about_middle(stage, shown.scene)
    hand([0.4, 0.4], mask="right.png", radius=4, depth=4, falloff=0)
    hand(MIDDLE, begins=False, mask="right.png", radius=4, depth=4, falloff=0)
    (edit,) = shown.document["edits"]
    assert edit["mask"] == str(folder / "right.png")
    assert edit["placement"]["centre"] == pytest.approx([0, 0, 10], abs=0.4)
    assert edit["placement"]["size"] == pytest.approx([8, 8, 8])
    left, right = exitance_about_middle(stage, shown.scene)
    assert right < 0.6 * clean[1]  # the brush is red, which lets no green back
    assert left > 1.5 * right
    hand(MIDDLE, tool="erase")
    assert shown.layers[0]["strokes"] == 0


def test_a_pattern_is_stamped_in_the_coefficients_of_the_brush(shown, stage, hand, folder):
    added = {"operation": "add", "sigma_a": [2, 2, 2]}
    clean = exitance_about_middle(stage, shown.scene)
    hand(MIDDLE, pattern="right.png", radius=4, depth=4, depth_from=0.5, falloff=0, coefficients=added)
    (edit,) = shown.document["edits"]
    assert edit["image"] == str(folder / "right.png")
    assert (edit["operation"], edit["sigma_a"], list(edit["depth"])) == ("add", 2, [0.5, 4])
    assert "sigma_s_prime" not in edit
    left, right = exitance_about_middle(stage, shown.scene)
    assert right < 0.6 * clean[1]
    assert left > 1.5 * right


@pytest.mark.parametrize("operation", ["multiply", "add", "set"])
def test_coefficients_are_multiplied_added_and_set(shown, hand, operation):
    by = {"operation": operation, "sigma_a": [1, 2, 3], "sigma_s_prime": 4}
    hand(MIDDLE, coefficients=by)
    (edit,) = json.loads(json.dumps(shown.document["edits"]))
    assert {name: edit[name] for name in by} == by
    assert len(edit["stroke"]) == 1


def test_the_stage_paints_the_same(shown, stage, hand, folder):
    brush = {**stage.usual_brush, "layer": 0, "coefficients": {"operation": "multiply", "sigma_s_prime": 2}}
    start = shown.scene
    hand(MIDDLE, mask="right.png", coefficients=brush["coefficients"])
    stage.show(start)
    scene, _ = stage.painted(brush | {"mask": folder / "right.png"}, [(48, 32)])
    assert scene.to_dict()["edits"] == shown.document["edits"]


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"mask": "/etc/passwd"}, "mask: found the image .*/etc/passwd.*there are right.png"),
        ({"mask": "../right.png"}, "mask"),
        ({"mask": "notes.txt"}, "mask"),
        ({"mask": "folder.png"}, "mask"),
        ({"mask": ["right.png"]}, "mask"),
        ({"mask": None}, "mask"),
        ({"pattern": "gone.png"}, "pattern"),
        ({"depth_from": -1}, "depth_from"),
        ({"depth_from": 1e3}, "depth_from.*less than depth"),
        ({"coefficients": {"operation": "multiply"}}, "coefficients.*found neither"),
        ({"coefficients": {"operation": "divide", "sigma_a": 2}}, "operation"),
        ({"coefficients": {"operation": "set", "sigma_a": -1}}, "sigma_a"),
        ({"coefficients": {"operation": "set", "sigma_a": 1e9}}, "sigma_a"),
        ({"coefficients": {"operation": "set", "sigma_a": [1, 2]}}, "sigma_a"),
        ({"coefficients": {"operation": "set", "sigma_a": 1, "image": "right.png"}}, "image"),
        ({"coefficients": [1]}, "coefficients"),
    ],
)
def test_wrong_stamps_and_coefficients_are_refused_by_name(shown, hand, wrong, said):
    before = shown.document
    with pytest.raises(InputError, match=said):
        hand(MIDDLE, **wrong)
    assert shown.document == before


def test_images_in_strokes_have_an_end(shown, hand, known, monkeypatch):
    monkeypatch.setattr(shown_scene, "MOST_STAMPED", 1)
    hand(MIDDLE, mask="right.png")
    hand(MIDDLE, mask="right.png")
    sent = known.take("another.png", png())
    before = shown.document
    with pytest.raises(InputError, match="found 2 images, allowed are 1"):
        hand(MIDDLE, mask=sent)
    assert shown.document == before


def test_what_was_sent_has_a_name_of_its_own_and_is_gone_at_the_end(folder):
    kept = set(folder.iterdir())
    with Stamps(folder) as known:
        assert known.names == ["right.png"]
        said = ["a.png", "a.PNG", "right.png", "../../a b.png"]
        names = [known.take(name, png(8 + i)) for i, name in enumerate(said)]
        assert names == ["a.png", "a-2.png", "right-2.png", "a-b.png"]
        assert known.take("b.png", png(9)) == "a-2.png"  # which was there
        assert known.take("." * 99, png(99)) == "image.png"
        assert len(known.take("long" * 99, png(98))) < 64
        paths = [known.path(name) for name in names]
        assert all(quadgraph.core.read_image(path).shape == (8, 8 + i, 3) for i, path in enumerate(paths))
    assert set(folder.iterdir()) == kept
    for path in paths:
        with pytest.raises(InputError, match="cannot be read"):
            quadgraph.core.read_image(path)
    with Stamps() as none, pytest.raises(InputError, match="none yet"):
        none.path("right.png")


def test_only_what_makes_the_picture_is_kept(known):
    words = PngImagePlugin.PngInfo()
    words.add_text("where", "x" * 2_000_000, zip=True)
    name = known.take("with_words.png", png(pnginfo=words) + b"and more behind its end")
    assert Path(known.path(name)).read_bytes() == png()


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "no PNG"),
        (b"GIF89a" + bytes(64), "no PNG"),
        (SIGNATURE, "does not say its size"),
        (SIGNATURE + chunk(b"IHDR", b""), "does not say its size"),
        (SIGNATURE + chunk(b"IDAT", zlib.compress(bytes(9))) + chunk(b"IEND", b""), "does not say its size"),
        (SIGNATURE + header(0, 8) + chunk(b"IEND", b""), "0x8 texels"),
        (SIGNATURE + header(100_000, 100_000) + chunk(b"IEND", b""), "100000x100000 texels"),
        (SIGNATURE + header(1025, 1) + chunk(b"IEND", b""), "1025x1 texels, allowed are 1 to 1024"),
        (SIGNATURE + header(8, 8) + b"\xff\xff\xff\xffIDAT", "cut off"),
        (SIGNATURE + header(8, 8) + chunk(b"IDAT", b"nothing packed") + chunk(b"IEND", b""), "image: "),
        (SIGNATURE + header(8, 8) + chunk(b"IEND", b""), "image: "),
        (png()[:-20], "cut off"),
        (png(1024, 1024).replace(b"IHDR", b"JHDR"), "does not say its size"),
        (png() + bytes(stamps.MOST_SENT_BYTES), "bytes, allowed are 4194304"),
    ],
)
def test_hostile_images_are_refused_and_not_kept(known, content, said):
    with pytest.raises(InputError, match=said) as error:
        known.take("hostile.png", content)
    assert str(known.folder) not in str(error.value)
    assert known.names == ["right.png"]
    assert list(known.folder.iterdir()) == []


def test_so_many_are_sent_and_no_more(known, monkeypatch):
    monkeypatch.setattr(stamps, "MOST_SENT", 2)
    for side in (8, 9):
        known.take("a.png", png(side))
    with pytest.raises(InputError, match="2 were sent already"):
        known.take("a.png", png(10))
    assert known.take("a.png", png(9)) == "a-2.png"


def test_a_bundle_is_a_scene_that_can_be_opened_elsewhere(shown, hand, known, folder, tmp_path_factory):
    sent = known.take("dot.png", png())
    assert shown.sent_stamps == []
    hand(MIDDLE, mask=sent)
    hand([0.45, 0.5], mask="right.png")
    assert shown.sent_stamps == ["dot.png"]
    place = tmp_path_factory.mktemp("elsewhere")
    with zipfile.ZipFile(io.BytesIO(known.bundle(shown.document))) as archive:
        assert sorted(archive.namelist()) == ["dot.png", "scene.json"]
        archive.extractall(place)
    known.close()
    first, second = json.loads((place / "scene.json").read_text())["edits"]
    assert (first["mask"], second["mask"]) == ("dot.png", str(folder / "right.png"))
    opened = quadgraph.SceneFile(place / "scene.json").at(0).to_dict()["edits"]
    assert opened[0]["mask"] == str(place / "dot.png")
    assert [edit | {"mask": ""} for edit in opened] == [edit | {"mask": ""} for edit in shown.document["edits"]]
