"""How large the body of a mesh file is: as somebody says, or as is usual where nobody does."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph.base.units import SIZES_MM, UNITS_MM

LONGEST_MM = 100.0  # longest side of a body of unknown size
METRES_MM = (5.0, 3000.0)  # longest side of a glTF body whose coordinates are believed to be metres, as they should be
_HEIGHT_AXIS = 1  # y: height is the extent along it
_GLTF = (".gltf", ".glb")


def scale_of(
    path: Path, used: np.ndarray, unit: str | None, height_mm: float | None, longest_mm: float | None
) -> tuple[float, str]:
    """Return the length of one unit of a file in mm, and a sentence on it where it was nobody's choice, else "".

    used: (n, 3), vertices of triangles. At most one of the three may be given: unit "mm", "cm" or "m"; height_mm, the
    extent along y; longest_mm, the longest side of the bounding box. Raises InputError naming the file and what is
    wrong.
    """
    with np.errstate(over="ignore"):
        extent = used.max(axis=0) - used.min(axis=0)
    scale, said = _scale(path, extent, unit, height_mm, longest_mm)
    with np.errstate(over="ignore", invalid="ignore"):
        longest, farthest = float(extent.max()) * scale, float(np.abs(used).max()) * scale
    if not SIZES_MM[0] <= longest <= SIZES_MM[1] or not farthest <= SIZES_MM[1]:
        raise InputError(
            f"{path}: a longest side of {longest:.3g} mm found, at most {farthest:.3g} mm from 0, allowed are "
            f"{SIZES_MM[0]:g} to {SIZES_MM[1]:g} mm; state another unit or size"
        )
    return scale, said


def _scale(
    path: Path, extent: np.ndarray, unit: str | None, height_mm: float | None, longest_mm: float | None
) -> tuple[float, str]:
    given = {"unit": unit, "height": height_mm, "longest": longest_mm}
    stated = [name for name, value in given.items() if value is not None]
    if len(stated) > 1:
        raise InputError(f"{path}: both {' and '.join(stated)} given; state one")
    if unit is not None:
        if unit not in UNITS_MM:
            raise InputError(f"{path}, unit: '{unit}' found, allowed are {', '.join(UNITS_MM)}")
        return UNITS_MM[unit], ""
    if height_mm is not None:
        return _to(path, "height", height_mm, float(extent[_HEIGHT_AXIS]), "extent along y"), ""
    if longest_mm is not None:
        return _to(path, "longest", longest_mm, float(extent.max()), "extent"), ""
    return _usual(path, extent)


def _to(path: Path, name: str, wanted_mm: float, found: float, what: str) -> float:
    if not (np.isfinite(wanted_mm) and wanted_mm > 0):
        raise InputError(f"{path}, {name}: {wanted_mm!r} mm found, allowed is a finite number above 0")
    if found <= 0:
        raise InputError(f"{path}, {name}: the mesh has no {what}; state its unit instead")
    return float(wanted_mm) / found


def _usual(path: Path, extent: np.ndarray) -> tuple[float, str]:
    """Metres of a glTF file where that makes a plausible body, else the longest side as usual."""
    longest = float(extent.max())
    metres = path.suffix.lower() in _GLTF and METRES_MM[0] <= longest * UNITS_MM["m"] <= METRES_MM[1]
    scale = UNITS_MM["m"] if metres else _to(path, "longest", LONGEST_MM, longest, "extent")
    size = " x ".join(f"{side * scale:.4g}" for side in extent)
    why = "its unit is the metre, as in glTF" if metres else f"its longest side is {LONGEST_MM:g} mm"
    return scale, (
        f"{path.name}: no size was given, so {why} ({size} mm); smaller is more translucent: --longest 40mm, "
        "--height 40mm or --unit cm says otherwise"
    )
