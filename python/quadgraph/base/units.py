"""Units of length, and what a medium is where nobody says it."""

from __future__ import annotations

DEFAULT_ETA = 1.3  # index of refraction, inside over outside: the engine's (engine/optics/material.h), held by a test
SIZES_MM = (1e-4, 1e7)  # of a body's longest side: squares, volumes and light are within single precision
UNITS_MM = {"mm": 1.0, "cm": 10.0, "m": 1000.0}
UPS = ("y", "z")  # axes of a mesh that may point up
