"""The hand-made cube of tiny.py twice, as two bodies of one file; run as a script, this writes it."""

from pathlib import Path

import numpy as np

import tiny
from quadgraph.file import joined, qgraph_file, sections

PATH = Path(__file__).parents[1] / "data" / "two_cubes.qgraph"
NAMES = ("left", "right")
_PLACES = ("vertices", "nodes")


def all_sections() -> dict[str, np.ndarray]:
    """Return all sections but the metadata: the second cube lies 5 mm further along x."""
    left = tiny.all_sections()
    aside = np.array([5, 0, 0], "<f4")
    right = {name: array + aside if name.endswith(_PLACES) else array for name, array in left.items()}
    return joined.join([left, right])


def metadata() -> dict:
    """Return metadata that does not depend on any installed version."""
    levels = [sections.level_metadata(level) for level in joined.graphs(all_sections())]
    return tiny.metadata(tiny.graphs()) | {"levels": levels, "bodies": [{"name": name} for name in NAMES]}


if __name__ == "__main__":
    qgraph_file.write(PATH, metadata(), all_sections())
