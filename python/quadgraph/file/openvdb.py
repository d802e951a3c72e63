"""Volumes of coefficients from OpenVDB files, and into them.

The library is another program's business: a Python that has its module reads and writes the .vdb, under limits, and we
exchange dense arrays with it. Nothing of QuadGraph needs it otherwise.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph.base.atomic_file import replacing
from quadgraph.base.certainty import CERTAINTY
from quadgraph.base.child_process import Program, run, workspace
from quadgraph.base.errors import InputError, ToolError
from quadgraph.base.units import DEFAULT_ETA
from quadgraph.file import npz

_CHILD = Path(__file__).with_name("openvdb_child.py")
_TIME_LIMIT_S, _MEMORY_LIMIT_BYTES = 300.0, 4 << 30
COEFFICIENTS = ("sigma_s_prime", "sigma_a")
_STATED = ("deviation", "resolution")  # after the name of a grid
_MEMBERS = (*COEFFICIENTS, "spacing", "origin", "eta", *CERTAINTY)
_REFUSED = 2  # its exit status where a file does not serve


class _Interpreter(Program):
    """A Python with OpenVDB's module: ours, Debian's, or the one that the environment names."""

    def path(self) -> Path:
        for candidate in (os.environ.get(self.environment or ""), sys.executable, "/usr/bin/python3"):
            if candidate and _has_module(candidate):
                return Path(candidate)
        raise ToolError(f"{self.name}: not found; {self.source} (or set {self.environment} to a Python that has it)")


def _has_module(python: str) -> bool:
    find = "from importlib.util import find_spec as f; raise SystemExit(not (f('openvdb') or f('pyopenvdb')))"
    try:
        return subprocess.run([python, "-I", "-c", find], capture_output=True, timeout=60).returncode == 0
    except (OSError, subprocess.TimeoutExpired):
        return False


OPENVDB = _Interpreter(
    "OpenVDB's Python module",
    "install Debian's package python3-openvdb: apt install python3-openvdb",
    "QUADGRAPH_OPENVDB_PYTHON",
)


@dataclass(frozen=True)
class Field:
    """A coefficient as a grid times a factor (3,), 1/mm where the grid is 1; or where `grid` is None, the factor."""

    grid: str | None
    factor: np.ndarray


@dataclass(frozen=True)
class Volume:
    """sigma_s_prime, sigma_a (nz, ny, nx) or (nz, ny, nx, 3), 1/mm; spacing, origin (3,), mm; as a material's .npz.

    Deviations are those of the logarithms, resolutions are lengths in mm, of the coefficients' shapes, or None where
    they are not known.
    """

    sigma_s_prime: np.ndarray
    sigma_a: np.ndarray
    spacing: np.ndarray
    origin: np.ndarray
    eta: float
    sigma_s_prime_deviation: np.ndarray | None = None
    sigma_a_deviation: np.ndarray | None = None
    sigma_s_prime_resolution: np.ndarray | None = None
    sigma_a_resolution: np.ndarray | None = None

    def write(self, path: Path) -> None:
        """Write the .npz atomically. Raises InputError."""
        with replacing(path) as stream:
            np.savez_compressed(stream, **self.members())

    def members(self) -> dict[str, Any]:
        """The members of the .npz, without what is not known."""
        return {name: value for name, value in vars(self).items() if value is not None}


def read(path: Path, sigma_s_prime: Field, sigma_a: Field, *, unit_mm: float = 1.0, eta: float | None = None) -> Volume:
    """Read a .vdb, whose unit of length is `unit_mm`, on the box around what is active in the grids that are named.

    A grid NAME_deviation, where there is one, has the deviations of the logarithm of what comes from the grid NAME, and
    NAME_resolution its resolution lengths, in the file's unit: a factor leaves both as they are. `eta`: left out, what
    the file says, or the usual. Raises InputError naming the file, ToolError without the library.
    """
    fields = {"sigma_s_prime": sigma_s_prime, "sigma_a": sigma_a}
    names = [field.grid for field in fields.values() if field.grid is not None]
    if not names:
        raise InputError(f"{path}: a coefficient must come from one of its grids")
    beside = [f"{name}_{stated}" for name in names for stated in _STATED]
    with workspace() as directory:
        output = directory / "grids.npz"
        _run(path, ["read", str(_readable(path)), str(output), str(len(names)), *names, *beside], directory)
        with np.load(output) as stored:
            numbered = {name: f"grid{number}" for number, name in enumerate(names + beside)}
            grids = {name: stored[number] for name, number in numbered.items() if number in stored}
            spacing, origin = stored["spacing"] * unit_mm, stored["origin"] * unit_mm
            index = eta if eta is not None else float(stored["eta"]) if "eta" in stored else DEFAULT_ETA
    shape = next(iter(grids.values())).shape[:3]
    found = {name: _coefficient(path, name, field, grids, shape) for name, field in fields.items()}
    for name, field in fields.items():
        for stated, factor in zip(_STATED, (1.0, unit_mm), strict=True):
            if (values := grids.get(f"{field.grid}_{stated}")) is not None:
                found[f"{name}_{stated}"] = factor * _certainty(path, f"{field.grid}_{stated}", values, found[name])
    return Volume(**found, spacing=spacing, origin=origin, eta=index)


def write(source: Path, path: Path) -> list[str]:
    """Write the .npz of a material as grids of the names that it has, in mm, and return these. Raises as `read`."""
    volume = _stored(source)
    with replacing(path) as stream, workspace() as directory:
        given, made = directory / "arrays.npz", directory / "grids.vdb"
        turned: dict[str, Any] = {
            name: np.ascontiguousarray(np.swapaxes(values, 0, 2), np.float32)
            for name, values in volume.members().items()
            if name in (*COEFFICIENTS, *CERTAINTY)
        }
        np.savez(given, spacing=volume.spacing, origin=volume.origin, eta=volume.eta, **turned)
        _run(source, ["write", str(given), str(made)], directory)
        stream.write(made.read_bytes())
    return list(turned)


def _run(path: Path, arguments: list[str], directory: Path) -> None:
    done = run(OPENVDB, ["-I", str(_CHILD), *arguments], directory=directory, time_limit_s=_TIME_LIMIT_S,
               memory_limit_bytes=_MEMORY_LIMIT_BYTES, accept=(0, _REFUSED))  # fmt: skip
    if done.status == _REFUSED:
        raise InputError(f"{path}: {done.output.strip()}")


def _readable(path: Path) -> Path:
    try:
        with path.open("rb"):
            return path.resolve()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error


def _coefficient(path: Path, name: str, field: Field, grids: dict[str, np.ndarray], shape: Sequence[int]) -> np.ndarray:
    """(nz, ny, nx), or with colours (nz, ny, nx, 3), of arrays that have x first."""
    grey = bool(np.all(field.factor == field.factor[0]))
    values = np.ones(shape, np.float32) if field.grid is None else grids[field.grid]
    if values.ndim == 3 and not grey:
        values = values[..., None]
    values = values * (field.factor[0] if grey else field.factor)
    if not (np.all(np.isfinite(values)) and values.min() >= 0):
        raise InputError(f"{path}: {name} from grid '{field.grid}' is negative or not finite somewhere")
    return np.ascontiguousarray(np.swapaxes(values, 0, 2), np.float32)


def _certainty(path: Path, name: str, values: np.ndarray, coefficient: np.ndarray) -> np.ndarray:
    """Of an array that has x first, in the shape of its coefficient."""
    spread = np.swapaxes(values, 0, 2)
    if spread.ndim < coefficient.ndim:
        spread = np.repeat(spread[..., None], 3, axis=3)
    if spread.shape != coefficient.shape:
        raise InputError(f"{path}: grid '{name}': vec3s found, float is wanted, as its coefficient is")
    if not (spread >= 0).all():
        raise InputError(f"{path}: grid '{name}' is negative or no number somewhere")
    return np.ascontiguousarray(spread, np.float32)


def _stored(path: Path) -> Volume:
    try:
        arrays = npz.read(path, _MEMBERS)
        scattering, absorption = arrays["sigma_s_prime"], arrays["sigma_a"]
        spacing = np.broadcast_to(np.asarray(arrays["spacing"], np.float64).ravel(), 3)
        alike = scattering.shape[:3] == absorption.shape[:3]
        if not alike or not {scattering.ndim, absorption.ndim} <= {3, 4}:
            raise ValueError(f"shapes {scattering.shape} and {absorption.shape}")
        middle = -0.5 * spacing * (np.array(scattering.shape[2::-1]) - 1)
        origin = np.asarray(arrays.get("origin", middle), np.float64)
        spread = [arrays.get(name) for name in CERTAINTY]
        for stated, of in zip(spread, (scattering, absorption) * 2, strict=True):
            if stated is not None and stated.shape != of.shape:
                raise ValueError(f"deviations or lengths of shape {stated.shape} and coefficients of {of.shape}")
        return Volume(scattering, absorption, spacing, origin, float(arrays.get("eta", DEFAULT_ETA)), *spread)
    except (KeyError, ValueError, TypeError) as error:
        raise InputError(f"{path}: no volume of sigma_s_prime, sigma_a and spacing: {error}") from error
