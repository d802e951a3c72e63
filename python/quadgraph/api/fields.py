"""What a solve leaves behind, as arrays: on the surface, and in the body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from quadgraph.api.reprs import channels
from quadgraph.api.values import Floats


@dataclass(frozen=True, eq=False, repr=False)
class SurfaceField:
    """One sample per outside face of the finest level, float32, whatever the method.

    position: (n, 3) mm; normal: (n, 3), unit, outward; area: (n,) mm^2; q: (n, 3) W/mm^2, irradiance that the surface
    lets in; phi: (n, 3) W/mm^2, fluence below the surface; exitance: (n, 3) W/mm^2, of light that was scattered;
    unscattered: (n, 3) W/mm^2, of light that was not.
    """

    position: Floats
    normal: Floats
    area: Floats
    q: Floats
    phi: Floats
    exitance: Floats
    unscattered: Floats

    def __repr__(self) -> str:
        """Return number, area and mean exitance in one line."""
        mean = np.average(self.exitance, axis=0, weights=self.area)
        faces = f"{len(self.area):,} faces, {self.area.sum():.4g} mm^2"
        return f"SurfaceField({faces}, exitance {channels(mean, 'W/mm^2')} on average)"


@dataclass(frozen=True, eq=False, repr=False)
class WalkedExitance:
    """What random walks found to leave each outside face of the finest level, float32 (n, 3), W/mm^2.

    exitance: of light that was scattered, of a material that says its g of all; standard_error: of that.
    """

    exitance: Floats
    standard_error: Floats

    def __repr__(self) -> str:
        """Return the number of faces in one line."""
        return f"WalkedExitance({len(self.exitance):,} faces)"


@dataclass(frozen=True, eq=False, repr=False)
class Fluence:
    """Fluence of scattered light in the body, at the points where the method has its unknowns, float32.

    points: (n, 3) mm, of the shape as it is shown: vertices of the tets with fem and polygrids, nodes of the QuadGraph
    (one in every tet, then one at every outside face) with quadgraph-fv and quadgraph-fdm; values: (n, 3) W/mm^2.
    """

    points: Floats
    values: Floats

    def __repr__(self) -> str:
        """Return number and range in one line."""
        return f"Fluence({len(self.points):,} points, {self.values.min():.4g} to {self.values.max():.4g} W/mm^2)"
