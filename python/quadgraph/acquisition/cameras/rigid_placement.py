"""How a body, or another program's world, is laid on the board: scaled, turned about an axis and moved."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Placement:
    """A place p becomes scale * rotation p + translation, mm."""

    scale: float
    axis: tuple[float, float, float]
    degrees: float
    translation: np.ndarray

    @property
    def rotation(self) -> np.ndarray:
        """(3, 3), by Rodrigues' formula."""
        x, y, z = np.array(self.axis) / np.linalg.norm(self.axis)
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        angle = math.radians(self.degrees)
        return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
