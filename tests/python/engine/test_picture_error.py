"""The error that is printed of a picture: of the part of the surface that it shows, and of the angle."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import quadgraph
from baked import write_levels
from quadgraph import cli
from quadgraph.api.lights import AmbientLight, DirectionalLight
from quadgraph.baking.pipeline import BakeOptions, bake
from shapes import icosphere, write_obj

MATERIAL = "sigma_s_prime=1,sigma_a=0.02,eta=1.3"
SUN = DirectionalLight((0.0, 0.0, -1.0), 1.0)
QUICK = {"sweeps": 1, "sweep_points": 2000}
SIZE = {"width": 64, "height": 64}
LARGE = {"width": 256, "height": 256}  # the shares that pixels of the silhouette have are of little weight
LIT, UNLIT = 89.0, -89.0  # elevations: from the sun, and from the other side


@pytest.fixture(scope="module")
def ball(tmp_path_factory) -> Path:
    return write_levels(tmp_path_factory.mktemp("ball") / "ball.qgraph", [icosphere(3, 10), icosphere(2, 10)])


@pytest.fixture
def engine(ball):
    with quadgraph.Engine(ball) as made:
        made.material, made.lights = MATERIAL, [SUN]
        yield made


def shown(engine, elevation: float, **options):
    return engine.render({"elevation": elevation, "up": "z"}, **SIZE | options)


def test_a_picture_has_the_error_of_the_part_of_the_surface_that_it_shows(engine):
    exitance = engine.solve(**QUICK).error
    lit, unlit = (shown(engine, side).error for side in (LIT, UNLIT))
    assert exitance.unlit > 1.2 * exitance.whole  # else nothing could be told apart
    assert lit.whole >= 0.99 * exitance.whole
    assert unlit.unlit >= 0.99 * min(exitance.unlit, exitance.dimmest)
    assert unlit.whole > 1.1 * lit.whole


def test_the_more_radiance_depends_on_the_angle_the_less_certain_it_is(engine):
    stated = []
    dense, thin = (f"sigma_s_prime={scatters},sigma_a=.01,eta=1.3" for scatters in (5, 0.2))
    for material, light in ((dense, AmbientLight(1.0)), (thin, SUN)):
        engine.material, engine.lights = material, [light]
        exitance = engine.solve(**QUICK).error
        picture = shown(engine, LIT, transmission_roughness=0)
        diffuse = shown(engine, LIT, radiance="lambertian")
        inside = picture.alpha == 1
        seen = picture.scattered[inside].sum(axis=1)
        of_angle = np.linalg.norm(seen - diffuse.scattered[inside].sum(axis=1)) / np.linalg.norm(seen)
        assert picture.error.whole > np.hypot(min(exitance.whole, exitance.dimmest), 0.04 * of_angle)
        assert picture.error.whole < np.hypot(max(exitance.whole, exitance.dimmest), 0.12 * of_angle)
        stated.append(of_angle)
    assert stated[1] > 2 * stated[0]


@pytest.mark.long
def test_more_samples_of_a_pixel_leave_the_error_as_it_is(engine):
    engine.solve(**QUICK)
    for elevation in (LIT, UNLIT, 0.0):
        for alpha in (0, 0.3):
            options = {"transmission_roughness": alpha, **LARGE}
            few, many = (shown(engine, elevation, samples=samples, **options).error for samples in (4, 64))
            for part in ("whole", "unlit", "dimmest"):
                # Of few facets the noise counts too.
                assert getattr(few, part) / getattr(many, part) == pytest.approx(1, rel=0.15 if alpha else 0.03)


def test_nothing_is_said_where_nothing_is_known(engine):
    engine.solve(**QUICK)
    assert shown(engine, LIT).error is not None
    assert shown(engine, LIT, radiance="lambertian").error is None
    assert shown(engine, LIT, radiance="single").error is None
    assert shown(engine, LIT, show="phi").error is None
    assert shown(engine, LIT).error is not None
    engine.solve(correction=False)
    assert shown(engine, LIT).error is None
    engine.solve(motion=True)
    assert shown(engine, LIT).error is not None


def test_commands_and_files_say_it(ball, tmp_path, capsys):
    picture, report = tmp_path / "ball.exr", tmp_path / "ball.json"
    scene = ["render", str(ball), "--material", MATERIAL, "--light", SUN.text, "--size", "64x64", "--sweeps", "1"]
    assert cli.main([*scene, "-o", str(picture), "--json", str(report)]) == 0
    error = json.loads(report.read_text())["picture_error"]
    assert 0 < error["whole"] < 0.1
    assert f"error of the picture: {100 * error['whole']:.2g}% whole" in capsys.readouterr().out
    assert b"picture error" in picture.read_bytes()


def by_block(picture) -> np.ndarray:
    """Radiance of red, means over blocks of 4 x 4 pixels, nothing where the body does not fill one."""

    def mean(values: np.ndarray) -> np.ndarray:
        return values.reshape(16, 4, 16, 4).mean(axis=(1, 3))

    return np.where(mean(picture.alpha) > 0.999, mean(picture.scattered[..., 0]), 0)


def test_steps_of_a_material_within_triangles_are_told_of_about_as_they_are(tmp_path):
    mesh = write_obj(icosphere(3, 10), tmp_path / "ball.obj")
    material = "sigma_s_prime=.6,sigma_a=.01,second_sigma_s_prime=.3,second_sigma_a=.3,pattern=checker,period=7,eta=1.2"
    blocks, stated = [], []
    for number, materials in enumerate(((), (material,))):
        file = tmp_path / f"{number}.qgraph"
        bake(mesh, file, BakeOptions(unit="mm", levels=2, visibility_rays=0, for_materials=materials))
        with quadgraph.Engine(file) as engine:
            engine.material, engine.lights = material, [AmbientLight(1.0)]
            engine.solve(sweeps=1)
            picture = shown(engine, 20.0, transmission_roughness=0)
        blocks.append(by_block(picture))
        stated.append(picture.error.whole)
    inside = (blocks[0] > 0) & (blocks[1] > 0)
    assert inside.sum() > 80
    coarse, fine = (each[inside] for each in blocks)
    true = np.linalg.norm(coarse - fine) / np.linalg.norm(fine)
    assert true > 0.03
    assert 1 / 2.5 < stated[0] / true < 2.5
    assert stated[1] < 0.6 * stated[0]


def test_a_pattern_of_two_alike_adds_nothing_and_one_of_two_others_much(engine):
    pattern = "sigma_s_prime=1,sigma_a=.02,pattern=checker,period=5,eta=1.3,second_sigma_s_prime=1,second_sigma_a="
    stated = []
    for material in (MATERIAL, f"{pattern}.02", f"{pattern}.2"):
        engine.material = material
        engine.solve(**QUICK)
        stated.append(shown(engine, LIT).error.whole)
    assert stated[1] == pytest.approx(stated[0], rel=0.05)
    assert stated[2] > 1.5 * stated[0]
