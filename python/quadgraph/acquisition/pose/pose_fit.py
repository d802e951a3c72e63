"""Where a body lies so that its outlines are those of masks, from a pose nearby: Gauss-Newton with weights."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from quadgraph.acquisition.cameras.lens import Pose, project
from quadgraph.acquisition.pose.outline import OutlinedBody, Silhouette

_DIFFERENCE = 1e-4  # mm, for the slopes of a projection
_LEAST_SCALE = 0.5  # pixels, from which on a distance counts less than its square
_CLOSE = 1e-3  # pixels, below which a step ends the search
_DAMPING = 1e-4  # of the mean of the normal matrix's diagonal: what no outline tells stays as it was
_FARTHEST = 0.3  # of the body's radius, that a step goes


@dataclass(frozen=True, eq=False)
class BodyPose:
    """Where a body is: a place p of its mesh is at rotation p + translation, mm.

    rotation: (3, 3); translation: (3,).
    """

    rotation: np.ndarray
    translation: np.ndarray

    def camera(self, pose: Pose) -> Pose:
        """A camera's pose as the mesh's own coordinates have it."""
        return Pose(pose.rotation @ self.rotation, pose.rotation @ self.translation + pose.translation)

    def places(self, places: np.ndarray) -> np.ndarray:
        """(n, 3) where places of the mesh are."""
        return places @ self.rotation.T + self.translation

    def stepped(self, step: np.ndarray, middle: np.ndarray) -> BodyPose:
        """Turned about a place by step[:3], radians about the board's axes, and moved by step[3:], mm."""
        turn = Rotation.from_rotvec(step[:3]).as_matrix()
        return BodyPose(turn @ self.rotation, turn @ (self.translation - middle) + middle + step[3:])


@dataclass(frozen=True, eq=False)
class PoseFit:
    """off: RMS distance of the outlines from the masks' edges, pixels, weighed; cost: the mean of its square over that
    of half a pixel where it is small, of its logarithm where it is not; normal: (6, 6), the normal matrix of
    unit steps as `BodyPose.stepped` has them, turns times the body's radius, so that all are of pixels a mm.
    """

    pose: BodyPose
    off: float
    cost: float
    normal: np.ndarray


@dataclass(frozen=True, eq=False)
class MaskRays:
    """Rays from an eye, (3,), all over a mask and around: ways (n, 3), and which the mask keeps, (n,)."""

    eye: np.ndarray
    ways: np.ndarray
    kept: np.ndarray


def mask_rays(silhouettes: Sequence[Silhouette], side: int) -> list[MaskRays]:
    """side x side rays for each mask."""
    return [MaskRays(each.pose.eye, *each.grid(side)) for each in silhouettes]


def shared(body: OutlinedBody, views: Sequence[MaskRays], pose: BodyPose) -> float:
    """Of masks and body as it is seen, intersection over union."""
    both = either = 0
    for each in views:
        ways = each.ways @ pose.rotation
        eye = (each.eye - pose.translation) @ pose.rotation
        met = body.surface.hit(np.broadcast_to(eye, ways.shape), ways)[0] >= 0
        both += int((each.kept & met).sum())
        either += int((each.kept | met).sum())
    return both / max(either, 1)


def fit(
    body: OutlinedBody,
    silhouettes: Sequence[Silhouette],
    start: BodyPose,
    most: int,
    steps: int,
    reach: float = 0.0,
) -> PoseFit:
    """The pose nearest to `start`, by at most `most` places of each outline and so many steps.

    reach: pixels, up to which at first a distance counts with its square; it falls to half a pixel. Outlines that a
    camera does not see, for the body is behind it, count nothing.
    """
    pose, normal = start, np.zeros((6, 6))
    scale, off, cost, radius = max(reach, _LEAST_SCALE), np.inf, np.inf, body.surface.radius
    for _ in range(steps):
        distances, rows, middle = _rows(body, silhouettes, pose, most)
        if len(distances) < 6 or not rows.any():
            return PoseFit(pose, np.inf, np.inf, normal)
        weights = 1 / (1 + (distances / scale) ** 2)
        off = float(np.sqrt((weights * distances**2).sum() / weights.sum()))
        cost = float(np.log1p((distances / _LEAST_SCALE) ** 2).mean())
        normal = (rows * weights[:, None]).T @ rows
        damped = normal + _DAMPING * np.trace(normal) / 6 * np.eye(6)
        step = -np.linalg.solve(damped, rows.T @ (weights * distances))
        moved = float(np.sqrt(((rows @ step) ** 2).mean()))
        step *= min(1.0, _FARTHEST * radius / max(float(np.abs(step).max()), 1e-12))
        step[:3] /= radius
        pose = pose.stepped(step, middle)
        spread = 2 * float(np.median(np.abs(distances)))
        scale = max(min(scale, max(0.7 * scale, spread)), _LEAST_SCALE)
        if moved < _CLOSE:
            break
    return PoseFit(pose, off, cost, normal)


def _rows(
    body: OutlinedBody, silhouettes: Sequence[Silhouette], pose: BodyPose, most: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Distances (n,) of outlines from the masks' edges, how each changes with a step (n, 6), turns times the radius,
    and the middle that steps turn about.
    """
    middle = pose.places(body.surface.middle[None])[0]
    found, rows = [np.empty(0)], [np.empty((0, 6))]
    for each in silhouettes:
        places = pose.places(body.outline(each.lens, pose.camera(each.pose), most))
        if not len(places):
            continue
        shown = project(each.lens, each.pose, places)
        distances, slopes, within = each.distances(shown)
        moves = [project(each.lens, each.pose, places + way) - shown for way in _DIFFERENCE * np.eye(3)]
        moved = np.stack([(move * slopes).sum(axis=1) / _DIFFERENCE for move in moves], axis=1)
        turned = np.cross(places - middle, moved) / body.surface.radius
        found.append(distances[within])
        rows.append(np.concatenate([turned, moved], axis=1)[within])
    return np.concatenate(found), np.concatenate(rows), middle
