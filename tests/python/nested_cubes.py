"""A hand-made cube of 3 mm around one of 1 mm that shares its surface; run as a script, this writes it."""

import itertools
from pathlib import Path

import numpy as np

import tiny
from quadgraph.file import joined, qgraph_file, sections
from quadgraph.mesh.surface import TetMesh
from quadgraph.tets import graph

PATH = Path(__file__).parents[1] / "data" / "nested_cubes.qgraph"
NAMES = ("inner", "outer")
SIDE = 3  # cells of 1 mm


def mesh() -> TetMesh:
    """Return 27 cubes of six tets each, of which the one in the middle is region 1."""
    count = SIDE + 1
    vertices = np.array(list(itertools.product(range(count), repeat=3)), float)
    cells = np.array(list(itertools.product(range(SIDE), repeat=3)))
    corners = np.array(list(itertools.product((0, 1), repeat=3)))
    numbers = (cells[:, None] + corners) @ [count * count, count, 1]
    tets = numbers[:, tiny.six().tets].reshape(-1, 4)
    regions = np.repeat((cells == 1).all(axis=1).astype(np.int64), 6)
    return TetMesh(vertices, tets, tiny.BY_HAND, regions)


def level() -> graph.Graph:
    """Return its one level."""
    return graph.build(mesh())


def all_sections() -> dict[str, np.ndarray]:
    """Return all sections but the metadata: the outer cube is body 1."""
    return joined.join([sections.whole_file([level()], mesh().boundary().compacted())], [[1, 0]])


def metadata() -> dict:
    """Return metadata that does not depend on any installed version."""
    return tiny.metadata([level()]) | {"bodies": [{"name": "inner", "within": "outer"}, {"name": "outer"}]}


if __name__ == "__main__":
    qgraph_file.write(PATH, metadata(), all_sections())
