"""What the tets inside a body are sized by: its shape, a length, or the materials that it is baked for."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from dataclasses import replace
from typing import Any

from quadgraph.baking.light_decay import change_length, decay_rates, opened
from quadgraph.base.errors import InputError, ToolError
from quadgraph.mesh.surface import Surface, TetMesh
from quadgraph.tets import interior
from quadgraph.tets.interior import Interior, Limits

AUTO, SURFACE = "auto", "surface"
_FEW = 0.1  # of the tets, those at the surface, may be larger than asked for before the report says so


def check_interior(wanted: str | float | None, materials: Sequence[str], mesher: str) -> None:
    """Refuse what cannot be done. Raises InputError."""
    if mesher == "polygrid":
        for name, value in (("interior", wanted), ("for_materials", materials)):
            if value:
                raise InputError(f"{name}: found with mesher 'polygrid', whose cubes and cells say how fine it is")
    if isinstance(wanted, str):
        if wanted not in (AUTO, SURFACE):
            raise InputError(
                f"interior: {wanted!r} found, allowed are 'auto', 'surface' and an edge length above 0, mm"
            )
    elif wanted is not None and not (math.isfinite(wanted) and wanted > 0):
        raise InputError(f"interior: {wanted} found, allowed are 'auto', 'surface' and an edge length above 0, mm")
    if wanted == AUTO and mesher == "cgal":
        raise InputError("interior: 'auto' found with mesher 'cgal', which grading sizes; allowed are 'surface' and mm")
    if materials and wanted not in (None, AUTO):
        raise InputError(f"for_materials: found with interior {wanted!r}; one of them says how large tets are")
    for material in materials:
        if not any(decay_rates(material)):
            raise InputError(f"for_materials: '{material}' absorbs nothing, so that light in it falls by the shape "
                             "alone; leave it out, for interior 'auto'")  # fmt: skip


def sizes_of(surface: Surface, wanted: str | float | None, materials: Sequence[str], mesher: str) -> LevelSizes:
    """Sizes of a bake whose finest simulation surface is this one, as `check_interior` allows."""
    if materials:
        known = [opened(material) for material in materials]
        rates = {rate for material in known for rate in decay_rates(material)}
        change = min(change_length(material, surface) for material in known)
        return LevelSizes(interior.for_rates(surface, sorted(rates), change))
    if wanted == SURFACE or (wanted is None and mesher != "tetgen"):
        return LevelSizes(None)
    if wanted is None or isinstance(wanted, str):
        return LevelSizes(interior.automatic(surface))
    return LevelSizes(interior.of_size(wanted))


class LevelSizes:
    """Sizes of all levels of one bake: those of the finest, and of every coarser one twice those of the one before.

    So levels differ inside as on the surface, where one has a quarter of the vertices of the one before.
    """

    def __init__(self, finest: Interior | None) -> None:
        self._finest = finest
        self._settled: Future[Interior] = Future()

    @property
    def rule(self) -> str:
        """What they come from."""
        return SURFACE if self._finest is None else self._finest.rule

    def fill(
        self, number: int, surface: Surface, make: Callable[[Limits | None], TetMesh]
    ) -> tuple[TetMesh, float | None, list[str]]:
        """Make the tets of a level; with them the largest edge inside, mm, None for any, and notes for the report.

        Coarser levels wait for the finest to settle. Raises ToolError where the finest cannot have the sizes that were
        asked for; where nobody did, and on coarser levels, the tets are those that the surface makes then.
        """
        if self._finest is None:
            return make(None), None, []
        limits = self._limits(number, surface, self._finest)
        try:
            mesh = make(limits)
            return mesh, limits.interior.edge, self._missed(number, limits, mesh)
        except ToolError as error:
            if number == 0 and self.rule != AUTO:
                self._give_up(number, error)
                raise
            return self._without(number, make, str(error))
        except BaseException as error:
            self._give_up(number, error)
            raise

    def _missed(self, number: int, limits: Limits, mesh: TetMesh) -> list[str]:
        """A note where the surface, which TetGen keeps, has not let it make tets as small as was asked for."""
        if number > 0 or self.rule == AUTO or (above := limits.share_above(mesh)) <= _FEW:
            return []
        return [f"level 0: {above:.0%} of the tets have more than twice the volume asked for, because the surface's "
                "triangles are large and stay; --refine makes them smaller"]  # fmt: skip

    def _limits(self, number: int, surface: Surface, finest: Interior) -> Limits:
        if number == 0:
            return Limits(surface, finest, self._settled.set_result)
        return Limits(surface, replace(self._settled.result(), most=None).times(2.0**number))

    def _without(
        self, number: int, make: Callable[[Limits | None], TetMesh], why: str
    ) -> tuple[TetMesh, None, list[str]]:
        try:
            mesh = make(None)
        except BaseException as error:
            self._give_up(number, error)
            raise
        if number == 0 and not self._settled.done() and self._finest:
            self._settled.set_result(self._finest)
        return mesh, None, [f"level {number}: tets inside are as the surface makes them: {why}"]

    def _give_up(self, number: int, error: BaseException) -> None:
        """Tell the levels that wait."""
        if number == 0 and not self._settled.done():
            self._settled.set_exception(error)


def metadata(rule: str, materials: Sequence[str], edges: Sequence[float | None]) -> dict[str, Any]:
    """What a file tells of it; edges: the largest inside of every level, mm."""
    return {"rule": rule, "materials": list(materials), "edge_mm": list(edges)}


def sentence(entry: dict[str, Any]) -> str:
    """What `metadata` says, in words."""
    materials = ", ".join(entry["materials"])
    origin = {
        AUTO: "by the shape",
        SURFACE: "as the surface makes them",
        "size": "as asked for",
        "materials": f"for {materials}",
    }[entry["rule"]]
    edges = ", ".join("any" if edge is None else f"{edge:.3g}" for edge in entry["edge_mm"])
    return f"interior: tets {origin}" + ("" if entry["rule"] == SURFACE else f", edges of at most {edges} mm by level")
