"""Materials from volumes of coefficients: .npz files, sampled at the nodes of a body's levels."""

from __future__ import annotations

import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import map_coordinates

from quadgraph.errors import InputError

if TYPE_CHECKING:
    from quadgraph._core import Engine

DEFAULT_ETA = 1.3
_COEFFICIENTS = ("sigma_s_prime", "sigma_a")
_FIELDS = (*_COEFFICIENTS, "spacing", "origin", "eta")


@dataclass(frozen=True)
class Volume:
    """Coefficients at the middles of the cells of a grid.

    sigma_s_prime, sigma_a: (nz, ny, nx, 3) 1/mm; spacing: (3,) mm along x, y, z; origin: (3,) mm, the middle of cell
    [0, 0, 0]; None: the grid is centred on the body; eta: refractive index inside over outside.
    """

    sigma_s_prime: np.ndarray
    sigma_a: np.ndarray
    spacing: np.ndarray
    origin: np.ndarray | None
    eta: float

    def at(self, position: np.ndarray, centre: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """sigma_s_prime and sigma_a, (n, 3) each, at (n, 3) mm: linear between cells, outside the nearest cell's.

        centre: (3,) mm, of the body.
        """
        size = np.array(self.sigma_a.shape[2::-1])
        origin = self.origin if self.origin is not None else centre - self.spacing * (size - 1) / 2
        cell = ((position - origin) / self.spacing)[:, ::-1].T
        return tuple(
            np.stack([map_coordinates(v[..., c], cell, order=1, mode="nearest") for c in range(3)], axis=1)
            for v in (self.sigma_s_prime, self.sigma_a)
        )


def set_material(engine: Engine, path: Path) -> None:
    """Give an engine the coefficients of a volume on all its levels. Raises InputError as `read`."""
    volume = read(path)
    levels = engine.graph.levels
    corners = np.asarray(levels[0].vertices, np.float64)
    centre = (corners.min(axis=0) + corners.max(axis=0)) / 2
    for number, level in enumerate(levels):
        found = volume.at(np.asarray(level.nodes, np.float64), centre)
        engine.set_optical(number, *(values.astype(np.float32) for values in found), volume.eta)


def read(path: Path) -> Volume:
    """Read `sigma_s_prime` and `sigma_a`, (nz, ny, nx) or (nz, ny, nx, 3) in 1/mm, and `spacing`, one number or three
    in mm along x, y, z; `origin`, the middle of the first cell in mm, and `eta` if they are there.

    Raises InputError naming file, field, what was found and what is allowed.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            fields = {name: file[name] for name in file.files}
    except (OSError, ValueError, zipfile.BadZipFile) as error:
        raise InputError(f"{path}: cannot be read as .npz: {error}") from error
    for name in fields:
        if name not in _FIELDS:
            raise InputError(f"{path}: {name}: not known; allowed are {', '.join(_FIELDS)}")
    scattering, absorption = (_coefficient(path, name, fields) for name in _COEFFICIENTS)
    if scattering.shape != absorption.shape:
        shapes = f"{scattering.shape[:3]} and {absorption.shape[:3]}"
        raise InputError(f"{path}: sigma_s_prime and sigma_a: shapes {shapes} found, the same are wanted")
    spacing = _numbers(path, "spacing", fields, (1, 3))
    if not (spacing > 0).all():
        raise InputError(f"{path}: spacing: {spacing.tolist()} found, more than 0 mm allowed")
    origin = _numbers(path, "origin", fields, (3,)) if "origin" in fields else None
    eta = float(_numbers(path, "eta", fields, (1,))[0]) if "eta" in fields else DEFAULT_ETA
    if not 1 <= eta <= 3:
        raise InputError(f"{path}: eta: {eta:g} found, 1 to 3 allowed")
    return Volume(scattering, absorption, np.broadcast_to(spacing, 3), origin, eta)


def _coefficient(path: Path, name: str, fields: dict[str, np.ndarray]) -> np.ndarray:
    values = _field(path, name, fields)
    if values.ndim not in (3, 4) or 0 in values.shape or (values.ndim == 4 and values.shape[3] != 3):
        raise InputError(f"{path}: {name}: shape {values.shape} found, (nz, ny, nx) or (nz, ny, nx, 3) wanted")
    if not (np.isfinite(values) & (values >= 0)).all():
        raise InputError(f"{path}: {name}: negative or not finite somewhere, numbers >= 0 (1/mm) allowed")
    return values if values.ndim == 4 else np.repeat(values[..., None], 3, axis=3)


def _numbers(path: Path, name: str, fields: dict[str, np.ndarray], counts: tuple[int, ...]) -> np.ndarray:
    values = np.atleast_1d(_field(path, name, fields))
    if values.ndim != 1 or len(values) not in counts or not np.isfinite(values).all():
        wanted = " or ".join(map(str, counts))
        raise InputError(f"{path}: {name}: {values.tolist()} found, {wanted} finite number(s) wanted")
    return values


def _field(path: Path, name: str, fields: dict[str, np.ndarray]) -> np.ndarray:
    if name not in fields:
        raise InputError(f"{path}: {name}: not there; {', '.join((*_COEFFICIENTS, 'spacing'))} are wanted")
    if fields[name].dtype.kind not in "fiu":
        raise InputError(f"{path}: {name}: {fields[name].dtype} found, numbers wanted")
    return np.asarray(fields[name], np.float64)
