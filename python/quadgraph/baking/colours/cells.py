"""The grid of a body's colours: how wide its cells are, where they lie, and what says that they are too coarse."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from quadgraph.baking.colours.placed_mesh import PlacedMesh
from quadgraph.base.errors import InputError
from quadgraph.mesh.looks.parts import Part

_PER_EDGE = 2  # cells along an edge of the body's surface, whose tets have one value each
_PER_FADE = 6  # cells from the surface to the base
AROUND = 2  # cells beyond the body's box: between cells of the last layer inside it is linear


@dataclass(frozen=True)
class ColourGrid:
    """counts: cells along x, y, z; spacing: mm; origin: of the first cell's middle, mm; detail: how wide the file's
    texels are, or its edges where colours are at vertices, mm, 0 where it has colours of parts alone.
    """

    counts: tuple[int, int, int]
    spacing: float
    origin: tuple[float, float, float]
    detail: float

    def points(self) -> np.ndarray:
        """Middles of the cells, (nz ny nx, 3) float32 mm, x fastest."""
        axes = [first + self.spacing * np.arange(count) for first, count in zip(self.origin, self.counts, strict=True)]
        z, y, x = np.meshgrid(axes[2], axes[1], axes[0], indexing="ij")
        return np.stack([x, y, z], axis=-1).astype(np.float32).reshape(-1, 3)


def grid_for(
    placed: PlacedMesh, low: np.ndarray, high: np.ndarray, spacing: float | None, most: int, depth: float | None
) -> ColourGrid:
    """A grid around a body's box, mm: of cells as wide as texels, but no finer than the body's tets can tell.

    spacing: mm, None for that; most: cells; depth: where the base begins, mm. Raises InputError where a spacing that
    was asked for makes more than `most`.
    """
    detail = min((found for part in range(len(placed.looks.parts)) if (found := _detail(placed, part))), default=0.0)
    extent = high - low
    if spacing is not None:
        count = math.prod((np.floor(extent / spacing) + 2 * AROUND + 1).tolist())
        if count > most:
            raise InputError(
                f"spacing: {spacing:g} mm makes {count:.4g} cells in the body, at most {most:,} are allowed; take "
                f"about {_widened(extent, spacing, most):.3g} mm, or allow more cells"
            )
        return _grid(low, extent, spacing, detail)
    width = max(detail, placed.edge / _PER_EDGE)
    if depth is not None:
        width = min(width, depth / _PER_FADE)
    return _grid(low, extent, _widened(extent, width, most), detail)


def _widened(extent: np.ndarray, width: float, most: int) -> float:
    """The least width from `width` on, in steps of a fiftieth, with which the cells are no more than `most`."""
    width = max(width, float(extent.max()) / most)
    while math.prod((np.floor(extent / width) + 2 * AROUND + 1).tolist()) > most:
        width *= 1.02
    return width


def _grid(low: np.ndarray, extent: np.ndarray, spacing: float, detail: float) -> ColourGrid:
    counts = np.floor(extent / spacing).astype(int) + 2 * AROUND + 1
    origin = low - 0.5 * ((counts - 1) * spacing - extent)  # as far beyond the box on both sides
    nx, ny, nz = (int(count) for count in counts)
    x, y, z = (float(place) for place in origin)
    return ColourGrid((nx, ny, nz), float(spacing), (x, y, z), detail)


def _detail(placed: PlacedMesh, number: int) -> float:
    """How wide a part's texels are, or the edges between its coloured vertices, mm; 0 where it is of one colour."""
    part: Part = placed.looks.parts[number]
    rows = slice(placed.looks.begins[number], placed.looks.begins[number + 1])
    if part.look.texture is not None and part.uv is not None:
        height, width = part.look.texture.pixels.shape[:2]
        a, b, c = (part.uv[part.triangles[:, k]] * [width, height] for k in range(3))
        (p, q), (r, s) = (b - a).T, (c - a).T
        texels = 0.5 * np.abs(p * s - q * r).sum()
        return float(math.sqrt(placed.areas[rows].sum() / texels)) if texels > 0 else 0.0
    if part.colours is None:
        return 0.0
    corners = placed.surface.corners[rows]
    return float(np.median(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)))
