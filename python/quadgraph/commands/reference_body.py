"""The body that swatches show: a ball with seven ribs, thin at their edges and thick within, baked once and kept."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from rich.console import Console

LONGEST_MM = 20.0
VIEW = "0,40"  # from where its ribs are seen
_RIBS = 7
_DEPTH = 0.2  # of the mean radius
_CUTS = 4  # times that the edges of an icosahedron are halved: 2,562 vertices
_SOLVED = 1200  # vertices of the surface that is solved on


@contextlib.contextmanager
def body() -> Iterator[Path]:
    """Give its .qgraph, there as long as the block runs. Raises InputError, ToolError."""
    from quadgraph.baking import kept
    from quadgraph.baking.pipeline import BakeOptions

    errors = Console(stderr=True, highlight=False, soft_wrap=True)

    def tell(text: str) -> None:
        errors.print(text, markup=False)

    with tempfile.TemporaryDirectory(prefix="quadgraph-") as folder, contextlib.ExitStack() as stack:
        mesh = Path(folder) / "ribs.obj"
        mesh.write_text(text_of(*surface()))
        options = BakeOptions(longest_mm=LONGEST_MM, surface_vertices=_SOLVED)
        with errors.status("baking the body of swatches, once"):
            path = stack.enter_context(kept.body(mesh, options, tell))
        yield path


def surface() -> tuple[np.ndarray, np.ndarray]:
    """Vertices (n, 3), and triangles (m, 3) counter-clockwise from outside; y points up."""
    import trimesh

    ball = trimesh.creation.icosphere(subdivisions=_CUTS)
    x, y, z = ball.vertices.T
    around = np.arctan2(z, x)
    radius = 1 + _DEPTH * np.cos(_RIBS * around) * (1 - y**2)
    return ball.vertices * radius[:, None] * [1.0, 0.75, 1.0], np.asarray(ball.faces)


def text_of(vertices: np.ndarray, triangles: np.ndarray) -> str:
    """The text of an OBJ file."""
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in vertices]
    lines += [f"f {a} {b} {c}" for a, b, c in triangles + 1]
    return "\n".join(lines) + "\n"
