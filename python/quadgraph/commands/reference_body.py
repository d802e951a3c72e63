"""The body that swatches show: a ball with seven ribs, thin at their edges and thick within, baked once and kept."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from rich.console import Console

if TYPE_CHECKING:
    from quadgraph.mesh.surface import Surface

LONGEST_MM = 20.0
VIEW = "0,40"  # from where its ribs are seen
_RIBS = 7
_DEPTH = 0.2  # of the mean radius
_CUTS = 4  # times that the edges of an icosahedron are halved: 2,562 vertices
_SOLVED = 1200  # vertices of the surface that is solved on


@contextlib.contextmanager
def body(longest_mm: float = LONGEST_MM) -> Iterator[Path]:
    """Give its .qgraph of a size, there as long as the block runs. Raises InputError, ToolError."""
    from quadgraph.baking import kept
    from quadgraph.baking.pipeline import BakeOptions
    from quadgraph.mesh.tet_files import write_off

    errors = Console(stderr=True, highlight=False, soft_wrap=True)

    def tell(text: str) -> None:
        errors.print(text, markup=False)

    with tempfile.TemporaryDirectory(prefix="quadgraph-") as folder, contextlib.ExitStack() as stack:
        mesh = Path(folder) / "ribs.off"
        write_off(surface(), mesh)
        options = BakeOptions(longest_mm=longest_mm, surface_vertices=_SOLVED)
        with errors.status("baking the body of swatches, once"):
            path = stack.enter_context(kept.body(mesh, options, tell))
        yield path


def surface() -> Surface:
    """Its surface, about 1 in radius; y points up."""
    import trimesh

    from quadgraph.mesh.surface import Surface

    ball = trimesh.creation.icosphere(subdivisions=_CUTS)
    x, y, z = ball.vertices.T
    around = np.arctan2(z, x)
    radius = 1 + _DEPTH * np.cos(_RIBS * around) * (1 - y**2)
    return Surface(ball.vertices * radius[:, None] * [1.0, 0.75, 1.0], np.asarray(ball.faces))
