"""Smaller triangles where a material that a bake is told of changes within them.

A tet has one value of each coefficient, so that a picture shows a step of the material with the outline of triangles.
They are cut there until the material is nearly the same in each, or until they are short against the mean free path,
over which light blurs any step.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from quadgraph import core
from quadgraph.baking.light_decay import coefficients, falling, is_even, opened
from quadgraph.mesh import bisection
from quadgraph.mesh.bisection import Cut
from quadgraph.mesh.creases import creases
from quadgraph.mesh.intersections import intersecting_triangles
from quadgraph.mesh.subdivide import curved
from quadgraph.mesh.surface import Surface
from quadgraph.tets.interior import mean_chord

EDGE_SHARE = 0.5  # of a mean free path: edges as short are not cut
SLIGHT = 0.15  # of the logarithms of what a material does to light: it counts as the same where they change by less
MOST_TIMES, MOST_ANYWAY = 4.0, 30_000  # triangles that may result: so many times those of before, or so many
_DARK = 0.05  # brightness that is added to all: what is as dark as that is alike
_PASSES = 24  # each halves the longest edge of triangles, at least
_POINTS_AT_ONCE = 400_000
_GRID, _FINER_GRID = 5, 11  # rows of points in a triangle that are looked at; in the first pass, of large ones
_BEYOND = 1.05  # times as large a triangle they are spread over: a step along an edge is one of both sides


@dataclass(frozen=True, eq=False)
class Refined:
    """A surface with smaller triangles, the cuts that made it, in their order, and a sentence for the user, or ""."""

    surface: Surface
    cuts: tuple[Cut, ...] = ()
    note: str = ""

    def straight(self, before: Surface) -> Surface:
        """The triangles of `before`, which was cut, with the same cuts and no other shape."""
        corners = before.corners
        for each in self.cuts:
            corners = each.carried(corners)
        vertices = np.empty_like(self.surface.vertices)
        vertices[self.surface.triangles] = corners
        return Surface(vertices, self.surface.triangles).rounded()


def refined(surface: Surface, materials: Sequence[str], mesher: str = "tetgen") -> Refined:
    """Cut the triangles of a closed 2-manifold (mm) where one of the materials changes in them; else it is the same.

    materials: as of `light_decay.opened`; mesher: only TetGen keeps triangles. New vertices lie as `subdivide` has
    them. Raises InputError for a material that cannot be read, ToolError if TetGen is missing.
    """
    changing = [material for material in map(opened, materials) if not is_even(material)]
    if not changing or mesher != "tetgen":
        return Refined(surface)
    # The test takes longer than all else, and hardly ever finds a crossing: it is made once first.
    found = _cut(surface, changing, lambda finer: np.empty(0, np.int64))
    return _cut(surface, changing, intersecting_triangles) if _crosses(found) else found


def _crosses(found: Refined) -> bool:
    return bool(found.cuts) and len(intersecting_triangles(found.surface)) > 0


def _cut(
    surface: Surface, materials: Sequence[str | core.Volume], crossing: Callable[[Surface], np.ndarray]
) -> Refined:
    most = max(MOST_TIMES * len(surface.triangles), MOST_ANYWAY)
    sharp, finer, cuts, limited = creases(surface), surface, [], 0.0
    for number in range(_PASSES):
        wanted = _wanted_edges(finer, surface, materials, _FINER_GRID if number == 0 else _GRID)
        step, limited = _cut_within(finer, wanted, most)
        if step is None:
            break
        made, marked = step
        finer, sharp = curved(finer, sharp, marked, made.triangles, made.parent, crossing)
        cuts.append(made)
    return Refined(finer, tuple(cuts), _note(surface, finer, limited) if cuts or limited else "")


def _note(surface: Surface, finer: Surface, limited: float) -> str:
    before, after = len(surface.triangles), len(finer.triangles)
    text = f"surface: {before:,} triangles cut into {after:,} where the material changes within them"
    if limited:
        text += (f"; edges up to {limited:.3g} times as long as its mean free path wants stay, as more triangles "
                 "would be too many; --refine or a mesh with more triangles has shorter ones")  # fmt: skip
    return text


def _cut_within(surface: Surface, wanted: np.ndarray, most: float) -> tuple[tuple[Cut, np.ndarray] | None, float]:
    """The next cut, with the edges that it halves, and how many times too long edges stay, 0 where none do.

    Where cutting all that are too long makes too many triangles, the longest against what is wanted go first.
    """
    lengths, face_edges = bisection.edge_lengths(surface), surface.topology.face_edges
    of_faces = lengths[face_edges] / wanted[:, None]
    # The longest edge goes first, others with it where their halves are still too long.
    of_faces = np.where(of_faces == of_faces.max(axis=1, keepdims=True), of_faces, of_faces / 2)
    times = np.zeros(len(lengths))
    np.maximum.at(times, face_edges, of_faces)
    least = 1.0
    while (times > least).any():
        marked = bisection.closed(surface, times > least)
        made = bisection.cut(surface, marked)
        if len(made.triangles) <= most:
            return (made, marked), 0.0
        least *= np.sqrt(2)
    return None, float(times.max()) if least > 1 else 0.0


def _wanted_edges(finer: Surface, body: Surface, materials: Sequence[str | core.Volume], grid: int) -> np.ndarray:
    """(m,) mm: how long edges of each triangle may be, infinite where no material changes in it."""
    wanted = np.full(len(finer.triangles), np.inf)
    spread = 2 / (1.5 * mean_chord(body))
    for rows, points in _points_in(finer, grid):
        for material in materials:
            scattering, absorption = coefficients(material, body, points.reshape(-1, 3), on_surface=True)
            shape = (*points.shape[:2], -1)
            extinction = (scattering + absorption).reshape(shape)
            rate = np.hypot(falling(scattering, absorption), spread).reshape(shape)
            looks = brightness(scattering, absorption).reshape(shape) + _DARK
            slight = np.stack([np.ptp(np.log(np.maximum(each, 1e-6)), axis=1) for each in (extinction, rate, looks)])
            changes = slight.max(axis=0) > SLIGHT
            path = 1 / np.maximum(extinction.mean(axis=1), 1e-6)
            of_rows = np.where(changes, EDGE_SHARE * path, np.inf).min(axis=1)
            wanted[rows] = np.minimum(wanted[rows], of_rows)
    return wanted


def _points_in(surface: Surface, grid: int) -> Iterator[tuple[slice, np.ndarray]]:
    """Points (rows, n, 3) spread over triangles and a little beyond, mm; some triangles at a time."""
    i, j = np.indices((grid, grid)) / (grid - 1)
    inside = np.arange(grid)[:, None] + np.arange(grid) < grid
    weights = np.column_stack([1 - i[inside] - j[inside], i[inside], j[inside]])
    weights = 1 / 3 + _BEYOND * (weights - 1 / 3)
    at_once = max(_POINTS_AT_ONCE // len(weights), 1)
    for begin in range(0, len(surface.triangles), at_once):
        rows = slice(begin, begin + at_once)
        yield rows, np.einsum("nc,mcj->mnj", weights, surface.corners[rows])


def brightness(scattering: np.ndarray, absorption: np.ndarray) -> np.ndarray:
    """Share of diffuse light that a half-space sends back at index 1, within .01 [Hulst 1980]."""
    albedo = scattering / np.maximum(scattering + absorption, 1e-30)
    s = np.sqrt(np.clip(1 - albedo, 0, 1))
    return (1 - s) * (1 - 0.139 * s) / (1 + 1.17 * s)
