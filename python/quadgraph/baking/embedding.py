"""Bodies that lie within another's solid and share their surface with it: their surfaces on every level."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from quadgraph.baking.placing import hosts_of
from quadgraph.baking.surface_changes import Refined
from quadgraph.base.errors import InputError
from quadgraph.base.progress import ProgressCallback
from quadgraph.mesh import lod, subdivide
from quadgraph.mesh.surface import Surface, joined_surface

_COARSER = 0.6  # of a level's vertices the next has no more; with more it is not worth its memory


@dataclass(frozen=True, eq=False)
class Embedded:
    """A body within another's solid: its surface, mm, and about how many vertices it is solved on, None for all."""

    name: str
    surface: Surface
    surface_vertices: int | None = None


@dataclass(frozen=True, eq=False)
class LevelSurfaces:
    """What tets of a level fill: a body's surface, and those within it that they meet with their faces, mm."""

    outer: Surface
    inner: list[Surface] = field(default_factory=list)

    @property
    def whole(self) -> Surface:
        """All as one, the outer first."""
        return joined_surface([self.outer, *self.inner])


def _finest(surface: Surface, refine: int, surface_vertices: int | None) -> Surface:
    """The finest surface to compute on."""
    refined = subdivide.subdivide(surface, refine)
    return lod.simplify(refined, surface_vertices) if surface_vertices else refined


def _finest_of(body: Embedded, refine: int) -> Surface:
    try:
        return _finest(body.surface.rounded(), refine, body.surface_vertices)
    except InputError as error:
        raise InputError(f"{body.name}: {error}") from error


def _chain(surface: Surface, levels: int | None, least: int) -> lod.SurfaceChain:
    """Levels of a surface within another that has `least`; of small ones too, so that they do not keep tets small."""
    chain = lod.build_chain(surface, levels=levels)
    return chain if len(chain) >= least else lod.build_chain(surface, levels=least)


class Nest:
    """The finest surfaces, and coarser ones that lie within each other as they do."""

    def __init__(self, outer: Surface, within: Sequence[Embedded], refine: int, surface_vertices: int | None) -> None:
        """refine, surface_vertices: as of BakeOptions, the latter of the outer surface.

        Raises InputError for options that a surface cannot have, and where surfaces cross by them.
        """
        self.finest = LevelSurfaces(
            _finest(outer, refine, surface_vertices), [_finest_of(body, refine) for body in within]
        )
        self._names = ["the body around", *(body.name for body in within)]
        self._hosts: list[int | None] = [None]
        if within:
            self._hosts = hosts_of([outer, *(body.surface for body in within)], self._names)
            if not self._lie_right([self.finest.outer, *self.finest.inner]):
                raise InputError("surface_vertices or refine: as they make them, surfaces of bodies within one another "
                                 "cross; give more surface_vertices, or leave refine out")  # fmt: skip

    def chain(self, levels: int | None, tell: ProgressCallback) -> tuple[list[LevelSurfaces], list[str]]:
        """Surfaces of all levels, finest first, and notes for the report; levels: as of `lod.build_chain`.

        Surfaces are simplified by themselves; where those within come to cross others, finer ones stand in for them.
        """
        outer = lod.build_chain(self.finest.outer, levels=levels, progress=tell)
        within = [_chain(surface, levels, len(outer)) for surface in self.finest.inner]
        found, notes, ended = [self.finest], [], outer.ended
        for number in range(1, max(map(len, (outer, *within)))):
            coarse, finer = self._level(outer, within, number)
            if coarse is None:
                ended = "on coarser ones the surfaces of bodies within others cross"
                break
            if within and len(coarse.whole.vertices) > _COARSER * len(found[-1].whole.vertices):
                ended = "the surfaces of bodies within others become no coarser"
                break
            if finer < number:
                notes.append(f"level {number}: bodies within others have the surfaces of level {finer}, as their own "
                             "would cross others there")  # fmt: skip
            found.append(coarse)
        return found, [f"the chain ends after level {len(found) - 1}: {ended}", *notes]

    def take(self, finer: Refined) -> list[str]:
        """Make a finer outer surface the finest, unless those within would cross it; notes for the report."""
        inner = self.finest.inner
        if inner and finer.cuts and not self._lie_right([finer.surface, *inner]):
            return ["surface: triangles stay as they are where the material changes within them, as smaller ones "
                    "would cross bodies within"]  # fmt: skip
        self.finest = LevelSurfaces(finer.surface, inner)
        return [finer.note] if finer.note else []

    def _level(
        self, outer: Sequence[Surface], within: Sequence[Sequence[Surface]], number: int
    ) -> tuple[LevelSurfaces | None, int]:
        """The surfaces of a level, and of which level those within are; None where all of them cross."""
        around, tried = outer[min(number, len(outer) - 1)], None
        for finer in range(number, -1, -1):
            which = [min(finer, len(chain) - 1) for chain in within]
            if which == tried:
                continue
            tried = which
            inner = [chain[k] for chain, k in zip(within, which, strict=True)]
            if not inner or self._lie_right([around, *inner]):
                return LevelSurfaces(around, inner), finer
        return None, 0

    def _lie_right(self, surfaces: list[Surface]) -> bool:
        try:
            return hosts_of(surfaces, self._names) == self._hosts
        except InputError:
            return False
