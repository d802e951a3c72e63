"""Units of length, and what a medium is where nobody says it."""

from __future__ import annotations

DEFAULT_ETA = 1.3  # index of refraction, inside over outside: the engine's (engine/optics/material.h), held by a test
UNITS_MM = {"mm": 1.0, "cm": 10.0, "m": 1000.0}
