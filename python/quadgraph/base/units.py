"""Units of length."""

from __future__ import annotations

UNITS_MM = {"mm": 1.0, "cm": 10.0, "m": 1000.0}
