"""What `quadgraph doctor` tries in a process of its own, which a driver or a library may end: one word says what.

Prints one line of JSON on standard output: what was found, or under "error" why it was not.
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any


def devices() -> dict[str, Any]:
    """The devices that Vulkan finds."""
    from quadgraph.core import load_core

    return {"vulkan": load_core().vulkan_devices()}


def picture() -> dict[str, Any]:
    """Solve and draw a tetrahedron on the device that is taken, and write both kinds of pictures."""
    import numpy as np

    from quadgraph.core import load_core
    from quadgraph.file import qgraph_file, sections
    from quadgraph.mesh.surface import Surface

    core = load_core()
    corners = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    surface = Surface(corners, np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]))
    with tempfile.TemporaryDirectory(prefix="quadgraph-") as folder:
        body = Path(folder) / "tetrahedron.qgraph"
        source = {"name": "tetrahedron", "sha256": "0" * 64, "vertices": 4, "triangles": 4}
        mesher = {"name": "none", "version": "", "options": "", "grading": None}
        metadata = {"generator": "quadgraph doctor", "source": source, "unit_mm": 1.0, "mesher": mesher}
        metadata |= {"repairs": [], "levels": [], "tools": {}}
        qgraph_file.write(body, metadata, sections.display_alone(surface, corners / np.sqrt(3)))
        engine = core.Engine(body)
        engine.set_material("marble")
        engine.set_lights(core.default_lights())
        engine.solve(method="shortest-path", path_cells=8)
        drawn = engine.render(size="32x32")
        drawn.write_png(Path(folder) / "a.png")
        drawn.write_exr(Path(folder) / "a.exr")
    if not float(drawn.scattered.max()) > 0:
        raise ValueError("the picture is black")
    return {"device": engine.device_name, "driver": engine.driver}


def bake() -> dict[str, Any]:
    """Import all that bakes: the libraries that read and repair meshes."""
    import quadgraph.baking.pipeline
    from quadgraph.tets import tetrahedralise

    return {"modules": [quadgraph.baking.pipeline.__name__, tetrahedralise.__name__]}


TRIED: dict[str, Callable[[], dict[str, Any]]] = {"devices": devices, "picture": picture, "bake": bake}


def main(name: str) -> None:
    """Try one and print what came of it."""
    with os.fdopen(os.dup(1), "w") as answers:
        os.dup2(2, 1)  # what libraries print is no answer
        try:
            found = TRIED[name]()
        except Exception as error:
            found = {"error": str(error) or type(error).__name__}
        print(json.dumps(found), file=answers)


if __name__ == "__main__":
    main(sys.argv[1])
