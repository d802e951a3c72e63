"""Pixels gathered in squares, and the ray through the middle of each that leaves the body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import trimesh
from scipy import sparse

from quadgraph import core
from quadgraph.acquisition.model.prediction import Predictor
from quadgraph.acquisition.model.problem import Problem
from quadgraph.api.derivatives import Views

TILES = 4  # of a picture's side
_SLANTED = 0.1  # cosine between ray and normal, below which a square is left out
_FILLED = 0.5  # share of a square's pixels that has to count


@dataclass(frozen=True, eq=False)
class Squares:
    """The squares of one photograph. rays: which of its camera's views each has, (n,); tile: in which part of the
    picture, 0 to TILES^2 - 1, each lies; mean (3 of (n, pixels)): what makes of a channel's pixels the mean of those
    that count, 0 where too few do.
    """

    rays: np.ndarray
    tile: np.ndarray
    mean: tuple[sparse.csr_array, ...]

    def of(self, picture: np.ndarray) -> np.ndarray:
        """(n, 3) means of a picture (h, w, 3)."""
        return np.stack([mean @ picture[..., channel].ravel() for channel, mean in enumerate(self.mean)], axis=1)

    def variance(self, picture: np.ndarray) -> np.ndarray:
        """(n, 3) variances of means, from those of pixels (h, w, 3)."""
        squared = [mean.power(2) @ picture[..., channel].ravel() for channel, mean in enumerate(self.mean)]
        return np.stack(squared, axis=1)

    @property
    def counts(self) -> np.ndarray:
        """(n, 3) whether a square counts in a channel."""
        return np.stack([np.asarray(mean.sum(axis=1)).ravel() > 0 for mean in self.mean], axis=1)


@dataclass(frozen=True, eq=False)
class Samples:
    """All squares: side, pixels; views, by camera; squares, by photograph."""

    side: int
    views: dict[str, Views]
    squares: list[Squares]


def gather(problem: Problem, predictor: Predictor, level: core.Level, most: int) -> Samples:
    """Squares as small as can be while there are at most `most` of them in all photographs."""
    pixels = sum(int(counted.any(axis=2).sum()) for counted in problem.counted)
    side = max(1, int(np.ceil(np.sqrt(pixels / most))))
    vertices = np.array(level.vertices, np.float64)
    body = trimesh.Trimesh(vertices, np.array(level.faces), process=False)
    places: dict[str, np.ndarray] = {}
    views: dict[str, Views] = {}
    for name in dict.fromkeys(one.stated.camera for one in problem.measured):
        width, height = problem.capture.sizes[name]
        places[name], views[name] = _views(predictor, name, body, _middles(width, height, side))
    squares = [
        _squares(counted, side, places[one.stated.camera])
        for one, counted in zip(problem.measured, problem.counted, strict=True)
    ]
    return Samples(side, views, squares)


def _middles(width: int, height: int, side: int) -> np.ndarray:
    """(rows * columns, 2) the middles of all squares of a picture, pixels right and down."""
    x = np.arange(0, width, side)
    y = np.arange(0, height, side)
    across, down = (x + np.minimum(x + side, width)) / 2, (y + np.minimum(y + side, height)) / 2
    return np.stack(np.meshgrid(across, down), axis=-1).reshape(-1, 2)


def _views(predictor: Predictor, camera: str, body: trimesh.Trimesh, middles: np.ndarray) -> tuple[np.ndarray, Views]:
    """Numbers of the squares whose ray meets the body well, and those rays."""
    eyes, ways = predictor.rays(camera, middles)
    faces = body.ray.intersects_first(eyes, ways)
    met = np.flatnonzero(faces >= 0)
    met = met[-np.sum(body.face_normals[faces[met]] * ways[met], axis=1) > _SLANTED]
    face = faces[met]
    normals = body.face_normals[face]
    start = np.sum((body.triangles[face, 0] - eyes[met]) * normals, axis=1) / np.sum(ways[met] * normals, axis=1)
    hit = eyes[met] + start[:, None] * ways[met]
    corners = trimesh.triangles.points_to_barycentric(body.triangles[face], hit)
    corners = np.clip(corners, 0, 1)
    return met, Views(face, -ways[met], corners / corners.sum(axis=1, keepdims=True))


def _squares(counted: np.ndarray, side: int, places: np.ndarray) -> Squares:
    height, width = counted.shape[:2]
    columns = -(-width // side)
    y, x = np.divmod(np.arange(height * width), width)
    number = y // side * columns + x // side
    size = np.bincount(number)
    means = []
    for channel in range(3):
        pixel = np.flatnonzero(counted[..., channel].ravel())
        found = np.bincount(number[pixel], minlength=len(size))
        kept = found >= _FILLED * size
        pixel = pixel[kept[number[pixel]]]
        square = number[pixel]
        entries = 1.0 / found[square], (square, pixel)
        means.append(sparse.csr_array(entries, shape=(len(size), height * width))[places])
    whole = [np.asarray(mean.sum(axis=1)).ravel() > 0 for mean in means]
    used = np.flatnonzero(np.any(whole, axis=0))
    across, down = number_of_tile(places % columns, columns), number_of_tile(places // columns, -(-height // side))
    return Squares(used, (TILES * down + across)[used], tuple(mean[used] for mean in means))


def number_of_tile(place: np.ndarray, count: int) -> np.ndarray:
    """In which of TILES parts of a side each of its `count` places lies."""
    return place * TILES // count
