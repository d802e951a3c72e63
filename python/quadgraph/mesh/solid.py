"""The surface of any mesh made fit for meshers: wrapped where that is asked for, then repaired."""

from __future__ import annotations

from quadgraph.base.progress import ProgressCallback
from quadgraph.mesh import repair, wrap
from quadgraph.mesh.surface import Repair, SourceMesh, Surface

_NEXT_STEP = "; --wrap auto bakes a closed surface around it"


def solid(
    source: SourceMesh,
    wrap_size: float | str | None,
    limits: tuple[float, int],
    tell: ProgressCallback,
) -> tuple[Surface, list[Repair], list[str]]:
    """A closed, outward-facing 2-manifold without crossings, mm, what was done for that, and notes for the user.

    wrap_size: as wrap.wrap takes it, None for the surface itself; limits: seconds and bytes of the child program.
    Raises what wrap.wrap and repair.repair raise.
    """
    if wrap_size is None:
        repaired, repairs = repair.repair(source.surface, source.name, source.frame, _NEXT_STEP)
        return repaired, repairs, []
    around = wrap.wrap(source.surface, wrap_size, source.name, *limits, tell)
    repaired, repairs = repair.repair(around.surface, source.name, source.frame)
    done = Repair(f"wrapped at {around.size:.3g} mm, triangles", around.triangles)
    return repaired, [done, *repairs], [around.sentence()]
