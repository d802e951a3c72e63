"""Photographs of the board under light that differs from place to place: a near lamp's, or what a projector shows."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np

import board_photographs
from quadgraph.acquisition.board.board import Board
from quadgraph.acquisition.cameras.lens import Lens, Pose
from quadgraph.acquisition.capture.radiance import Radiance

# Irradiance of places on the board, (n, 2) mm: (n,) or (n, 3).
Light = Callable[[np.ndarray], np.ndarray]
FULL = 0.8  # of full scale, that the brightest paper has
PAPER = board_photographs.PAPER  # reflectance of the white squares


def lamp_light(position: Any, power: Any, aim: Any = None) -> Light:
    """The irradiance of an isotropic point light, W/mm^2, of powers (3,) in W; or of a Lambertian one that aims."""
    x, y, high = np.array(position, float)

    def of(places: np.ndarray) -> np.ndarray:
        right, up = x - places[:, 0], y - places[:, 1]
        distance = np.sqrt(right * right + up * up + high * high)
        lit = max(high, 0.0) / (4 * np.pi) / (distance * distance * distance)
        if aim is not None:
            axis = (aim - np.array(position, float)) / np.linalg.norm(aim - np.array(position, float))
            lit = 4 * lit * np.maximum(-(right * axis[0] + up * axis[1] + high * axis[2]) / distance, 0)
        return lit[:, None] @ np.array(power, float)[None]  # NumPy goes by three products at a time slowly

    return of


@cache
def _rays(lens: Lens, samples: int) -> np.ndarray:
    """(h s w s, 3) ways of rays, of length 1 along the axis."""
    steps = [(np.arange(side * samples) + 0.5) / samples for side in (lens.width, lens.height)]
    slopes = lens.slopes(np.stack(np.meshgrid(*steps), axis=-1).reshape(-1, 2))
    return np.concatenate([slopes, np.ones((len(slopes), 1))], axis=1)


def at_board(lens: Lens, pose: Pose, samples: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Places (h s, w s, 2), mm, where rays meet the board's plane, and which of them do."""
    high, wide = lens.height * samples, lens.width * samples
    ways = _rays(lens, samples) @ pose.rotation
    met = ways[:, 2] < -1e-3
    reach = np.where(met, -pose.eye[2] / np.where(met, ways[:, 2], -1), 0)
    return (pose.eye[:2] + reach[:, None] * ways[:, :2]).reshape(high, wide, 2), met.reshape(high, wide)


def reflected(board: Board, lens: Lens, pose: Pose, light: Light, samples: int = 1) -> np.ndarray:
    """(h, w, 3) radiance of the board, Lambertian, in light that is the mean of samples x samples in each pixel."""
    places, met = at_board(lens, pose, samples)
    lit = light(places.reshape(-1, 2))
    lit = lit.reshape(*met.shape, 3 if lit.ndim == 2 else 1)
    lit[~met] = 0
    if samples > 1:
        lit = lit.reshape(lens.height, samples, lens.width, samples, -1).mean(axis=(1, 3))
    shown = board_photographs.photograph(board, lens, pose)
    shown *= lit
    shown /= np.pi
    return shown


def radiance_of(shown: np.ndarray, noise: tuple[float, float], generator: np.random.Generator) -> Radiance:
    """A photograph with noise, full scale 1, as merged exposures are."""
    variances = noise[0] ** 2 + noise[1] * np.maximum(shown, 0)
    values = generator.standard_normal(shown.shape)
    values *= np.sqrt(variances)
    values += shown
    return Radiance(values.astype(np.float32), variances.astype(np.float32), shown < 1)


@dataclass
class LampScene:
    """A lamp over the board and cameras around it, drawn by a seed.

    falls: of the lens, exp(-falls s^2); forwards: the lamp is a small Lambertian surface that looks at the middle.
    """

    seed: int
    photographs: int = 3
    far: tuple[float, float] = (200.0, 450.0)
    falls: float = 0.0
    gloss: float = 0.0
    ambient: float = 0.0
    forwards: bool = False
    board: Board = field(default_factory=Board)

    def __post_init__(self) -> None:
        """Draw the lamp's place and power, and the cameras."""
        self.generator = np.random.default_rng(self.seed)
        self.middle = np.array([*(self.board.size / 2), 0.0])
        turn, high = self.generator.uniform(0, 2 * np.pi), np.radians(self.generator.uniform(30, 75))
        way = np.array([np.cos(high) * np.cos(turn), np.cos(high) * np.sin(turn), np.sin(high)])
        self.position = self.middle + self.generator.uniform(*self.far) * way
        self.power = np.array([1.0, 0.9, 0.7]) * self.generator.uniform(500, 5000)
        start = self.generator.uniform(0, 360)
        elevation = self.generator.uniform(45, 65)
        self.poses = board_photographs.around(self.middle, 330.0, 12, elevation, start)[:: 12 // self.photographs]
        self.poses = self.poses[: self.photographs]

    def shown(self, pose: Pose, lens: Lens = board_photographs.LENS) -> np.ndarray:
        """(h, w, 3) radiance of a photograph, W/(mm^2 sr)."""
        light = lamp_light(self.position, self.power, self.middle if self.forwards else None)
        shown = reflected(self.board, lens, pose, lambda places: light(places) + self.ambient * self.power)
        if self.gloss:
            places, _ = at_board(lens, pose)
            flat = np.concatenate([places, np.zeros((*places.shape[:2], 1))], axis=2)
            away = (self.position - flat, pose.eye - flat)
            mean = sum(each / np.linalg.norm(each, axis=2, keepdims=True) for each in away)
            cosine = mean[..., 2] / np.linalg.norm(mean, axis=2)
            shown = shown * (1 + self.gloss * cosine**200)[..., None]
        if not self.falls:
            return shown
        slopes2 = (board_photographs.middles(lens)[..., :2] ** 2).sum(axis=2)
        return shown * np.exp(-self.falls * slopes2)[..., None]

    def photographed(self, noise: tuple[float, float]) -> tuple[list[Radiance], float]:
        """All photographs with noise, and the gain by which radiance is a value."""
        shown = [self.shown(pose) for pose in self.poses]
        gain = FULL / max(float(each.max()) for each in shown)
        return [radiance_of(each * gain, noise, self.generator) for each in shown], gain


def errors(found: Sequence[float], true: Sequence[float]) -> float:
    """How far two places are apart, mm."""
    return float(np.linalg.norm(np.asarray(found) - np.asarray(true)))


def shaded(light: Light, lamp: Any, middle: Any, radius: float, left: float = 0.02, thrown: float = 0.2) -> Light:
    """A light before which a ball stands: in its shadow a share is left; beside it the board gets some of its light."""
    lamp, middle = np.array(lamp, float), np.array(middle, float)

    def of(places: np.ndarray) -> np.ndarray:
        flat = np.concatenate([places, np.zeros((len(places), 1))], axis=1)
        ways = lamp - flat
        ways /= np.linalg.norm(ways, axis=1, keepdims=True)
        towards = middle - flat
        along = (towards * ways).sum(axis=1)
        beside = np.sqrt(np.maximum((towards**2).sum(axis=1) - along**2, 0))
        free = np.clip((beside - radius) / 1.5 + 0.5, left, 1)  # a penumbra of 1.5 mm
        near = np.exp(-np.maximum(np.linalg.norm(places - middle[:2], axis=1) - 0.6 * radius, 0) / 12)
        return light(places) * (free[:, None] + thrown * near[:, None] * np.array([1, 0.8, 0.5]))

    return of


class BackgroundScene:
    """A ball on the board under a lamp, and the board without it, drawn by a seed; values of full scale 1."""

    def __init__(self, seed: int) -> None:
        """Draw ball, lamp and camera."""
        self.lamp = LampScene(seed, photographs=1)
        draw = self.lamp.generator.uniform
        self.radius = float(draw(15, 28))
        self.middle = self.lamp.middle + np.array([draw(-20, 20), draw(-20, 20), self.radius])
        self.pose = self.lamp.poses[0]
        light = lamp_light(self.lamp.position, self.lamp.power)
        bare = reflected(Board(), board_photographs.LENS, self.pose, light)
        self.gain = FULL / float(bare.max())
        self.empty = bare * self.gain
        dark = shaded(light, self.lamp.position, self.middle, self.radius)
        self.shown = reflected(Board(), board_photographs.LENS, self.pose, dark) * self.gain
        ways = board_photographs.middles(board_photographs.LENS) @ self.pose.rotation
        ways = (ways / np.linalg.norm(ways, axis=2, keepdims=True)).reshape(-1, 3)
        eyes = np.broadcast_to(self.pose.eye, ways.shape)
        met, radiance = board_photographs.ball(self.middle, self.radius)(eyes, ways)
        self.shown.reshape(-1, 3)[met] = radiance[met] * draw(0.3, 0.8)
        self.body = met.reshape(self.shown.shape[:2])

    def pictures(self, noise: tuple[float, float]) -> tuple[Radiance, Radiance]:
        """The photograph and the background with noise."""
        return tuple(radiance_of(each, noise, self.lamp.generator) for each in (self.shown, self.empty))
