"""How large tets may be inside a body: near the surface as it is, growing with depth, no larger than the light asks.

Linear elements of edge h let light that falls as exp(-k s) fall too fast, by the share k^3 h^2 / 24 of it for every
millimetre it goes. What crosses a body passes the middle as it passes the rest, so that a size which is the same
everywhere takes the fewest tets for an error on the far side; only the surface wants its own.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from quadgraph.base.errors import InputError
from quadgraph.mesh.surface import Surface, TetMesh
from quadgraph.tets.tet_geometry import determinants

GROWTH = 1.0  # of the edge length with depth, below the surface's own edge length
CHORD_SHARE = 0.1  # of the mean chord, 4 volume / area: edges deep inside where no material is known
MOST_MORE = 1.4  # times the tets that the surface alone makes: no more for a size that nobody asked for
DECAY_SHARE = 0.35  # of the length in which light falls by e: edges inside where the material is known
CHANGE_SHARE = 0.35  # of the way on which a material changes: longer edges hold too much of both
SHALLOW = 1.5  # decay lengths below the surface from which on edges grow: less light comes back from there
DEEPER = 0.4  # of their logarithm with decay lengths: light that goes in and out falls twice, and tets cost edge^-3
LEAST = 1.5  # times the surface's edges: sizes that nobody gave in mm are no less, for then the surface decides
_PIECES = 2.0  # tets that come of one, times its volume over its limit: they fill half of that on average
_SLACK, _FEW = 1.5, 0.01  # no more than this share of the tets have more than this times their limit
MOST_TETS = 2e7  # about as many as 20 GB of TetGen's memory hold
_REGULAR = np.sqrt(2) / 12  # volume of the regular tet of edge 1


def mean_chord(surface: Surface) -> float:
    """Mean length of straight ways through the body, mm."""
    return 4 * surface.volume / surface.area


class Depths:
    """Depth below a surface and its edge length there, from its vertices and the middles of its triangles."""

    def __init__(self, surface: Surface) -> None:
        corners = surface.corners
        of_triangles = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).mean(axis=1)
        at, count = surface.triangles.ravel(), len(surface.vertices)
        uses = np.maximum(np.bincount(at, minlength=count), 1)
        of_vertices = np.bincount(at, np.repeat(of_triangles, 3), count) / uses
        self._tree = cKDTree(np.concatenate([surface.vertices, corners.mean(axis=1)]))
        self._edge = np.concatenate([of_vertices, of_triangles])
        self.least_edge = self._edge.min()  # mm

    def at(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distance to the nearest sample, within a tenth, and the edge length there, (n,) mm each, of (n, 3), mm."""
        depth, nearest = self._tree.query(points, eps=0.1)
        return depth, self._edge[nearest]


@dataclass(frozen=True)
class Decay:
    """An edge length, mm, and the rate, 1/mm, at which light falls that it is for."""

    edge: float
    rate: float


@dataclass(frozen=True)
class Interior:
    """The largest edges inside one level.

    rule: what the sizes come from, as the metadata tells; decays: edge(depth) is the least of edge exp(DEEPER
    (rate depth - SHALLOW)), from where it grows on; growth: of edges with depth, below the surface's own; most:
    times the tets of the surface alone that may result, None for any number.
    """

    rule: str
    decays: tuple[Decay, ...]
    growth: float = GROWTH
    most: float | None = None

    @cached_property
    def edge(self) -> float:
        """The smallest of the edge lengths, mm."""
        return min(decay.edge for decay in self.decays)

    def times(self, factor: float) -> Interior:
        """These sizes deep inside, times a factor."""
        return replace(self, decays=tuple(replace(decay, edge=factor * decay.edge) for decay in self.decays))

    def eased(self, factor: float) -> Interior:
        """These sizes times a factor, reached sooner by it."""
        return replace(self.times(factor), growth=factor * self.growth)

    def edges(self, depth: np.ndarray, of_surface: np.ndarray) -> np.ndarray:
        """Largest edge lengths (n,), mm, at depths (n,) below a surface with edges (n,), mm each."""
        inside = np.full(len(depth), np.inf)
        for decay in self.decays:
            growth = np.clip(DEEPER * (decay.rate * depth - SHALLOW), 0.0, 50.0)
            inside = np.minimum(inside, decay.edge * np.exp(growth))
        if self.rule != "size":
            inside = np.maximum(inside, LEAST * of_surface)
        return np.minimum(inside, of_surface + self.growth * depth)


class Limits:
    """Largest volumes of the tets inside one surface; `interior` is what they go by, once a first mesh is known."""

    def __init__(
        self, surface: Surface, interior: Interior, settled: Callable[[Interior], None] = lambda interior: None
    ) -> None:
        """Make them; settled: is called with what they go by as soon as that is known."""
        self.interior, self._depths, self._settled, self._first = interior, Depths(surface), settled, True

    def __call__(self, vertices: np.ndarray, tets: np.ndarray) -> np.ndarray | None:
        """Volumes (n,), mm^3, that tets (n, 4) may have; None if that is what they are. Raises InputError.

        At first even one tet is too many: a coarse mesh has few, large ones. Sizes that nobody asked for are met well
        enough by one refinement, which a number of tets can be foreseen of.
        """
        if not self._first and self.interior.rule == "auto":
            return None
        volumes = np.abs(determinants(vertices, tets)) / 6
        if not self._first and np.mean(volumes > _SLACK * self._least_limit()) <= _FEW:
            return None  # wherever they lie, which takes long to find
        places = self._depths.at(vertices[tets].mean(axis=1))
        if self._first:
            self._settle(volumes, *places)
            self._settled(self.interior)
        limits = _REGULAR * self.interior.edges(*places) ** 3
        too_large = np.mean(volumes > (1 if self._first else _SLACK) * limits)
        most, self._first = (0.0 if self._first else _FEW), False
        return limits if too_large > most else None

    def share_above(self, mesh: TetMesh) -> float:
        """Share of the tets that have more than twice their limit."""
        volumes = mesh.determinants / 6
        large = np.flatnonzero(volumes > 2 * self._least_limit())
        places = self._depths.at(mesh.vertices[mesh.tets[large]].mean(axis=1))
        limits = _REGULAR * self.interior.edges(*places) ** 3
        return float(np.count_nonzero(volumes[large] > 2 * limits) / len(volumes))

    def _least_limit(self) -> float:
        """No limit is below it, mm^3: edges grow with depth and with the surface's own."""
        (edge,) = self.interior.edges(np.zeros(1), np.array([self._depths.least_edge]))
        return float((1 - 1e-9) * _REGULAR * edge**3)

    def _settle(self, volumes: np.ndarray, *places: np.ndarray) -> None:
        """Make the sizes as large as the number of tets wants them."""
        interior = self.interior

        def expected(factor: float) -> float:
            return expected_tets(volumes, _REGULAR * interior.eased(factor).edges(*places) ** 3)

        if interior.most is not None:
            self.interior = interior.eased(_least(expected, interior.most * len(volumes)))
        elif (count := expected(1.0)) > MOST_TETS:
            raise InputError(
                f"interior: edges of {interior.edge:.3g} mm would make about {count:.1e} tets, at most "
                f"{MOST_TETS:.0e} allowed; a larger size, or auto"
            )


def expected_tets(volumes: np.ndarray, limits: np.ndarray) -> float:
    """How many tets become of tets of these volumes (n,) that may have so much, (n,), mm^3."""
    return float(len(volumes) + _PIECES * (volumes / limits)[volumes > limits].sum())


def _least(expected: Callable[[float], float], most: float) -> float:
    """The least factor from 1 on with which no more than `most` tets are expected; 1024 if there is none."""
    low, high = 1.0, 1024.0
    if expected(low) <= most:
        return low
    for _ in range(24):
        middle = np.sqrt(low * high)
        low, high = (middle, high) if expected(middle) > most else (low, middle)
    return float(high)


def automatic(surface: Surface) -> Interior:
    """Sizes from the shape alone."""
    return Interior("auto", (Decay(CHORD_SHARE * mean_chord(surface), 0.0),), most=MOST_MORE)


def of_size(edge: float) -> Interior:
    """Edges of at most so many mm deep inside."""
    return Interior("size", (Decay(edge, 0.0),))


def for_rates(surface: Surface, rates: Sequence[float], change: float = np.inf) -> Interior:
    """Sizes for light that falls at these rates, 1/mm, in a material that changes once on so many mm.

    Light also falls because it spreads: over the body's thickness by about e^2 even where nothing absorbs it. What
    changes is as fine in the deep as below the surface.
    """
    spread = 2 / (1.5 * mean_chord(surface))
    decays = [Decay(DECAY_SHARE / float(np.hypot(rate, spread)), rate) for rate in rates]
    return Interior("materials", (*decays, *([Decay(CHANGE_SHARE * change, 0.0)] if np.isfinite(change) else [])))
