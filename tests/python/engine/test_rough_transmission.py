"""Roughness of the surface for light that comes out of it."""

from __future__ import annotations

import numpy as np
import pytest

from baked import write_levels
from quadgraph import Engine, InputError
from shapes import icosphere

RADIUS = 10.0
CAMERA = {"azimuth": 0.0, "elevation": 0.0, "distance": 400.0, "fov": 3.2}
LOOK = {"width": 48, "height": 48}
CLEAR = "sigma_s_prime=0.03,sigma_a=0.02,eta=1.5"


@pytest.fixture(scope="module")
def ball(tmp_path_factory):
    path = tmp_path_factory.mktemp("rough") / "ball.qgraph"
    write_levels(path, [icosphere(3, RADIUS)])
    return path


@pytest.fixture(scope="module")
def engine(ball):
    with Engine(ball, device="cpu") as made:
        made.material, made.lights = CLEAR, ["directional:0.5,-0.3,-1:1"]
        made.solve(correction=False)
        yield made


def scattered(engine, **options) -> np.ndarray:
    return np.asarray(engine.render(CAMERA, **LOOK, **options).scattered)


def test_it_is_that_of_the_surface_unless_it_is_said(engine):
    assert np.array_equal(scattered(engine, roughness=0.4), scattered(engine, transmission_roughness=0.4))
    usual = scattered(engine)
    assert np.array_equal(usual, scattered(engine, transmission_roughness=0.3))
    assert not np.array_equal(usual, scattered(engine, roughness=0.1))
    smooth = scattered(engine, transmission_roughness=0)
    assert np.array_equal(smooth, scattered(engine, transmission_roughness=0, roughness=0.9))


def test_a_rough_surface_that_is_nearly_smooth_shows_what_a_smooth_one_does(engine):
    smooth, nearly = (scattered(engine, transmission_roughness=alpha, samples=16) for alpha in (0, 0.001))
    inside = np.asarray(engine.render(CAMERA, **LOOK).alpha) > 0.999
    assert np.linalg.norm((nearly - smooth)[inside]) < 2e-3 * np.linalg.norm(smooth[inside])


def test_without_refraction_there_are_no_facets(ball):
    with Engine(ball, device="cpu") as engine:
        engine.material, engine.lights = "sigma_s_prime=0.1,sigma_a=0.02,eta=1", ["ambient:1"]
        engine.solve(correction=False)
        smooth, rough = (scattered(engine, transmission_roughness=alpha) for alpha in (0, 0.8))
        inside = np.asarray(engine.render(CAMERA, **LOOK).alpha) > 0.999
    assert np.linalg.norm((rough - smooth)[inside]) < 2e-3 * np.linalg.norm(smooth[inside])


def test_noise_falls_with_samples(engine):
    """As fast as chance makes it, or faster: facets of one pixel are drawn evenly."""
    size = {"width": 14, "height": 14, "transmission_roughness": 0.5}
    settled = np.asarray(engine.render(CAMERA, **size, samples=1024).scattered)
    inside = np.asarray(engine.render(CAMERA, **size).alpha) > 0.999
    few, many = (
        np.sqrt(((engine.render(CAMERA, **size, samples=samples).scattered - settled)[inside] ** 2).mean())
        for samples in (8, 128)
    )
    print(f"{few / settled[inside].mean():.2%} with 8 samples, {many / settled[inside].mean():.2%} with 128")
    assert many < few / 3


@pytest.mark.long
def test_devices_agree(tmp_path):
    ball = tmp_path / "ball.qgraph"
    write_levels(ball, [icosphere(3, RADIUS)])
    pictures = []
    for device in ("cpu", "llvmpipe"):
        with Engine(ball, device=device) as engine:
            engine.material, engine.lights = CLEAR, ["ambient:1"]
            engine.solve(correction=False, tolerance=1e-5)
            pictures.append(engine.render(CAMERA, width=24, height=24, transmission_roughness=0.3))
    inside = np.minimum(*(np.asarray(each.alpha) for each in pictures)) > 0.999
    one, other = (np.asarray(each.scattered)[inside] for each in pictures)
    assert np.linalg.norm(one - other) < 2e-3 * np.linalg.norm(one)


@pytest.mark.parametrize("value", [-0.1, 1.1])
def test_what_is_out_of_range_is_refused(engine, value):
    with pytest.raises(InputError, match="transmission_roughness"):
        engine.render(CAMERA, **LOOK, transmission_roughness=value)
