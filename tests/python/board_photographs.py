"""Photographs of a board, and of a body on it, as a camera with a distorted lens would take them."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph.acquisition.board.board import Board
from quadgraph.acquisition.board.drawing import squares
from quadgraph.acquisition.cameras.lens import Lens, Pose

LENS = Lens(960, 720, 1012.0, 1008.0, 487.0, 353.0, (-0.12, 0.05, 0.0, 0.0, 0.0, 0.0), (0.0011, -0.0008))
PAPER, INK = 0.8, 0.04  # radiance of the board
FULL = 65535  # of a value of 16 bits
_DOTS = 16  # a mm
# What a body shows of rays, origins and unit ways (n, 3): which meet it, and the radiance that they find, (n, 3).
Body = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


def pose_from(eye: Any, look_at: Any, roll: float = 0.0) -> Pose:
    """A camera at a place that looks at another, turned by `roll` degrees from upright (z up)."""
    eye, look_at = np.array(eye, float), np.array(look_at, float)
    forwards = (look_at - eye) / np.linalg.norm(look_at - eye)
    right = np.cross(forwards, [0, 0, 1.0])
    right /= np.linalg.norm(right)
    down = np.cross(forwards, right)
    angle = np.radians(roll)
    rows = [np.cos(angle) * right + np.sin(angle) * down, np.cos(angle) * down - np.sin(angle) * right, forwards]
    return Pose(np.stack(rows), -np.stack(rows) @ eye)


def around(middle: Any, distance: float, count: int, elevation: float, start: float = 0.0) -> list[Pose]:
    """Cameras in a ring, hand-held: each looks a little beside, is turned a little, and stands a little elsewhere."""
    generator = np.random.default_rng(count)
    poses = []
    for number in range(count):
        azimuth = np.radians(start + 360 * number / count)
        high = np.radians(elevation + generator.uniform(-8, 8))
        way = [np.cos(high) * np.cos(azimuth), np.cos(high) * np.sin(azimuth), np.sin(high)]
        eye = np.array(middle) + distance * generator.uniform(0.92, 1.08) * np.array(way)
        poses.append(pose_from(eye, middle + generator.uniform(-6, 6, 3), generator.uniform(-15, 15)))
    return poses


@cache
def middles(lens: Lens) -> np.ndarray:
    """(h, w, 3) ways of the rays through the middles of the pixels, of length 1 along the axis."""
    across, down = np.meshgrid(np.arange(lens.width) + 0.5, np.arange(lens.height) + 0.5)
    slopes = lens.slopes(np.stack([across.ravel(), down.ravel()], axis=1)).reshape(lens.height, lens.width, 2)
    return np.concatenate([slopes, np.ones((lens.height, lens.width, 1))], axis=2)


@cache
def bitmap(board: Board) -> np.ndarray:
    """(h, w) reflectance of the board, its upper left corner first, with white paper of a square around it."""
    edge = board.square
    wide, high = (round(float(side + 2 * edge) * _DOTS) for side in board.size)
    found = np.full((high, wide), PAPER, np.float32)
    for x, y, w, h, black in squares(board):
        rows = slice(round((y + edge) * _DOTS), round((y + h + edge) * _DOTS))
        columns = slice(round((x + edge) * _DOTS), round((x + w + edge) * _DOTS))
        found[rows, columns] = INK if black else PAPER
    return found


def photograph(board: Board, lens: Lens, pose: Pose, body: Body | None = None, samples: int = 4) -> np.ndarray:
    """(h, w, 3) radiance, the mean of samples x samples rays in each pixel."""
    import cv2

    ways = middles(lens) @ pose.rotation
    reach = np.where(ways[..., 2] < -1e-3, -pose.eye[2] / np.minimum(ways[..., 2], -1e-3), 1e4)
    dots = (pose.eye[:2] + reach[..., None] * ways[..., :2] + board.square) * _DOTS
    dots[..., 1] = (board.size[1] + 2 * board.square) * _DOTS - dots[..., 1]
    fine = (lens.width * samples, lens.height * samples)
    # Where a ray meets the board changes all but evenly within a pixel, so that it is had between their middles.
    maps = (
        cv2.resize((dots[..., axis] - 0.5).astype(np.float32), fine, interpolation=cv2.INTER_LINEAR) for axis in (0, 1)
    )
    shown = cv2.remap(bitmap(board), *maps, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=0.25)
    grey = cv2.resize(shown, (lens.width, lens.height), interpolation=cv2.INTER_AREA)
    seen = np.repeat(grey[..., None].astype(float), 3, axis=2)
    if body is not None:
        unit = ways / np.linalg.norm(ways, axis=2, keepdims=True)
        met, radiance = body(np.broadcast_to(pose.eye, (unit.size // 3, 3)), unit.reshape(-1, 3))
        seen.reshape(-1, 3)[met] = radiance[met]
    return seen


def ball(middle: Any, radius: float) -> Body:
    """A ball whose radiance falls from one side to the other, in each channel another way."""
    centre = np.array(middle, float)

    def of(origins: np.ndarray, ways: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        towards = centre - origins
        along = (towards * ways).sum(axis=1)
        inside = radius**2 - ((towards**2).sum(axis=1) - along**2)
        met = (inside > 0) & (along > 0)
        normal = (origins + (along - np.sqrt(np.maximum(inside, 0)))[:, None] * ways - centre) / radius
        lit = np.clip(0.55 + 0.45 * normal @ np.array([0.6, -0.3, 0.74]), 0, None)
        return met, lit[:, None] ** [1.0, 1.6, 2.4] * [0.9, 0.6, 0.35]

    return of


def exposed(
    radiance: np.ndarray,
    exposure: float,
    noise: tuple[float, float],
    generator: np.random.Generator,
    black: float = 0.0,
) -> np.ndarray:
    """(h, w, 3) uint16 of one exposure: noise of variance read_out^2 + shot v, black level, 16 bits, clipped."""
    value = exposure * radiance
    off = generator.standard_normal(value.shape)
    off *= np.sqrt(noise[0] ** 2 + noise[1] * np.maximum(value, 0))
    value += off
    value += black
    np.clip(value, 0, 1, out=value)
    value *= FULL
    return np.round(value, out=value).astype(np.uint16)


def write_png(path: Path, picture: np.ndarray) -> None:
    """Write (h, w, 3) uint16, or (h, w) in grey."""
    import cv2

    as_it_is = [cv2.IMWRITE_PNG_COMPRESSION, 0]  # noise becomes no smaller, and takes longer to write and to read
    blue_first = np.ascontiguousarray(picture[..., ::-1]) if picture.ndim == 3 else picture
    assert cv2.imwrite(str(path), blue_first, as_it_is)
