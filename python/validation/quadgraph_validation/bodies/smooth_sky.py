"""A smooth sky in grey, as a picture by longitude and latitude that an environment light reads."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np

_ROWS = 128


@dataclass(frozen=True, eq=False)
class SmoothSky:
    """Radiance (rows, 2 rows), W/(mm^2 sr), y up, its middle at -z and its right half at +x.

    shared (rows, 2 rows) uint8: exponent as Radiance's .hdr has it; values are what such a file holds.
    """

    type: ClassVar[str] = "environment"
    mantissa: np.ndarray
    shared: np.ndarray

    @property
    def radiance(self) -> np.ndarray:
        """(rows, 2 rows) W/(mm^2 sr)."""
        return (self.mantissa + 0.5) * np.exp2(self.shared.astype(float) - 136)

    @property
    def text(self) -> str:
        """What tells it from another."""
        return f"environment:{hashlib.sha256(self.mantissa.tobytes() + self.shared.tobytes()).hexdigest()[:12]}"

    def write(self, path: Path) -> None:
        """Write a Radiance picture without runs."""
        rgbe = np.stack([self.mantissa, self.mantissa, self.mantissa, self.shared], axis=-1)
        rows, columns = self.mantissa.shape
        header = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {rows} +X {columns}\n"
        path.write_bytes(header.encode() + rgbe.tobytes())


def directions(rows: int, columns: int) -> np.ndarray:
    """(rows, columns, 3) where the middles of a picture's texels lie."""
    height = np.cos(np.pi * (np.arange(rows) + 0.5) / rows)[:, None]
    longitude = 2 * np.pi * (np.arange(columns) + 0.5) / columns - np.pi
    flat = np.sqrt(1 - height**2)
    return np.stack(np.broadcast_arrays(flat * np.sin(longitude), height, -flat * np.cos(longitude)), axis=-1)


def drawn_sky(generator: np.random.Generator) -> SmoothSky:
    """An even part with two to four broad lobes, none narrower than some 30 degrees."""
    way = directions(_ROWS, 2 * _ROWS)
    radiance = np.full(way.shape[:2], generator.uniform(0.02, 0.2))
    for _ in range(generator.integers(2, 5)):
        axis = generator.normal(size=3)
        axis /= np.linalg.norm(axis)
        radiance += generator.uniform(0.2, 1.0) * np.exp(generator.uniform(2, 8) * (way @ axis - 1))
    exponent = np.floor(np.log2(radiance)) + 1
    mantissa = np.minimum(np.floor(radiance / np.exp2(exponent) * 256), 255)
    return SmoothSky(mantissa.astype(np.uint8), (exponent + 128).astype(np.uint8))
