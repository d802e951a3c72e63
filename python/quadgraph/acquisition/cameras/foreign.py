"""What the readers of other programs' cameras return, and how they refuse."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from quadgraph.acquisition.cameras.lens import Lens, Pose
from quadgraph.base import regular_file
from quadgraph.base.errors import InputError

MOST_IMAGES, MOST_LENSES = 100_000, 100_000
MOST_BYTES = 2 << 30  # of a file
LARGEST_SIDE = 65_535  # pixels


@dataclass(frozen=True, eq=False)
class ForeignCameras:
    """Lenses and poses by the names of photographs, in the order of the file; without poses the lens is that of all.

    source: what they were read from; poses: in the file's own world, whose unit nobody knows.
    """

    source: Path
    lenses: dict[str, Lens]
    poses: dict[str, Pose]
    lens: Lens | None = None


def content(path: Path) -> bytes:
    """The bytes of a file. Raises InputError naming it."""
    try:
        size = path.stat().st_size
        if size > MOST_BYTES:
            raise InputError(f"{path}: {size} bytes found, allowed are {MOST_BYTES}")
        return regular_file.read_bytes(path)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from error


def checked_lens(where: str, size: tuple[float, float], numbers: list[float]) -> Lens:
    """A lens of fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, k5, k6 (as many as there are). Raises InputError."""
    if not all(float(each).is_integer() and 1 <= each <= LARGEST_SIDE for each in size):
        raise InputError(f"{where}: size {size[0]:g} x {size[1]:g} found, allowed are 1 to {LARGEST_SIDE} pixels")
    if not all(math.isfinite(each) and abs(each) < 1e9 for each in numbers):
        raise InputError(f"{where}: a number that is not finite or above 1e9 found in the lens, export it again")
    fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, k5, k6 = numbers + [0.0] * (12 - len(numbers))
    if fx <= 0 or fy <= 0:
        raise InputError(f"{where}: focal lengths {fx:g}, {fy:g} found, allowed are numbers above 0 (pixels)")
    return Lens(int(size[0]), int(size[1]), fx, fy, cx, cy, (k1, k2, k3, k4, k5, k6), (p1, p2))


def checked_pose(where: str, rotation: np.ndarray, translation: np.ndarray) -> Pose:
    """A pose of a right-handed rotation. Raises InputError for any other matrix."""
    finite = bool(np.isfinite(rotation).all() and np.isfinite(translation).all())
    if not finite or np.abs(rotation @ rotation.T - np.eye(3)).max() > 1e-3 or np.linalg.det(rotation) < 0:
        raise InputError(f"{where}: found no right-handed rotation, allowed is one; export the cameras again")
    left, _, right = np.linalg.svd(rotation)
    return Pose(left @ right, np.asarray(translation, float))
