"""Lenses with distortion, poses, and the cameras of scene files.

Places in a photograph are pixels right and down from its upper left corner, so that the middle of the first pixel is at
(0.5, 0.5). A camera's axes are right, down and forwards.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

_NEWTON_STEPS, _CLOSE = 50, 1e-13
_AT_ONCE = 1 << 14  # places, few enough for what is made of them on the way to stay in a core's cache


@dataclass(frozen=True)
class Lens:
    """A photograph's size in pixels, focal lengths and principal point in pixels, and the distortion of slopes (x, y):

    x' = x f + 2 p1 x y + p2 (r2 + 2 x x), y' = y f + p1 (r2 + 2 y y) + 2 p2 x y, with r2 = x x + y y and
    f = (1 + k1 r2 + k2 r2^2 + k3 r2^3) / (1 + k4 r2 + k5 r2^2 + k6 r2^3), as OpenCV and COLMAP have it. radial: k1 to
    k6; tangential: p1, p2.
    """

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    radial: tuple[float, float, float, float, float, float] = (0.0,) * 6
    tangential: tuple[float, float] = (0.0, 0.0)

    def distorted(self, slopes: np.ndarray) -> np.ndarray:
        """Slopes (n, 2) of rays, x and y over z, as the lens shows them."""
        x, y = slopes[:, 0], slopes[:, 1]
        p1, p2 = self.tangential
        r2 = x * x + y * y
        above, below = self._factor(r2)
        factor = above / below
        shown = np.empty((len(x), 2))
        shown[:, 0] = x * factor + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
        shown[:, 1] = y * factor + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
        return shown

    def places(self, slopes: np.ndarray) -> np.ndarray:
        """Where rays of slopes (n, 2) meet the photograph, (n, 2)."""
        return self.distorted(slopes) * [self.fx, self.fy] + [self.cx, self.cy]

    def slopes(self, places: np.ndarray) -> np.ndarray:
        """Slopes (n, 2) of the rays to places in the photograph: `places` backwards, by Newton's method."""
        found = np.empty((len(places), 2))
        for first in range(0, len(places), _AT_ONCE):
            found[first : first + _AT_ONCE] = self._undistorted(places[first : first + _AT_ONCE])
        return found

    def _factor(self, r2: np.ndarray) -> tuple[np.ndarray, np.ndarray | float]:
        """What of f is above the line, and what below."""
        k1, k2, k3, k4, k5, k6 = self.radial
        above = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
        return above, 1 + r2 * (k4 + r2 * (k5 + r2 * k6)) if k4 or k5 or k6 else 1.0

    def _undistorted(self, places: np.ndarray) -> np.ndarray:
        k1, k2, k3, k4, k5, k6 = self.radial
        p1, p2 = self.tangential
        wanted = np.stack([(places[:, 0] - self.cx) / self.fx, (places[:, 1] - self.cy) / self.fy], axis=1)
        found = wanted.copy()
        for _ in range(_NEWTON_STEPS):
            off = self.distorted(found) - wanted
            if not off.size or np.abs(off).max() < _CLOSE:
                break
            x, y = found[:, 0].copy(), found[:, 1].copy()
            r2 = x * x + y * y
            above, below = self._factor(r2)
            factor = above / below
            steeper = k1 + r2 * (2 * k2 + r2 * 3 * k3) - factor * (k4 + r2 * (2 * k5 + r2 * 3 * k6))
            steeper = 2 * steeper / below  # twice the derivative of f with respect to r2
            a = factor + steeper * x * x + 2 * p1 * y + 6 * p2 * x
            b = steeper * x * y + 2 * p1 * x + 2 * p2 * y  # of x' with respect to y, and of y' to x
            d = factor + steeper * y * y + 6 * p1 * y + 2 * p2 * x
            determinant = a * d - b * b
            found[:, 0] = x - (d * off[:, 0] - b * off[:, 1]) / determinant
            found[:, 1] = y - (a * off[:, 1] - b * off[:, 0]) / determinant
        return found

    def widest_slope(self) -> float:
        """The slope up to which the distortion grows with the slope, so that what a pixel shows is one ray; inf where
        it always does.
        """
        steps = np.linspace(0, 4, 4001)
        shown = self.distorted(np.stack([steps, np.zeros_like(steps)], 1))[:, 0] - 3 * self.tangential[1] * steps**2
        falling = np.flatnonzero(np.diff(shown) <= 0)
        return float(steps[falling[0]]) if falling.size else math.inf


@dataclass(frozen=True, eq=False)
class Pose:
    """Where a camera is: a place p, mm, has the coordinates rotation p + translation along the camera's axes.

    rotation: (3, 3), right-handed; translation: (3,), mm.
    """

    rotation: np.ndarray
    translation: np.ndarray

    @property
    def eye(self) -> np.ndarray:
        """(3,) where the camera stands, mm."""
        return -self.rotation.T @ self.translation

    def seen(self, places: np.ndarray) -> np.ndarray:
        """Places (n, 3), mm, along the camera's axes."""
        return places @ self.rotation.T + self.translation

    def moved(self, scale: float, rotation: np.ndarray, translation: np.ndarray) -> Pose:
        """The pose after the world was made `scale` times as large, turned and moved, its camera with it."""
        turned = self.rotation @ rotation.T
        return Pose(turned, scale * self.translation - turned @ translation)


def project(lens: Lens, pose: Pose, places: np.ndarray) -> np.ndarray:
    """Where a photograph shows places (n, 3), mm, before the camera: (n, 2)."""
    seen = pose.seen(places)
    return lens.places(seen[:, :2] / seen[:, 2:])


@dataclass(frozen=True, eq=False)
class PinholeView:
    """A camera as scene files have it: square pixels, the principal point in the middle, no distortion and no roll.

    eye, look_at: (3,), mm; fov: from the upper to the lower edge, degrees; up: "y" or "z".
    """

    eye: np.ndarray
    look_at: np.ndarray
    fov: float
    up: str
    width: int
    height: int

    def members(self) -> dict[str, Any]:
        """The camera as a capture has it."""
        places = {"eye": self.eye.tolist(), "look_at": self.look_at.tolist()}
        return {**places, "up": self.up, "fov": self.fov, "width": self.width, "height": self.height}

    def axes(self) -> np.ndarray:
        """(3, 3) rows: right, down and forwards, unit."""
        forwards = (self.look_at - self.eye) / np.linalg.norm(self.look_at - self.eye)
        right = np.cross(forwards, np.eye(3)["xyz".index(self.up)])
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(forwards, right), forwards])

    @property
    def pose(self) -> Pose:
        """Its pose."""
        return Pose(self.axes(), -self.axes() @ self.eye)

    @property
    def lens(self) -> Lens:
        """Its lens."""
        focal = self.height / 2 / math.tan(math.radians(self.fov) / 2)
        return Lens(self.width, self.height, focal, focal, self.width / 2, self.height / 2)


def view_towards(eye: np.ndarray, middle: np.ndarray, radius: float, size: int) -> PinholeView:
    """The square view from a place that a ball, mm, just fits; `up` is the axis that is further from the way it looks.

    radius: below the distance from the eye to the middle.
    """
    forwards = middle - eye
    distance = float(np.linalg.norm(forwards))
    up = "z" if abs(forwards[2]) <= abs(forwards[1]) else "y"
    return PinholeView(eye, middle, 2 * math.degrees(math.asin(radius / distance)), up, size, size)
