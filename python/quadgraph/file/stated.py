"""What the metadata of a `.qgraph` file states of its levels, held against the sections."""

from __future__ import annotations

import math
from typing import Any, NoReturn

import numpy as np

from quadgraph.base.errors import FormatError
from quadgraph.file.level_quality import boundary
from quadgraph.file.qgraph_file import QGraphFile
from quadgraph.tets.tet_geometry import determinants

_ROUNDED = 1e-3  # relative: volumes and areas were those of vertices in double precision


def of_level(file: QGraphFile, number: int) -> dict[str, Any]:
    """What the sections say of one level, by the names of the metadata: counts, mm^3 and mm^2."""
    vertices, tets, faces = (file.sections[f"level{number}/{name}"] for name in ("vertices", "tets", "faces"))
    return {
        "vertices": len(vertices),
        "surface_vertices": int(faces.max()) + 1,
        "tets": len(tets),
        "faces": len(faces),
        "volume_mm3": float(determinants(vertices.astype(np.float64), tets).sum() / 6),
        "area_mm2": boundary(file, number).area,
    }


def check(file: QGraphFile, name: str) -> None:
    """Raise FormatError if the metadata states another count, volume or area of a level than the sections of the file
    called `name` have.
    """
    levels = file.metadata["levels"]
    if not isinstance(levels, list) or len(levels) != file.level_count:
        _refuse(name, f"levels: the sections have {file.level_count}, others are stated")
    for number, level in enumerate(levels):
        for key, found in of_level(file, number).items():
            value = level.get(key) if isinstance(level, dict) else None
            allowed = _ROUNDED if isinstance(found, float) else 0
            if not isinstance(value, int | float) or not math.isclose(value, found, rel_tol=allowed):
                _refuse(name, f"levels/{number}/{key}: {str(value)[:40]} stated, the sections have {found:.7g}")


def _refuse(name: str, what: str) -> NoReturn:
    raise FormatError(f"{name}: metadata: not what a bake writes ({what}); bake it again")
