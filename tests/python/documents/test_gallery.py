"""The gallery: every scene has its body, its picture and its sentence."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from PIL import Image

from quadgraph_validation.bodies.gallery_bodies import BODIES

DOCS = Path(__file__).resolve().parents[3] / "docs"
SCENES = {path.stem: path for path in sorted((DOCS / "scenes/gallery").glob("*.json"))}
MOST_BYTES = 250_000


def test_every_body_is_in_a_scene():
    bodies = {Path(json.loads(path.read_text())["body"]).stem for path in SCENES.values()}
    assert bodies == {*BODIES, "bunny"}


@pytest.mark.parametrize("name", SCENES)
def test_every_scene_has_its_picture_and_how_to_make_it(name: str):
    text = (DOCS / "gallery.md").read_text()
    picture = DOCS / f"images/gallery-{name}.jpg"
    assert f"(images/{picture.name})" in text
    assert f"`tools/gallery {name}`" in text
    assert picture.stat().st_size < MOST_BYTES
    with Image.open(picture) as image:
        assert image.width >= 1200


def test_the_film_is_as_long_as_the_page_says():
    scene = json.loads(SCENES["film"].read_text())
    assert scene["frames"] / scene["frames_per_second"] == 20
    assert f"{scene['frames_per_second']} frames a second" in (DOCS / "gallery.md").read_text()
