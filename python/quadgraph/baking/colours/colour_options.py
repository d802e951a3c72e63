"""What a user may say of how the colours of a mesh become coefficients."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from quadgraph import core
from quadgraph.api.coefficients import MOST_CELLS
from quadgraph.api.values import RGB, numbers
from quadgraph.base.errors import InputError

LEAST_CELLS = 1000
_FADE_PATHS = 4.0  # mean free paths down to a base where nobody says how deep it lies


@dataclass(frozen=True)
class ColourOptions:
    """How colours become coefficients.

    mean_free_path: 1 / (sigma_s_prime + sigma_a), mm, one number or red, green, blue, of what states no medium of its
    own; base: the material below, a text as --material takes it but for volumes, None: the colours go on to the core;
    depth: where the base begins, mm, None for four mean free paths: the colour is the surface's down to half of that,
    and goes over smoothly from there; eta: refractive index, None for the file's, else the base's, else 1.3; spacing:
    of the cells, mm, None for as fine as the texture, but no finer than half an edge of the body's triangles; cells:
    at most so many. Raises InputError.
    """

    mean_free_path: RGB = 1.0
    base: str | None = None
    depth: float | None = None
    eta: float | None = None
    spacing: float | None = None
    cells: int = 1_000_000

    def __post_init__(self) -> None:
        """Check. Raises InputError."""
        paths = numbers("mean_free_path", self.mean_free_path, "one number or three above 0 (mm) are wanted")
        if paths.shape not in ((), (3,)) or not (np.isfinite(paths) & (paths > 1 / core.COEFFICIENT_MAX)).all():
            raise InputError(f"mean_free_path: {self.mean_free_path} found, one number or three above 1e-6 (mm) wanted")
        for name in ("depth", "spacing"):
            value = getattr(self, name)
            if value is not None and not 0 < value < np.inf:
                raise InputError(f"{name}: {value} found, a number above 0 (mm) is allowed")
        if self.eta is not None and not 1 <= self.eta <= 3:
            raise InputError(f"eta: {self.eta} found, 1 to 3 allowed")
        if not LEAST_CELLS <= self.cells <= MOST_CELLS:
            raise InputError(f"cells: {self.cells} found, {LEAST_CELLS:,} to {MOST_CELLS:,} allowed")
        if self.depth is not None and self.base is None:
            raise InputError("depth: found without a base; say which material lies below, or leave the depth out")
        if self.base is not None:
            if core.volume_name(self.base):
                raise InputError(f"base: the volume {self.base!r} found, allowed are names, coefficients and colours")
            core.Material(self.base)

    @property
    def paths(self) -> np.ndarray:
        """The mean free paths, (3,) mm."""
        return np.broadcast_to(np.asarray(self.mean_free_path, float), 3)

    @property
    def base_depth(self) -> float | None:
        """Where the base begins, mm; None without one."""
        if self.base is None:
            return None
        return self.depth if self.depth is not None else _FADE_PATHS * float(self.paths.max())
