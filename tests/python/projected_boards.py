"""A projector that shows stripes on the board, tilted in several places, and the camera that photographs it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import board_photographs
import lit_boards
from quadgraph.acquisition.board.board import Board
from quadgraph.acquisition.cameras.lens import Lens, Pose, project
from quadgraph.acquisition.cameras.rigid_placement import Placement
from quadgraph.acquisition.lighting import stripes

SIZE, STRIPE = (640, 480), 4
LEAK, ROOM = 0.02, 0.05  # of white, that black lets through, and that the room adds


def shifted_pose(eye: np.ndarray, middle: np.ndarray, lens: Lens, roll: float) -> Pose:
    """The pose of a projector at a place, that shows the middle of its picture at another one."""
    pose = board_photographs.pose_from(eye, middle, roll)
    slope = lens.slopes(np.array([[lens.width / 2, lens.height / 2]]))[0]
    way = np.array([*slope, 1.0]) / np.linalg.norm([*slope, 1.0])
    axis = np.cross([0, 0, 1.0], way)
    degrees = float(np.degrees(np.arcsin(np.linalg.norm(axis))))
    turn = Placement(1.0, (axis[0], axis[1], axis[2]), degrees, np.zeros(3)).rotation
    rotation = turn @ pose.rotation
    return Pose(rotation, -rotation @ eye)


class ProjectorScene:
    """A projector, and a camera beside it, drawn by a seed; the board lies first, and is propped up in other places."""

    def __init__(self, seed: int, places: int = 3, tilt: float = 28.0) -> None:
        """tilt: degrees, by which the board is propped up in places after the first."""
        self.generator = np.random.default_rng(seed)
        draw = self.generator.uniform
        focal = draw(720, 820)
        shift = draw(0, 170)
        k1 = draw(-0.06, 0.06)
        place = 320 + draw(-8, 8), 240 + shift
        self.lens = Lens(*SIZE, focal, focal * draw(0.99, 1.01), *place, (k1, 0.0, 0.0, 0.0, 0.0, 0.0))
        self.board = Board()
        middle = np.array([*(self.board.size / 2), 0.0])
        turn, high = draw(0, 2 * np.pi), np.radians(draw(50, 70))
        way = np.array([np.cos(high) * np.cos(turn), np.cos(high) * np.sin(turn), np.sin(high)])
        self.pose = shifted_pose(middle + draw(430, 520) * way, middle, self.lens, draw(-10, 10))
        beside = turn + np.radians(draw(40, 80))
        way = np.array([np.cos(1.05) * np.cos(beside), np.cos(1.05) * np.sin(beside), np.sin(1.05)])
        self.camera = board_photographs.pose_from(middle + 340 * way, middle, draw(-10, 10))
        self.moves = [Placement(1.0, (0.0, 0.0, 1.0), 0.0, np.zeros(3))]
        for number in range(1, places):
            angle = turn + np.pi / 2 + 2.4 * number
            axis = (float(np.cos(angle)), float(np.sin(angle)), 0.0)
            move = Placement(1.0, axis, tilt, np.zeros(3))
            self.moves.append(Placement(1.0, axis, tilt, middle - move.rotation @ middle))

    def frames(self, place: int, noise: tuple[float, float], channels: int = 3) -> Iterator[np.ndarray]:
        """(h, w, channels) photographs with noise of all patterns on the board in a place, white 0.8 of full scale."""
        move = self.moves[place]
        camera, projector = (each.moved(1.0, move.rotation, move.translation) for each in (self.camera, self.pose))
        lens = board_photographs.LENS
        reflectance = board_photographs.photograph(self.board, lens, camera)[..., :channels]
        places, met = lit_boards.at_board(lens, camera, 2)
        flat = np.concatenate([places.reshape(-1, 2), np.zeros((met.size, 1))], axis=1)
        at = np.floor(project(self.lens, projector, flat)).astype(int)
        within = met.ravel() & (at >= 0).all(axis=1) & (at < SIZE).all(axis=1)
        # What lights each of four places in a pixel of the camera: a pixel of the projector, or the room alone.
        lights = np.where(within, at[:, 1] * SIZE[0] + at[:, 0], SIZE[0] * SIZE[1])
        lights = lights.reshape(lens.height, 2, lens.width, 2)
        four = [np.ascontiguousarray(lights[:, down, :, right], np.int32) for down in (0, 1) for right in (0, 1)]
        for pattern in stripes.patterns(SIZE, STRIPE):
            sent = np.append(np.where(pattern > 0, 1.0, LEAK), 0) + ROOM
            shown = reflectance * (sum(sent[each] for each in four) / 4)[..., None]
            off = self.generator.standard_normal(shown.shape)
            off *= np.sqrt(noise[0] ** 2 + noise[1] * shown)
            yield shown + off
