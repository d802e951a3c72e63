"""What a projector shows as the engine's projector would: no distortion, square pixels, its axis in the middle.

The engine's picture is larger than the projector's own where that is shifted, as that of most projectors is.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from quadgraph.acquisition.board.board import opencv
from quadgraph.acquisition.cameras.lens import Lens, Pose

MOST_SIDE = 4096  # pixels of the picture that is made
_SAMPLES = 2  # along a side of its pixels
_EDGE = 64  # places along a side of the frame, where it is looked how far the picture reaches


def light(lens: Lens, pose: Pose, shown: np.ndarray, power: Sequence[float]) -> tuple[np.ndarray, dict[str, Any]]:
    """The picture, (h, w, 3) linear, and the members of the light but its file.

    shown: (height, width, 3) linear, of the projector's size; power: W, of three channels, if it shows white all over.
    """
    along = np.linspace(0, 1, _EDGE) * np.array([[lens.width], [lens.height]])
    sides = [np.stack([along[0], np.full(_EDGE, y)], axis=1) for y in (0.0, lens.height)]
    sides += [np.stack([np.full(_EDGE, x), along[1]], axis=1) for x in (0.0, lens.width)]
    reach = np.abs(lens.slopes(np.concatenate(sides))).max(axis=0)
    focal = min((lens.fx + lens.fy) / 2, MOST_SIDE / 2 / float(reach.max()))
    half = np.ceil(reach * focal)
    width, height = (int(2 * each) for each in half)
    picture = _resampled(lens, shown, width, height, focal)
    whole = (width * height / focal**2) / (lens.width * lens.height / (lens.fx * lens.fy))
    members = {
        "type": "projector",
        "position": pose.eye.tolist(),
        "direction": pose.rotation[2].tolist(),
        "up": (-pose.rotation[1]).tolist(),
        "angle": float(2 * np.degrees(np.arctan(half[1] / focal))),
        "power": [float(each * whole) for each in power],
    }
    return picture, members


def _resampled(lens: Lens, shown: np.ndarray, width: int, height: int, focal: float) -> np.ndarray:
    cv2 = opencv()
    steps = [(np.arange(side * _SAMPLES) + 0.5) / _SAMPLES - side / 2 for side in (width, height)]
    picture = np.empty((height, width, 3), np.float32)
    for row in range(height):
        across, down = np.meshgrid(steps[0], steps[1][row * _SAMPLES : (row + 1) * _SAMPLES])
        slopes = np.stack([across.ravel(), down.ravel()], axis=1) / focal
        at = lens.places(slopes)
        at[np.linalg.norm(slopes, axis=1) >= lens.widest_slope()] = -9
        maps = [(at[:, axis] - 0.5).astype(np.float32).reshape(_SAMPLES, -1) for axis in (0, 1)]
        found = cv2.remap(shown, *maps, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=0)
        picture[row] = found.reshape(_SAMPLES, width, _SAMPLES, 3).mean(axis=(0, 2))
    return picture


def spot(lens: Lens, pose: Pose) -> tuple[dict[str, Any], float]:
    """The widest spot that the projector can be: a cone about its axis, which it makes by a white disc about the
    principal point, and the disc's radius, pixels. Without members where the axis is outside the picture.
    """
    radius = min(lens.cx, lens.width - lens.cx, lens.cy, lens.height - lens.cy)
    if radius <= 0:
        return {}, 0.0
    angle = float(np.degrees(np.arctan(radius / max(lens.fx, lens.fy))))
    place = {"position": pose.eye.round(2).tolist(), "direction": pose.rotation[2].round(5).tolist()}
    return {"type": "spot", **place, "angle": round(angle, 2), "edge": 0}, radius
