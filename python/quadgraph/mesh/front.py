"""From which side a body is shown when nobody says so.

Files do not tell which side of a body is its front; +z by convention. Bodies that show little from there are shown from
where most of their relief is seen: how much the normals of what is visible turn from pixel to pixel. (Measures of what
is seen from a viewpoint, of which this is one: Polonsky, Patane, Biasotti, Gotsman, Spagnuolo, "What's in an image?
Towards the computation of the best view of an object", 2005.) Bodies with a plane of symmetry show about as much from
in front as from behind. What is high on most of them is a head, so that of two such views the one that has it nearer is
taken.
"""

from __future__ import annotations

import math

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph.mesh import display_map
from quadgraph.mesh.surface import Surface

AZIMUTHS = tuple(range(0, 360, 45))  # degrees about y; 0 is seen from +z
ELEVATION = 10.0  # degrees, of pictures that nobody chose a view for
PLAINLY_MORE = 1.12  # relief that another view must show of the front's to be taken
NEARLY_AS_MUCH = 0.94  # of the most relief, that a view from the other side must show to be taken for it
HIGH = 0.2  # share of the surface that counts as its upper end
AWAY = 0.1  # radii by which that end is behind the middle of a body that is seen from behind
PIXELS = 96
POINTS = 200_000  # samples of the surface: some ten for each pixel it covers


def azimuth(surface: Surface) -> float:
    """Degrees about y from which to look: 0, unless another of AZIMUTHS shows plainly more relief."""
    points, normals = _placed(surface)
    seen = _reliefs(points, normals)
    best = int(np.argmax(seen))
    if seen[best] <= PLAINLY_MORE * seen[0]:
        return 0.0
    nearer = _upper_ends(points)
    if nearer[best] < -AWAY:
        others = (seen >= NEARLY_AS_MUCH * seen[best]) & (nearer > AWAY)
        best = int(np.argmax(np.where(others, seen, 0))) if others.any() else best
    return float(AZIMUTHS[best])


def check(degrees: float | None) -> None:
    """Raise InputError unless it is an azimuth, or None."""
    if degrees is not None and not -180 <= degrees <= 360:
        raise InputError(f"front: {degrees} found, allowed are -180 to 360 degrees")


def reliefs(surface: Surface) -> np.ndarray:
    """Sum of the differences between the normals of neighbouring pixels, by azimuth: (8,)."""
    return _reliefs(*_placed(surface))


def _upper_ends(points: np.ndarray) -> np.ndarray:
    """How much nearer the upper end of points within the unit sphere is than their middle, by azimuth: (8,)."""
    high = points[points[:, 1] >= np.quantile(points[:, 1], 1 - HIGH)]
    beside = high.mean(axis=0) - points.mean(axis=0)
    turn = np.radians(AZIMUTHS)
    return beside[0] * np.sin(turn) + beside[2] * np.cos(turn)


def _reliefs(points: np.ndarray, normals: np.ndarray) -> np.ndarray:
    if not len(points):
        return np.zeros(len(AZIMUTHS))
    x, y, z = np.ascontiguousarray(points.T)
    # By columns: threads of BLAS take ten times as long for a matrix of three columns.
    seen = (tuple(a * x + b * y + c * z for a, b, c in _axes(degrees)) for degrees in AZIMUTHS)
    return np.array([_relief(right, up, depth, normals) for right, up, depth in seen])


def _placed(surface: Surface) -> tuple[np.ndarray, np.ndarray]:
    """Samples of the surface, moved into the unit sphere about the middle of its box."""
    points, normals = _samples(surface)
    if len(points):
        points = points - 0.5 * (surface.vertices.min(axis=0) + surface.vertices.max(axis=0))
        points /= np.linalg.norm(points, axis=1).max()
    return points, normals


def _samples(surface: Surface) -> tuple[np.ndarray, np.ndarray]:
    """Points spread evenly over the surface, and its smooth normals there."""
    area = np.linalg.norm(surface.doubled_normals, axis=1)
    if not area.sum() > 0:
        return np.zeros((0, 3)), np.zeros((0, 3))
    random = np.random.default_rng(1)
    end = np.cumsum(area)
    chosen = np.searchsorted(end, (np.arange(POINTS) + random.random(POINTS)) / POINTS * end[-1], side="right")
    corners = surface.triangles[np.minimum(chosen, len(area) - 1)]
    u, v = np.sqrt(random.random(POINTS)), random.random(POINTS)
    weights = np.stack((1 - u, u * (1 - v), u * v))[:, :, None]
    points, normals = (
        sum((at_vertices[corners[:, k]] * weights[k] for k in range(3)), np.zeros(3))
        for at_vertices in (surface.vertices, display_map.vertex_normals(surface))
    )
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return points, normals / np.where(length > 0, length, 1)


def _axes(degrees: float) -> list[tuple[float, float, float]]:
    """Rows to the right, up and towards the eye."""
    a, e = math.radians(degrees), math.radians(ELEVATION)
    right = (math.cos(a), 0.0, -math.sin(a))
    up = (-math.sin(a) * math.sin(e), math.cos(e), -math.cos(a) * math.sin(e))
    backward = (math.sin(a) * math.cos(e), math.sin(e), math.cos(a) * math.cos(e))
    return [right, up, backward]


def _relief(right: np.ndarray, up: np.ndarray, depth: np.ndarray, normals: np.ndarray) -> float:
    """Points within the unit sphere, `depth` towards the eye, and their normals, as seen without perspective."""
    column, row = (np.clip(((along + 1) * (PIXELS / 2)).astype(int), 0, PIXELS - 1) for along in (right, up))
    pixel = column + PIXELS * row
    nearest = np.full(PIXELS * PIXELS, -np.inf)
    np.maximum.at(nearest, pixel, depth)
    seen = np.flatnonzero(depth == nearest[pixel])
    image = np.full((PIXELS, PIXELS, 3), np.nan)
    image.reshape(-1, 3)[pixel[seen]] = normals[seen]
    return float(sum(np.nansum(np.linalg.norm(np.diff(image, axis=axis), axis=2)) for axis in (0, 1)))
