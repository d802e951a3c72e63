"""What fills the body of a scene that is photographed, for walks and for the truth beside a capture."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph import core
from quadgraph.api.coefficients import MOST_CELLS, grid_of
from quadgraph.base.errors import InputError
from quadgraph.file import npz
from quadgraph_validation.truth.walk_kernel import WalkVolume

_ALLOWED = "allowed are one material throughout, a pattern and a volume, .npz"
_OF_PERIOD = 1 / 30  # of a pattern's period: cells that walks find it in


@dataclass(frozen=True, eq=False)
class KnownMaterial:
    """Coefficients (nz, ny, nx, 3), 1/mm, at points `first` + index * `spacing` (x, y, z), mm, linear between, nearest
    beside; one cell is the same everywhere. eta: index of refraction inside over outside; file: of a volume; text: of
    a pattern.
    """

    sigma_s_prime: np.ndarray
    sigma_a: np.ndarray
    eta: float
    first: np.ndarray
    spacing: np.ndarray
    file: Path | None = None
    text: str = ""

    @staticmethod
    def even(sigma_s_prime: np.ndarray, sigma_a: np.ndarray, eta: float) -> KnownMaterial:
        """One material throughout, (3,) each."""
        scattering, absorption = (np.asarray(each, np.float64)[None, None, None] for each in (sigma_s_prime, sigma_a))
        return KnownMaterial(scattering, absorption, eta, np.zeros(3), np.ones(3))

    def in_channel(self, channel: int) -> WalkVolume:
        """One channel, for walks."""
        arrays = (self.sigma_s_prime, self.sigma_a)
        scattering, absorption = (np.ascontiguousarray(each[..., channel], np.float64) for each in arrays)
        majorant = float((scattering + absorption).max())
        return WalkVolume(scattering, absorption, self.first, self.spacing, majorant)

    def stated(self, folder: Path) -> dict[str, Any]:
        """What a file in a folder says of it: coefficients, or where the volume is; and eta."""
        if self.file:
            return {"material": os.path.relpath(self.file, folder), "eta": self.eta}
        if self.text:
            return {"material": self.text, "eta": self.eta}
        names = ("sigma_a", "sigma_s_prime")
        return {name: getattr(self, name)[0, 0, 0].tolist() for name in names} | {"eta": self.eta}


def of_scene(path: Path, scene: core.Scene) -> KnownMaterial:
    """The material of a scene that was read from `path`. Raises InputError for edits, layers, patterns that are too
    fine, and wrong volumes.
    """
    if json.loads(scene.json()).get("edits"):
        raise InputError(f"{path}: /edits: found, {_ALLOWED}; leave the edits out")
    if named := core.volume_name(scene.material):
        file, how = named
        return _mapped(Path(file), how, Path(scene.body)) if how else _volume(Path(file), Path(scene.body))
    members = json.loads(core.material_json(scene.material))
    if members["pattern"] == "layers":
        raise InputError(f"{path}: /material: pattern 'layers' found, {_ALLOWED}; make it a volume")
    if members["pattern"] != "none":
        return _pattern(path, scene, float(members["period"]))
    found = core.Material(scene.material)
    return KnownMaterial.even(np.array(found.sigma_s_prime), np.array(found.sigma_a), float(found.eta))


def _pattern(path: Path, scene: core.Scene, period: float) -> KnownMaterial:
    """A pattern at points as close as it wants, around the body. Raises InputError where these are too many."""
    vertices, material = core.load(scene.body).levels[0].vertices, core.Material(scene.material)
    box, spacing = np.array([vertices.min(axis=0), vertices.max(axis=0)], np.float64), period * _OF_PERIOD
    if np.prod(np.ceil(np.ptp(box, axis=0) / spacing) + 1) > MOST_CELLS:
        least = float(np.cbrt(np.prod(np.ptp(box, axis=0)) / MOST_CELLS)) / _OF_PERIOD
        raise InputError(f"{path}: /material: a period of {period:.4g} mm found, at least about {least:.3g} mm allowed "
                         "in a body of this size; take a longer one, or a smaller body")  # fmt: skip
    found = grid_of(lambda points: core.material_at(material, points, np.zeros(len(points))), box, spacing)
    return KnownMaterial(*found, float(material.eta), box[0], np.full(3, spacing), text=scene.material)


def _volume(file: Path, body: Path) -> KnownMaterial:
    """A file as the engine allows it, and from there on as docs/scene.md has it. Raises InputError."""
    eta = float(core.Volume(file).eta)  # complains of all that is wrong
    arrays = npz.read(file, ("sigma_s_prime", "sigma_a", "spacing", "origin"))
    scattering, absorption = (_in_channels(arrays[name]) for name in ("sigma_s_prime", "sigma_a"))
    spacing = np.array(np.broadcast_to(np.asarray(arrays["spacing"], np.float64).ravel(), 3))
    if "origin" in arrays:
        first = np.asarray(arrays["origin"], np.float64)
    else:
        vertices = core.load(body).levels[0].vertices.astype(np.float64)
        last = np.array(scattering.shape[2::-1]) - 1
        first = (vertices.min(axis=0) + vertices.max(axis=0) - spacing * last) / 2
    return KnownMaterial(scattering, absorption, eta, first, spacing, file)


def _mapped(file: Path, how: str, body: Path) -> KnownMaterial:
    """A volume as a map carries it into a body. Raises InputError, FormatError."""
    made, _ = core.Volume(file).mapped(core.load(body), how)
    members = made.members
    scattering, absorption = (np.asarray(members[name], np.float64) for name in ("sigma_s_prime", "sigma_a"))
    first, spacing = (np.array(each, np.float64) for each in (members["origin"] or (0, 0, 0), members["spacing"]))
    return KnownMaterial(scattering, absorption, float(made.eta), first, spacing, text=f"{file},map={how}")


def _in_channels(values: np.ndarray) -> np.ndarray:
    return values if values.ndim == 4 else np.broadcast_to(values[..., None], (*values.shape, 3))
