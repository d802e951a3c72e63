"""Outlines: of a body as a camera sees it, and of what a mask keeps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from quadgraph.acquisition.cameras.lens import Lens, Pose, project
from quadgraph.acquisition.cameras.placed_body import PlacedBody

_AROUND = 0.5  # of a mask's extent, by which the part that is looked at is larger
_STEP = 1.5  # pixels between places of an outline
_BESIDE = 0.75  # pixels beside an outline, where nothing of the body may lie
_NEAREST = 1e-9  # of z, mm
_SMOOTH = 1.5  # pixels, over which distances are smoothed: of steps of pixels the slopes are wrong
_SMALL = 0.02  # of what a mask keeps, up to which a hole in it is a highlight that was left out, none of the body


@dataclass(frozen=True, eq=False)
class Silhouette:
    """What a mask keeps of a photograph, as distances from its edge.

    path: of the photograph; corner: (2,) pixels, of the part that is looked at; beside: (h, w), the distance of each
    pixel's middle from the edge, pixels, negative within; middle: (2,), of what is kept; whole: whether it ends before
    the photograph does.
    """

    path: str
    lens: Lens
    pose: Pose
    corner: np.ndarray
    beside: np.ndarray
    middle: np.ndarray
    whole: bool

    def distances(self, places: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of places (n, 2) of the photograph: distances from the edge (n,), their slopes (n, 2), and whether a place
        lies within the photograph's middle, where its edge hides nothing.
        """
        height, width = self.beside.shape
        at = np.clip(places - self.corner - 0.5, 0, [width - 1.001, height - 1.001])
        low = at.astype(np.int64)
        share = at - low
        x, y = low.T
        upper = self.beside[y, x] * (1 - share[:, 0]) + self.beside[y, x + 1] * share[:, 0]
        lower = self.beside[y + 1, x] * (1 - share[:, 0]) + self.beside[y + 1, x + 1] * share[:, 0]
        left = self.beside[y, x] * (1 - share[:, 1]) + self.beside[y + 1, x] * share[:, 1]
        right = self.beside[y, x + 1] * (1 - share[:, 1]) + self.beside[y + 1, x + 1] * share[:, 1]
        outside = places - self.corner - 0.5 - at
        found = upper * (1 - share[:, 1]) + lower * share[:, 1] + np.linalg.norm(outside, axis=1)
        slopes = np.stack([right - left, lower - upper], axis=1)
        within = ((places > 1) & (places < [self.lens.width - 1, self.lens.height - 1])).all(axis=1)
        return found, slopes, np.asarray(within)

    def grid(self, side: int) -> tuple[np.ndarray, np.ndarray]:
        """Rays to side x side places spread evenly over the part that is looked at: their ways, and which are kept."""
        height, width = self.beside.shape
        steps = (np.arange(side) + 0.5) / side
        places = np.stack(np.meshgrid(steps * width, steps * height), axis=-1).reshape(-1, 2) + self.corner
        return self.rays(places), self.distances(places)[0] < 0

    def rays(self, places: np.ndarray) -> np.ndarray:
        """(n, 3) ways of the rays through places of the photograph."""
        slopes = self.lens.slopes(places)
        return np.asarray(np.concatenate([slopes, np.ones((len(slopes), 1))], axis=1) @ self.pose.rotation)


def silhouette(path: str, kept: np.ndarray, lens: Lens, pose: Pose) -> Silhouette | None:
    """Of the largest piece of a mask (h, w), its small holes filled; None where it keeps nothing."""
    labels, count = ndimage.label(kept)
    if not count:
        return None
    sizes = np.bincount(labels.ravel())
    sizes[0] = 0
    filled = _without_small_holes(labels == sizes.argmax())
    rows, columns = (np.flatnonzero(filled.any(axis=axis)) for axis in (1, 0))
    low = np.array([columns[0], rows[0]])
    high = np.array([columns[-1], rows[-1]]) + 1
    size = np.array([lens.width, lens.height])
    whole = bool((low > 0).all() and (high < size).all())
    around = np.ceil(_AROUND * (high - low)).astype(int) + 2
    first, last = np.maximum(low - around, 0), np.minimum(high + around, size)
    part = filled[first[1] : last[1], first[0] : last[0]]
    outside, inside = (ndimage.distance_transform_edt(each) for each in (~part, part))
    middle = np.argwhere(part).mean(axis=0)[::-1] + 0.5 + first
    beside = ndimage.gaussian_filter(np.where(part, 0.5 - inside, outside - 0.5).astype(np.float32), _SMOOTH)
    return Silhouette(path, lens, pose, first.astype(float), beside, middle, whole)


def _without_small_holes(part: np.ndarray) -> np.ndarray:
    holes, count = ndimage.label(~part)
    sizes = np.bincount(holes.ravel(), minlength=count + 1)
    small = sizes <= _SMALL * part.sum()
    small[0] = False
    return np.asarray(part | small[holes])


class OutlinedBody:
    """A body by its mesh whose outlines are looked for; poses of cameras are in the mesh's coordinates, mm."""

    def __init__(self, vertices: np.ndarray, triangles: np.ndarray) -> None:
        """Of vertices (n, 3), mm, and triangles (m, 3). Raises InputError if rays cannot be cast."""
        self.surface = PlacedBody(vertices, triangles)
        self._edges = _edges_of(triangles)
        self._heights = np.einsum("nx,nx->n", self.surface.normals, vertices[triangles[:, 0]])

    def outline(self, lens: Lens, pose: Pose, most: int) -> np.ndarray:
        """(n, 3) places, mm, at most `most` or so, along the outline as a camera sees it; none if it is not before it.

        It is where a triangle that faces the camera meets one that does not, and nothing of the body lies beside it.
        """
        facing = self.surface.normals @ pose.eye > self._heights
        first, second = self._edges[:, 2], self._edges[:, 3]
        turns = facing[first] != (facing[second] & (second >= 0))
        ends = self.surface.vertices[self._edges[turns][:, :2]]
        if not len(ends) or (pose.seen(ends.reshape(-1, 3))[:, 2] <= _NEAREST).any():
            return np.empty((0, 3))
        shown = project(lens, pose, ends.reshape(-1, 3)).reshape(-1, 2, 2)
        ways = shown[:, 1] - shown[:, 0]
        lengths = np.maximum(np.linalg.norm(ways, axis=1), 1e-12)
        sums = np.cumsum(lengths)
        count = int(min(np.ceil(sums[-1] / _STEP), 2 * most))
        along = (np.arange(count) + 0.5) * sums[-1] / count
        chosen = np.minimum(np.searchsorted(sums, along), len(sums) - 1)
        share = ((along - sums[chosen]) / lengths[chosen] + 1)[:, None]
        places = (1 - share) * ends[chosen, 0] + share * ends[chosen, 1]
        across = np.stack([-ways[chosen, 1], ways[chosen, 0]], axis=1) / lengths[chosen][:, None]
        return places[self._free(lens, pose, places, across)]

    def _free(self, lens: Lens, pose: Pose, places: np.ndarray, across: np.ndarray) -> np.ndarray:
        """(n,) whether a ray on one side of a place of an outline meets the body, and one on the other does not.

        across: (n, 2) unit, in the photograph.
        """
        seen = pose.seen(places)
        beside = np.zeros_like(seen)
        beside[:, :2] = _BESIDE * across * seen[:, 2:] / [lens.fx, lens.fy]
        ways = np.concatenate([seen + beside, seen - beside]) @ pose.rotation
        met = self.surface.hit(np.broadcast_to(pose.eye, ways.shape), ways)[0] >= 0
        return np.asarray(met[: len(places)] != met[len(places) :])


def _edges_of(triangles: np.ndarray) -> np.ndarray:
    """(e, 4) edges of triangles (m, 3): two vertices, and the two triangles that they bound, -1 where there is one."""
    count = len(triangles)
    ends = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    ends = np.sort(ends, axis=1)
    owners = np.tile(np.arange(count), 3)
    order = np.lexsort((owners, ends[:, 1], ends[:, 0]))
    ends, owners = ends[order], owners[order]
    begins = np.flatnonzero(np.concatenate([[True], (ends[1:] != ends[:-1]).any(axis=1)]))
    second = np.minimum(begins + 1, len(ends) - 1)
    paired = (ends[second] == ends[begins]).all(axis=1) & (second > begins)
    return np.column_stack([ends[begins], owners[begins], np.where(paired, owners[second], -1)])
