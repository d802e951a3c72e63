"""A hand-made object of two levels, a cube of 2 mm in six tets and in five; run as a script, this writes it."""

import itertools
from pathlib import Path

import numpy as np

from quadgraph.file import qgraph_file, sections
from quadgraph.mesh.surface import MesherInfo, TetMesh
from quadgraph.tets import graph

PATH = Path(__file__).parents[1] / "data" / "tiny.qgraph"

CORNERS = 2.0 * np.array(list(itertools.product((0, 1), repeat=3)))  # corner 4x + 2y + z
BY_HAND = MesherInfo("hand", "1", "")
FIVE = TetMesh(CORNERS, np.array([[0, 3, 5, 6], [1, 0, 3, 5], [2, 0, 6, 3], [4, 0, 5, 6], [7, 3, 6, 5]]), BY_HAND)


def six() -> TetMesh:
    """Return the cube as the six tets around its diagonal, one for each order of the axes."""
    tets = []
    for axes in itertools.permutations((4, 2, 1)):
        a, b = axes[0], axes[0] + axes[1]
        odd = axes in ((4, 1, 2), (2, 4, 1), (1, 2, 4))
        tets.append([0, b, a, 7] if odd else [0, a, b, 7])
    return TetMesh(CORNERS, np.array(tets), BY_HAND)


def graphs() -> list[graph.Graph]:
    """Return both levels, finest first."""
    return [graph.build(six()), graph.build(FIVE)]


def metadata(levels: list[graph.Graph]) -> dict:
    """Return metadata that does not depend on any installed version."""
    return {
        "generator": "quadgraph 0.1.0",
        "source": {"name": "cube", "sha256": "0" * 64, "vertices": 8, "triangles": 12},
        "unit_mm": 1.0,
        "mesher": {"name": "hand", "version": "1", "options": "", "grading": 0.0},
        "repairs": [],
        "levels": [sections.level_metadata(level) for level in levels],
        "tools": {},
    }


def all_sections() -> dict[str, np.ndarray]:
    """Return all sections but the metadata."""
    return sections.whole_file(graphs(), six().boundary())


if __name__ == "__main__":
    qgraph_file.write(PATH, metadata(graphs()), all_sections())
