"""How fast light falls inside materials that a bake is told of, and over which lengths they change."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from quadgraph import core
from quadgraph.mesh.surface import Surface
from quadgraph.tets.interior import Depths, mean_chord

_Array = npt.NDArray[np.floating[Any]]

_SHARES = (0.01, 0.25, 0.5, 0.75, 0.99)  # of a volume's cells, whose rates are asked for
_WAYS, _STEPS = 400, 200  # straight into the body, on which a material is looked at
_AS_MUCH = math.e  # by which a coefficient has changed, where it does not by so much in all of the body


def opened(material: str) -> str | core.Volume:
    """Read the .npz of a volume, which both functions below take as well as its name. Raises InputError.

    A map behind the name, which wants a baked body, is left out: the coefficients are the same elsewhere.
    """
    named = core.volume_name(material)
    return core.Volume(Path(named[0])) if named else material


def decay_rates(material: str | core.Volume) -> tuple[float, ...]:
    """Rates, 1/mm, at which light falls in a material, smallest first, each once; none where there is nothing.

    material: as of --material, `skin1`, `sigma_s_prime=2.0,sigma_a=0.01/0.02/0.05` or the .npz of a volume, of whose
    cells there are some. Raises InputError.
    """
    material = opened(material) if isinstance(material, str) else material
    if isinstance(material, core.Volume):
        of_cells = np.quantile(falling(*material.cells), _SHARES, axis=0)
        return tuple(sorted({float(rate) for rate in of_cells.ravel() if rate > 0}))
    members = json.loads(core.material_json(material))
    rates: set[float] = set()
    for prefix in ("", "second_"):
        two = (_three(members.get(prefix + name)) for name in ("sigma_s_prime", "sigma_a"))
        for s, a in zip(*two, strict=True):
            if s + a > 0:
                rates.add(float(falling(s, a)))
    return tuple(sorted(rates))


def is_even(material: str | core.Volume) -> bool:
    """Whether it is the same everywhere, by its text: a volume is not, whatever its cells hold. Raises InputError."""
    return isinstance(material, str) and json.loads(core.material_json(material))["pattern"] == "none"


def change_length(material: str | core.Volume, surface: Surface) -> float:
    """Mean way, mm, on which a material changes once in a body; infinite where it is the same everywhere.

    Extinction and the rate at which light falls count, of the channel that changes most: once is from the least to the
    most of the body, but by e at least, so that a slight change counts little. Raises InputError as `decay_rates`.
    """
    material = opened(material) if isinstance(material, str) else material
    if is_even(material):
        return math.inf
    longest = 0.75 * mean_chord(surface)
    ways = _ways(surface, longest)
    scattering, absorption = coefficients(material, surface, ways.reshape(-1, 3))
    spread = 2 / (1.5 * mean_chord(surface))
    found = scattering + absorption, np.hypot(falling(scattering, absorption), spread)
    logarithms = np.log(np.maximum(np.concatenate(found, axis=1), 1e-6)).reshape(*ways.shape[:2], -1)
    whole = np.maximum(np.ptp(logarithms, axis=(0, 1)), math.log(_AS_MUCH))
    changes = np.abs(np.diff(logarithms, axis=1)).sum(axis=1).mean(axis=0) / whole
    most = float(changes.max())
    return longest / most if most > 0 else math.inf


def _ways(surface: Surface, longest: float) -> _Array:
    """(ways, steps, 3) mm: points on straight ways in, from the middles of triangles of each other place."""
    step = max(1, len(surface.triangles) // _WAYS)
    corners, normals = surface.corners[::step], surface.doubled_normals[::step]
    inward = -normals / np.linalg.norm(normals, axis=1, keepdims=True)
    along = longest * (np.arange(_STEPS) + 0.5) / _STEPS
    return corners.mean(axis=1)[:, None] + along[:, None] * inward[:, None]


def coefficients(
    material: str | core.Volume, surface: Surface, points: _Array, on_surface: bool = False
) -> tuple[_Array, _Array]:
    """sigma_s_prime and sigma_a (n, 3), 1/mm, at points (n, 3), mm, in a body of that surface or on it."""
    if isinstance(material, core.Volume):
        return material.at(points, (surface.vertices.min(axis=0) + surface.vertices.max(axis=0)) / 2)
    by_depth = not on_surface and json.loads(core.material_json(material))["pattern"] == "layers"
    depths = Depths(surface).at(points)[0] if by_depth else np.zeros(len(points))
    return core.material_at(core.Material(material), points, depths)


def falling(scattering: npt.ArrayLike, absorption: npt.ArrayLike) -> _Array:
    """Rate, 1/mm, at which light falls; no faster than what is not scattered: diffusion says more in dark media."""
    s, a = np.asarray(scattering, np.float64), np.asarray(absorption, np.float64)
    return np.minimum(np.sqrt(3 * a * (s + a)), s + a)


def _three(value: float | list[float] | None) -> list[float]:
    if value is None:
        return []
    return list(value) if isinstance(value, list | tuple) else [value] * 3
