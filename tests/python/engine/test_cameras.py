"""Orthographic cameras against the limit of far ones, cameras by places, and both in scene files and command lines."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import quadgraph
from baked import write_levels
from light_truth import write_hdr
from quadgraph import cli
from quadgraph.base.errors import InputError
from shapes import icosphere, join, moved

core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

RADIUS, SIDE, HEIGHT = 10.0, 160, 44.0  # mm, pixels, mm
FAR = 2e5  # mm
LOOK = {"width": SIDE, "height": SIDE}
SUN = "directional:0.5,-0.6,-0.8:1"


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """Two balls beside each other, none of them about the origin, and an environment that is brighter on one side."""
    path = tmp_path_factory.mktemp("cameras")
    balls = [
        join(moved(icosphere(level, RADIUS), 5, 8, -3), moved(icosphere(level, 4.0), 20, 2, 6)) for level in (3, 2)
    ]
    write_levels(path / "balls.qgraph", balls, rays=64)
    write_hdr(path / "side.hdr", np.repeat(np.linspace(0.1, 1, 64)[None, :, None], 32, 0).repeat(3, 2))
    return path


@pytest.fixture(scope="module")
def engine(folder):
    engine = core.Engine(folder / "balls.qgraph", validation=True)
    engine.set_material("sigma_s_prime=1,sigma_a=.02,eta=1.3")
    engine.set_lights([SUN, f"environment:{folder / 'side.hdr'}:0:.2", "ambient:.3"])
    engine.solve(correction=False)
    yield engine
    assert engine.validation_messages == []


def far(view: str = "33,21") -> dict:
    """A camera from which the height of the picture shows HEIGHT in the middle of the body."""
    return LOOK | {"view": f"{view},{FAR}", "vertical_fov": float(2 * np.degrees(np.arctan(HEIGHT / 2 / FAR)))}


def parallel(view: str = "33,21") -> dict:
    return LOOK | {"view": view, "orthographic": HEIGHT}


def assert_same(a: np.ndarray, b: np.ndarray, share: float = 2e-3) -> None:
    """Relative to the brighter, but for some samples of edges."""
    off = np.abs(np.asarray(a) - np.asarray(b)) / max(np.abs(a).max(), 1e-9)
    assert np.mean(off > 2e-3) < share
    assert off.mean() < 1e-3


@pytest.mark.parametrize("radiance", ["gathered", "lambertian"])
def test_a_far_camera_shows_what_parallel_rays_do(engine, radiance):
    seen, limit = (engine.render(**look, radiance=radiance, ground=True) for look in (far(), parallel()))
    assert np.mean((limit.alpha > 0) & (limit.alpha < 0.5)) > 0  # the shadow on the ground
    for layer in ("alpha", "scattered", "specular", "unscattered", "transmittance"):
        assert_same(getattr(seen, layer), getattr(limit, layer))


@pytest.mark.parametrize("show", ["q", "exitance", "phi:z", "tets:x,2", "links:y", "levels:1"])
def test_views_of_the_inside_are_those_of_far_cameras(engine, show):
    # Lines face the eye, and their edges are shared out among pixels by single precision.
    seen, limit = (engine.render(**look, show=show) for look in (far(), parallel()))
    assert_same(seen.scattered, limit.scattered, 0.02)


def test_parallel_rays_see_one_point_of_what_surrounds_the_body(engine):
    picture = engine.render(**parallel(), surroundings=True)
    around = np.asarray(picture.surroundings)
    assert around.max() > 0
    assert np.ptp(around, axis=(0, 1)).max() < 1e-6
    assert_same(engine.render(**far(), surroundings=True).surroundings, around)


def test_a_ball_has_its_radius_and_place(tmp_path):
    path = write_levels(tmp_path / "ball.qgraph", [moved(icosphere(4, RADIUS), 5, 8, -3)])
    with quadgraph.Engine(path) as engine:
        engine.material = "marble"
        engine.solve(correction=False)
        picture = engine.render({"orthographic": 30, "azimuth": 40}, width=SIDE, height=SIDE)
        places = engine.render({"orthographic": 30, "eye": (5, 8, 1), "look_at": (5, 8, -3)}, width=SIDE, height=SIDE)
        beside = engine.render({"orthographic": 30, "eye": (9, 8, 1), "look_at": (9, 8, -3)}, width=SIDE, height=SIDE)
    pixel = 30 / SIDE
    for seen, right in ((picture, 0.0), (places, 0.0), (beside, -4.0)):
        assert np.sqrt(seen.alpha.sum() / np.pi) * pixel == pytest.approx(RADIUS, rel=3e-3)
        columns = np.arange(SIDE) + 0.5 - SIDE / 2
        assert (seen.alpha.sum(axis=0) @ columns) / seen.alpha.sum() * pixel == pytest.approx(right, abs=0.05 * pixel)


def test_what_is_picked_lies_where_it_is_seen(engine):
    seen = engine.pick((-0.2, -0.1), view="0,0", orthographic=HEIGHT)
    limit = engine.pick((-0.2, -0.1), view=f"0,0,{FAR}", vertical_fov=far()["vertical_fov"])
    assert np.allclose(seen["position"], limit["position"], atol=1e-3)
    assert np.allclose(seen["normal"], limit["normal"])
    assert engine.pick((0.95, 0.95), view="0,0", orthographic=HEIGHT) is None


def test_a_cut_face_is_that_of_a_far_camera(folder):
    engine = core.Engine(folder / "balls.qgraph")
    engine.set_material("marble")
    engine.set_lights([SUN])
    engine.set_cuts(json.dumps([{"type": "sphere", "centre": [10, 12, 5], "radius": 8}]))
    engine.solve(method="shortest-path")
    seen, limit = (engine.render(**look) for look in (far(), parallel()))
    assert_same(seen.scattered, limit.scattered)
    assert_same(seen.specular, limit.specular, 0.01)
    picked = [
        engine.pick((0, 0), view="33,21", orthographic=HEIGHT),
        engine.pick((0, 0), view=f"33,21,{FAR}", vertical_fov=far()["vertical_fov"]),
    ]
    assert np.allclose(picked[0]["position"], picked[1]["position"], atol=1e-3)


def scene(folder: Path, camera: dict) -> dict:
    return {
        "body": str(folder / "balls.qgraph"),
        "lights": [{"type": "directional", "direction": [0, -0.6, -0.8], "irradiance": 1}],
        "camera": camera,
        "solver": {"correction": False},
        "picture": {"width": SIDE, "height": SIDE},
    }


@pytest.mark.parametrize(
    ("camera", "options"),
    [
        ({"azimuth": 20, "elevation": 5, "orthographic": 60}, ["--view", "20,5", "--orthographic", "60"]),
        ({"eye": [60, 50, 90], "look_at": [10, 5, 0]}, ["--eye", "60,50,90", "--look-at", "10,5,0"]),
        (
            {"eye": [60, 50, 90], "look_at": [10, 5, 0], "orthographic": 0, "up": "z"},
            ["--eye", "60,50,90", "--look-at", "10,5,0", "--orthographic", "0", "--up", "z"],
        ),
    ],
)
def test_a_scene_file_and_the_command_line_say_the_same(folder, tmp_path, camera, options):
    path, outputs = tmp_path / "scene.json", [tmp_path / "scene.exr", tmp_path / "line.exr"]
    path.write_text(json.dumps(scene(folder, camera)))
    assert cli.main(["render", str(path), "-o", str(outputs[0])]) == 0
    light = ["--light", "directional:0,-0.6,-0.8:1", "--no-correction", "--size", f"{SIDE}x{SIDE}"]
    assert cli.main(["render", str(folder / "balls.qgraph"), *options, *light, "-o", str(outputs[1])]) == 0
    pictures = [path.read_bytes() for path in outputs]
    assert pictures[0][-4000:] == pictures[1][-4000:]
    saved = quadgraph.SceneFile(path).at(0)
    for name, value in camera.items():
        assert np.array_equal(saved.camera[name], value)


@pytest.mark.parametrize(
    ("camera", "words"),
    [
        ({"eye": [1, 2, 3]}, "/camera: view: look_at is missing, eye and look_at go together"),
        ({"look_at": [1, 2, 3]}, "/camera: view: eye is missing"),
        ({"eye": [1, 2, 3], "look_at": [1, 2, 3]}, "eye and look_at are the same place"),
        ({"eye": [1, 2]}, "/camera/eye"),
        ({"orthographic": -1}, "/camera: view, orthographic: found -1"),
    ],
)
def test_a_camera_that_is_none_is_refused(folder, tmp_path, camera, words):
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(scene(folder, camera)))
    with pytest.raises(InputError, match=words):
        quadgraph.SceneFile(path)
