"""From light to the screen in Python: samples, lens, curve and white, and what is said of each."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from PIL import Image

import quadgraph
import tiny
from quadgraph.base.errors import InputError

SIZE = {"width": 60, "height": 40}


@pytest.fixture(scope="module")
def picture():
    """The cube of 2 mm in light of two colours."""
    with quadgraph.Engine(tiny.PATH) as engine:
        engine.material = "sigma_s_prime=2/1/1,sigma_a=.05/.2/.4,eta=1.3"
        engine.lights = ["directional:-.3,-.4,-.866:3/1/1", "ambient:.3"]
        engine.solve()
        yield engine.render({"azimuth": 30, "elevation": 20}, **SIZE, samples=16)


@pytest.fixture
def engine():
    with quadgraph.Engine(tiny.PATH) as made:
        made.material, made.lights = "sigma_s_prime=2,sigma_a=.05,eta=1.3", ["directional:-.3,-.4,-.866:3"]
        made.solve()
        yield made


def test_alpha_has_as_many_steps_as_there_are_places_that_tell_what_is_covered(engine):
    for samples in (4, 12, 64):
        alpha = engine.render({"azimuth": 30, "elevation": 20}, **SIZE, samples=samples).alpha.astype(float)
        steps = 128 * alpha * samples / 4  # of four samples each
        assert np.abs(steps - np.rint(steps)).max() < 1e-3
        assert len(np.unique(np.rint(steps))) > 32


def test_a_silhouette_is_within_a_hundredth_of_what_more_samples_show(engine):
    shown, alpha = {}, {}
    for samples in (4, 16, 64):
        picture = engine.render({"azimuth": 30, "elevation": 20}, **SIZE, samples=samples)
        shown[samples], alpha[samples] = picture.srgb(exposure=1).astype(float) / 255, picture.alpha
    edge = (alpha[64] > 0) & (alpha[64] < 1)
    assert edge.sum() > 100
    for samples, allowed in {4: 0.015, 16: 0.01}.items():
        assert np.sqrt(((shown[samples] - shown[64])[edge] ** 2).mean()) < allowed


def test_a_lens_blurs_what_it_is_not_in_focus_on(engine):
    camera = {"azimuth": 0, "elevation": 0, "distance": 12, "fov": 20}
    edges = {}
    for name, lens in {"none": {}, "near": {"aperture": 3}, "far": {"aperture": 3, "focus": 30}}.items():
        alpha = engine.render(camera | lens, **SIZE).alpha
        edges[name] = ((alpha > 0.02) & (alpha < 0.98)).sum()
    assert edges["far"] > 3 * edges["none"]
    assert edges["near"] < 0.5 * edges["far"]
    with pytest.raises(InputError, match="aperture: found 3 with orthographic"):
        engine.render({"orthographic": 5, "aperture": 3}, **SIZE)


def test_every_curve_shows_it_and_files_say_which(picture, tmp_path):
    shown = {tone: picture.srgb(tone=tone, exposure=1).astype(int) for tone in ("agx-punchy", "agx", "aces", "linear")}
    assert np.array_equal(shown["agx-punchy"], picture.srgb(exposure=1))
    for one, other in itertools.combinations(shown, 2):
        assert np.abs(shown[one] - shown[other]).max() > 10
    for suffix in ("png", "jpg"):
        picture.save(tmp_path / f"a.{suffix}", tone="agx", white_balance=5000)
    with Image.open(tmp_path / "a.png") as image:
        assert (image.info["tone"], image.info["white balance"]) == ("agx", "5000 K")
        assert np.array_equal(np.asarray(image), picture.srgb(tone="agx", white_balance=5000))


def test_the_balance_of_white_is_cooler_below_and_warmer_above(picture):
    red_over_blue = []
    for kelvin in (3000, 5000, 6504, 9000, 20000):
        shown = picture.srgb(white_balance=kelvin, tone="linear", exposure=0)[picture.alpha == 1].astype(float)
        red_over_blue.append(shown[:, 0].mean() / shown[:, 2].mean())
    assert all(np.diff(red_over_blue) > 0)


def test_what_is_not_allowed_is_refused(picture):
    for tone, said in (
        ({"tone": "film"}, "allowed are agx-punchy, agx, aces, linear"),
        ({"white_balance": 900}, "white balance: found 900, expected"),
        ({"contrast": 2}, "contrast: not known; background, exposure, tone, white_balance are"),
    ):
        with pytest.raises(InputError, match=said):
            picture.srgb(**tone)
