"""Photographs of a body by random walks: the truth that acquisition is held against."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph.mesh.surface import Surface
from quadgraph_validation.truth import camera_walk_kernel, walk_kernel
from quadgraph_validation.truth.interruptible import interruptible
from quadgraph_validation.truth.walk_surface import walk_surface

_ROWS = 4  # of pixels, in one piece of work
KINDS = ("rectangle", "ambient")  # of lights that walks meet


@dataclass(frozen=True)
class Eye:
    """A perspective camera, y or z up: eye, look_at (3,) mm, vertical field of view in degrees, and pixels."""

    eye: np.ndarray
    look_at: np.ndarray
    fov: float
    up: str
    width: int
    height: int

    def ways(self, rows: range, rays: int, generator: np.random.Generator) -> np.ndarray:
        """(rows * width, rays, 3) unit ways through places of pixels drawn uniformly, row after row from the top."""
        forward = self.look_at - self.eye
        forward /= np.linalg.norm(forward)
        right = np.cross(forward, [0.0, 1.0, 0.0] if self.up == "y" else [0.0, 0.0, 1.0])
        right /= np.linalg.norm(right)
        upwards = np.cross(right, forward)
        half = np.tan(np.radians(self.fov) / 2)
        row, column = (each.ravel()[:, None] for each in np.mgrid[rows.start : rows.stop, : self.width])
        size = (row.shape[0], rays)
        x = (2 * (column + generator.random(size)) / self.width - 1) * half * self.width / self.height
        y = (1 - 2 * (row + generator.random(size)) / self.height) * half
        ways = forward + x[..., None] * right + y[..., None] * upwards
        return ways / np.linalg.norm(ways, axis=-1, keepdims=True)


@dataclass(frozen=True, eq=False)
class CameraPicture:
    """radiance (k, h, w) of each light alone, W/(mm^2 sr), scattered light; noise (k, h, w): its standard error."""

    radiance: np.ndarray
    noise: np.ndarray


class CameraWalker:
    """A body in its mesh, mm, and lights, ready to be seen in one channel after the other."""

    def __init__(self, surface: Surface, lights: Sequence[dict[str, Any]]) -> None:
        """lights: rectangles and ambient ones of a scene file. Raises InputError for other kinds."""
        for number, light in enumerate(lights):
            if light["type"] not in KINDS:
                raise InputError(
                    f"lights[{number}]: {light['type']} found, allowed with walks are {' and '.join(KINDS)}, which "
                    "they can meet; or take --by engine"
                )
        self._lights = lights
        self._tree, self._near = walk_surface(surface)

    def see(
        self,
        eye: Eye,
        channel: int,
        volume: walk_kernel.WalkVolume,
        eta: float,
        walks: int,
        seed: int,
        advance: Callable[[float], None],
        roughness: float = 0.0,
    ) -> CameraPicture:
        """What a camera sees in one channel; walks: of each pixel; the same seed gives the same picture.

        volume: coefficients of the channel; eta: index of refraction inside over outside; advance: is called with the
        share that is done; roughness: GGX alpha of the surface, 0 for a smooth one. KeyboardInterrupt passes through
        within a tenth of a second.
        """
        rays = max(int(np.sqrt(walks)), 2)
        samples = -(-walks // rays)
        lights = self._in_channel(channel)
        count = len(self._lights)
        shape = (count, eye.height, eye.width)
        if not volume.scattering.any():
            return CameraPicture(np.zeros(shape), np.zeros(shape))
        pieces = [range(row, min(row + _ROWS, eye.height)) for row in range(0, eye.height, _ROWS)]

        def work(number: int) -> tuple[np.ndarray, np.ndarray]:
            generator = np.random.default_rng([seed, channel, number])
            ways = np.ascontiguousarray(eye.ways(pieces[number], rays, generator))
            total, squares = np.zeros((2, len(ways), count))
            start = generator.integers(2**64, dtype=np.uint64)
            what = (self._tree, self._near, volume, eta, roughness, lights, eye.eye, ways)
            camera_walk_kernel.seen(*what, samples, start, total, squares)
            return total / rays, squares / rays

        done = []
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            try:
                for result in [pool.submit(work, number) for number in range(len(pieces))]:
                    done.append(interruptible(result.result))
                    advance(len(done) / len(pieces))
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                raise
        mean, square = (np.concatenate([piece[k] for piece in done]).T for k in range(2))
        noise = np.sqrt(np.maximum(square - mean**2, 0) / (rays - 1))
        return CameraPicture(mean.reshape(shape), noise.reshape(shape))

    def _in_channel(self, channel: int) -> camera_walk_kernel.WideLights:
        columns = [_parts(light, channel) for light in self._lights]
        return camera_walk_kernel.WideLights(*(np.array(each, np.float64) for each in zip(*columns, strict=True)))


def _parts(light: dict[str, Any], channel: int) -> tuple[Any, ...]:
    """Members of WideLights for one light; radiance as docs/lights.md has it."""
    if light["type"] == "ambient":
        nothing = (np.zeros(3), np.eye(3)[0], np.eye(3)[1], np.eye(3)[2], 0.0)
        return (*nothing, _of_channel(light["irradiance"], channel) / np.pi)
    u, v = np.array(light["u"], float), np.array(light["v"], float)
    area = np.cross(u, v)
    size = float(np.linalg.norm(area))
    radiance = _of_channel(light["power"], channel) / (np.pi * size)
    return np.array(light["centre"], float), u / 2, v / 2, area / size, radiance, 0.0


def _of_channel(value: Any, channel: int) -> float:
    return float(np.broadcast_to(value, 3)[channel])
