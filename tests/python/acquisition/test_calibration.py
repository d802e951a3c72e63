"""Lens and poses from twelve hand-held photographs of the board, with noise and a body that hides a part of it."""

from __future__ import annotations

import numpy as np
import pytest

import board_photographs
import board_session
from quadgraph.acquisition.board import calibration, corners
from quadgraph.acquisition.board.board import Board
from quadgraph.acquisition.board.corners import Corners
from quadgraph.acquisition.cameras.lens import Lens, project
from quadgraph.base.errors import InputError

pytest.importorskip("cv2", reason="OpenCV is not installed: pip install 'quadgraph[capture]'")

LENS, SIZE = board_photographs.LENS, (board_photographs.LENS.width, board_photographs.LENS.height)
POSES = board_session.cameras()
NOISE = (0.001, 1.5e-4)


@pytest.fixture(scope="module")
def found() -> dict[str, Corners]:
    """The corners in all photographs, by their numbers."""
    generator = np.random.default_rng(7)
    ball = board_photographs.ball(board_session.MIDDLE, board_session.RADIUS)
    result = {}
    for number, pose in enumerate(POSES):
        grey = board_photographs.photograph(Board(), LENS, pose, ball).mean(axis=2)
        grey += generator.normal(size=grey.shape) * np.sqrt(NOISE[0] ** 2 + NOISE[1] * grey)
        result[str(number)] = corners.find(Board(), grey)
    return result


def test_corners_are_found_to_hundredths_of_a_pixel(found):
    off = [
        each.places - project(LENS, pose, Board().corners()[each.numbers])
        for each, pose in zip(found.values(), POSES, strict=True)
    ]
    distance = np.linalg.norm(np.concatenate(off), axis=1)
    assert len(distance) > 12 * 28
    assert np.median(distance) < 0.01
    assert np.quantile(distance, 0.9) < 0.03
    assert np.linalg.norm(np.concatenate(off).mean(axis=0)) < 0.005  # no half pixel anywhere


def test_lens_and_poses_agree_with_those_that_the_photographs_have(found):
    lens, located = calibration.calibrate(Board(), found, SIZE)
    focal, middle = np.array([lens.fx, lens.fy]), np.array([lens.cx, lens.cy])
    np.testing.assert_allclose(focal, [LENS.fx, LENS.fy], rtol=5e-4)
    np.testing.assert_allclose(middle, [LENS.cx, LENS.cy], atol=0.5)
    for each, pose in zip(located.values(), POSES, strict=True):
        turn = each.pose.rotation @ pose.rotation.T
        assert np.degrees(np.arccos(min((np.trace(turn) - 1) / 2, 1))) < 0.05
        assert (
            np.linalg.norm(each.pose.eye - pose.eye) < 0.2
        )  # of 330: focal length and distance stand in for each other
        assert each.rms < 0.05


def test_poses_by_a_known_lens_are_nearer_still(found):
    for each, pose in zip(found.values(), POSES, strict=True):
        located = calibration.locate(Board(), LENS, each)
        assert np.linalg.norm(located.pose.eye - pose.eye) < 0.05


def test_a_corner_that_is_far_off_is_left_out(found):
    wrong = found["3"].places.copy()
    wrong[5] += [2.0, -1.0]
    located = calibration.locate(Board(), LENS, Corners(found["3"].numbers, wrong))
    assert located.left_out >= 1
    assert found["3"].numbers[5] not in located.corners.numbers
    assert np.linalg.norm(located.pose.eye - POSES[3].eye) < 0.1


def test_a_ruler_that_measures_less_brings_everything_nearer(found):
    shrunk = Board(printed=(147.0, 147.0))
    there = calibration.locate(Board(), LENS, found["0"]).pose.eye
    here = calibration.locate(shrunk, LENS, found["0"]).pose.eye
    np.testing.assert_allclose(here, 0.98 * there, rtol=1e-6)


def test_photographs_that_tell_no_lens_are_refused(found):
    with pytest.raises(InputError, match="3 photographs show the board, allowed are 4 or more"):
        calibration.calibrate(Board(), {name: found[name] for name in ("0", "1", "2")}, SIZE)
    one_way = {}
    for number in range(5):
        pose = board_photographs.pose_from([87 + number, 112, 400 + 9 * number], [87, 113, 0])
        places = project(Lens(960, 720, 1000, 1000, 480, 360), pose, Board().corners())
        one_way[str(number)] = Corners(np.arange(len(places)), places)
    with pytest.raises(InputError, match=r"look the same way, to 0\.\d degrees"):
        calibration.calibrate(Board(), one_way, SIZE)
