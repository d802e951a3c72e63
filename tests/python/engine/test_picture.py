"""The layers of a picture: equilibrium in uniform light, light seen through the body, and how radiance leaves."""

from __future__ import annotations

import json

import numpy as np
import pytest

from quadgraph.base.errors import QuadGraphError
from quadgraph.file.graph_file import write
from quadgraph_validation.bodies.meshes import ball
from quadgraph_validation.truth.fresnel import transmittance_from_outside

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

RADIUS = 5.0  # mm
FAR = {"view": "0,0,600", "vertical_fov": 1.1, "width": 128, "height": 128}  # nearly parallel rays
PIXEL_MM = 2 * 600 * np.tan(np.radians(0.55)) / 128


@pytest.fixture(scope="module")
def engine(tmp_path_factory):
    """A ball; validation messages fail."""
    path = write(tmp_path_factory.mktemp("picture") / "ball.qgraph", [ball(RADIUS, 1)])
    engine = _core.Engine(path, validation=True)
    yield engine
    assert engine.validation_messages == []


def off_axis() -> np.ndarray:
    """Distance (h, w) of every pixel's ray from the centre of the ball, mm."""
    y, x = (np.mgrid[:128, :128] + 0.5 - 64) * PIXEL_MM
    return np.hypot(x, y)


@pytest.mark.parametrize("eta", [1.0, 1.3])
@pytest.mark.parametrize("mean_free_path", [1.0, 2.5, 10.0])
def test_a_body_that_absorbs_nothing_vanishes_in_even_light(engine, eta, mean_free_path):
    engine.set_material(f"sigma_s_prime={1 / mean_free_path},sigma_a=0,eta={eta}")
    engine.set_lights([f"ambient:{np.pi}"])  # radiance 1 from everywhere
    engine.solve(model="sp3", tolerance=1e-5)
    picture = engine.render(**FAR)
    total = (picture.scattered + picture.specular + picture.unscattered)[off_axis() < 0.95 * RADIUS, 0]
    off = np.quantile(np.abs(total - 1), 0.98)
    print(f"mean {total.mean():.4f}, 98% of all pixels within {off:.4f}")
    assert total.mean() == pytest.approx(1, abs=0.02)
    assert off < 0.06  # elements are up to one and a half mean free paths long


def test_a_clear_tinted_ball_shows_what_is_behind_by_beer_s_law(engine):
    sigma_a = np.array([0.02, 0.1, 0.3])  # 1/mm
    engine.set_material("sigma_s_prime=0,sigma_a={}/{}/{},eta=1".format(*sigma_a))
    engine.set_lights([f"ambient:{np.pi}"])
    engine.solve()
    picture = engine.render(**FAR)
    off = off_axis()
    inside = off < 0.9 * RADIUS
    chord = 2 * np.sqrt(RADIUS**2 - off[inside] ** 2)[:, None]
    path = -np.log(picture.transmittance[inside]) / sigma_a
    assert np.abs(path - chord).max() < 0.15  # mm: the ball has flat faces
    assert np.abs((path - chord).mean()) < 0.02
    assert np.allclose(picture.unscattered[inside], picture.transmittance[inside], rtol=1e-5)
    assert np.abs(picture.scattered[inside]).max() == 0
    black, white = (picture.srgb(json.dumps({"picture": {"background": name}}))[inside] for name in ("black", "white"))
    assert (white > black).all()


def test_reflection_inside_a_clear_ball_is_followed(engine):
    eta, sigma_a = 1.5, 0.03
    engine.set_material(f"sigma_s_prime=0,sigma_a={sigma_a},eta={eta}")
    engine.set_lights([f"ambient:{np.pi}"])
    engine.solve()
    picture = engine.render(**FAR, transmission_roughness=0)
    passes = transmittance_from_outside(np.array([1.0]), eta)[0]
    kept = np.exp(-2 * sigma_a * RADIUS)
    through = passes * kept * passes / (1 - (1 - passes) * kept)
    assert picture.transmittance[off_axis() < 0.15 * RADIUS, 0].mean() == pytest.approx(through, rel=0.01)


def test_what_cannot_be_gathered_is_lambertian_or_refused(engine):
    engine.set_material("marble")
    engine.set_lights(["directional:0,0,-1:1"])
    for way in ({"method": "quadgraph-fv"}, {"source": "diffuse"}):
        engine.solve(**way)
        shown, plain = engine.render(**FAR), engine.render(**FAR, radiance="lambertian")
        assert (shown.scattered == plain.scattered).all()
        assert ("radiance", "lambertian") in engine.metadata
        with pytest.raises(QuadGraphError, match=r"gathering needs --method fem, polygrid or .* --source buried"):
            engine.render(**FAR, radiance="gathered")
    with pytest.raises(QuadGraphError, match="allowed are gathered, lambertian, single, auto"):
        engine.render(**FAR, radiance="shiny")


def test_radiance_at_points_is_that_of_the_picture(engine):
    engine.set_material("marble")
    engine.set_lights(["directional:0.3,-0.2,-1:1"])
    engine.solve()
    picture = engine.render(**FAR, transmission_roughness=0)
    level = engine.graph.levels[0]
    centre = np.asarray(level.vertices, np.float64)[level.faces].mean(axis=1)
    seen = np.flatnonzero(centre[:, 2] > 0.6 * RADIUS)
    towards = np.array([0.0, 0.0, 600.0]) - centre[seen]
    towards /= np.linalg.norm(towards, axis=1)[:, None]
    light = engine.leaving(seen.astype(np.uint32), towards.astype(np.float32))
    column = np.round(64 + centre[seen, 0] / PIXEL_MM - 0.5).astype(int)
    row = np.round(64 - centre[seen, 1] / PIXEL_MM - 0.5).astype(int)
    assert np.median(np.abs(light["radiance"] / picture.scattered[row, column] - 1)) < 0.01
    with pytest.raises(QuadGraphError, match="point out of face"):
        engine.leaving(seen[:1].astype(np.uint32), -towards[:1].astype(np.float32))
    with pytest.raises(QuadGraphError, match="there are"):
        engine.leaving(np.array([len(level.faces)], np.uint32), np.array([[0.0, 0.0, 1.0]], np.float32))


@pytest.mark.parametrize("eta", [1.0, 1.4])
def test_the_unlit_side_of_a_thick_body_is_as_bright_as_its_exitance(engine, eta):
    """Through 21 mean free paths: uncollided light that ends before must not reappear between two vertices."""
    engine.set_material(f"sigma_s_prime=1.5,sigma_a=0.6,eta={eta}")
    along = np.array([0.3, -0.2, -1.0])
    engine.set_lights(["directional:0.3,-0.2,-1:1"])
    engine.solve(model="sp3", tolerance=1e-5)
    surface = engine.surface_field()
    unlit = np.flatnonzero(surface["normal"] @ along > 0)
    light = engine.leaving(unlit.astype(np.uint32), surface["normal"][unlit].astype(np.float32))
    ratio = np.pi * light["radiance"] / surface["exitance"][unlit]
    assert surface["exitance"][unlit].min() < 1e-5 * surface["exitance"].max()
    assert ratio.max() < 2.5
    assert ratio.min() > 0.3
