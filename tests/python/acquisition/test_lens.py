"""Lenses agree with OpenCV's, and views with the engine's own rays."""

from __future__ import annotations

import json

import numpy as np
import pytest

import board_photographs
import tiny
from quadgraph.acquisition.cameras.lens import Lens, project, view_towards

LENS = Lens(960, 720, 1012.0, 1008.0, 487.0, 353.0, (-0.12, 0.05, -0.01, 0.02, -0.01, 0.004), (0.0011, -0.0008))


def corners_of(lens: Lens) -> np.ndarray:
    """Places spread over the photograph, its corners among them."""
    across, down = np.meshgrid(np.linspace(0, lens.width, 9), np.linspace(0, lens.height, 7))
    return np.stack([across.ravel(), down.ravel()], axis=1)


def test_rays_of_places_come_back_to_them():
    places = corners_of(LENS)
    np.testing.assert_allclose(LENS.places(LENS.slopes(places)), places, atol=1e-9)


def test_places_are_those_of_opencv_half_a_pixel_on():
    cv2 = pytest.importorskip("cv2", reason="OpenCV is not installed: pip install 'quadgraph[capture]'")
    pose = board_photographs.pose_from([120, -260, 240], [80, 90, 0], 11)
    places = np.random.default_rng(1).uniform([0, 0, 0], [175, 225, 40], (50, 3))
    matrix = np.array([[LENS.fx, 0, LENS.cx - 0.5], [0, LENS.fy, LENS.cy - 0.5], [0, 0, 1]])
    k1, k2, *rest = LENS.radial
    turn, move = cv2.Rodrigues(pose.rotation)[0], pose.translation
    wanted, _ = cv2.projectPoints(places, turn, move, matrix, np.array([k1, k2, *LENS.tangential, *rest]))
    np.testing.assert_allclose(project(LENS, pose, places), wanted[:, 0] + 0.5, atol=1e-7)


def test_a_lens_says_from_where_on_two_rays_meet_one_place():
    folding = Lens(100, 100, 100, 100, 50, 50, (-0.5, 0, 0, 0, 0, 0))
    assert folding.widest_slope() == pytest.approx(np.sqrt(2 / 3), abs=2e-3)  # x - x^3 / 2 is greatest there
    assert Lens(100, 100, 100, 100, 50, 50).widest_slope() == np.inf


def test_a_world_that_is_scaled_turned_and_moved_looks_the_same():
    pose = board_photographs.pose_from([120, -260, 240], [80, 90, 0], 11)
    turn = board_photographs.pose_from([1, 2, 3], [0, 0, 0], 40).rotation
    places = np.random.default_rng(2).uniform(0, 100, (20, 3))
    move = np.array([5.0, -7, 11])
    moved = pose.moved(2.5, turn, move)
    np.testing.assert_allclose(
        project(LENS, moved, 2.5 * places @ turn.T + move), project(LENS, pose, places), atol=1e-9
    )
    np.testing.assert_allclose(moved.eye, 2.5 * turn @ pose.eye + move, atol=1e-9)


@pytest.mark.parametrize("eye", [[90, 60, 220], [-120, 3, 8], [5, 240, 3], [2, -3, 260.0]])
def test_views_see_along_the_rays_of_the_engine(eye):
    core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
    view = view_towards(np.array(eye, float), np.array([4.0, 2, -3]), 30.0, 50)
    stage = core.Stage("cpu")
    camera = {name: value for name, value in view.members().items() if name not in ("width", "height")}
    scene = {"body": str(tiny.PATH), "camera": camera, "picture": {"width": 50, "height": 50}}
    stage.show(core.scene_file(json.dumps(scene)).at(0))
    places = np.random.default_rng(3).uniform(0, 50, (40, 2))
    origins, ways = stage.view_rays(places)
    slopes = view.lens.slopes(places)
    mine = np.concatenate([slopes, np.ones((40, 1))], axis=1) @ view.axes()
    mine /= np.linalg.norm(mine, axis=1, keepdims=True)
    np.testing.assert_allclose(ways, mine, atol=2e-6)
    np.testing.assert_allclose(np.cross(view.eye - origins, ways), 0, atol=1e-3)
    # The ball that the view was made for just fits.
    edge = np.sqrt(np.sum((view.eye - view.look_at) ** 2))
    assert view.lens.fy * np.tan(np.arcsin(30 / edge)) == pytest.approx(25, rel=1e-9)
