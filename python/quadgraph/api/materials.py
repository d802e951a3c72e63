"""Materials: two coefficients per channel and an index of refraction, everywhere, by a pattern, or on a grid.

The named ones are measured [Jensen et al. 2001, Figure 5] or made up to look like their stone, wood or wax.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from quadgraph import core
from quadgraph.api.coefficients import Box, Coefficients, grid_of
from quadgraph.api.reprs import members_text, text, with_unit
from quadgraph.api.values import RGB, Floats, Vector, plain
from quadgraph.api.volume_map import MapReport, VolumeMap
from quadgraph.base.atomic_file import replacing
from quadgraph.base.certainty import CERTAINTY
from quadgraph.base.errors import InputError
from quadgraph.base.units import DEFAULT_ETA

PatternName: TypeAlias = Literal["none", "veins", "clouds", "bands", "rings", "spots", "checker", "layers"]


@dataclass(frozen=True, repr=False)
class Material:
    """Coefficients, 1/mm: one number, or red, green, blue. Where one is wanted, the text of --material does as well.

    sigma_s_prime: reduced scattering; sigma_a: absorption, both >= 0; eta: index of refraction inside over outside, 1
    to 3. pattern: mixes in the second set, with `period` mm from one vein, band, ... to the next (of layers, the depth
    of the upper one) and a sharpness from 1 to 1000. roughness: of the surface, GGX alpha, where a picture says none;
    None is 0.3. g, second_g: mean cosines of the angle by which light scatters, above -1 and below 1, that the
    sigma_s_prime were reduced by, where they are known: solvers do without, walks of `certify` go by them. coat: share
    of the surface that lies under a clear layer of index coat_eta and roughness coat_roughness. Raises InputError.
    """

    sigma_s_prime: RGB
    sigma_a: RGB
    eta: float = DEFAULT_ETA
    pattern: PatternName = "none"
    second_sigma_s_prime: RGB | None = None
    second_sigma_a: RGB | None = None
    period: float | None = None
    sharpness: float | None = None
    roughness: float | None = None
    g: RGB | None = None
    second_g: RGB | None = None
    coat: float | None = None
    coat_eta: float | None = None
    coat_roughness: float | None = None

    def __post_init__(self) -> None:
        """Check, and make numbers plain. Raises InputError."""
        for each in fields(self):
            object.__setattr__(self, each.name, plain(getattr(self, each.name)))
        core.material_json(self.text)

    def __repr__(self) -> str:
        """Return name and members in one line, with their units."""
        return members_text(self)

    @staticmethod
    def parse(text: str) -> Material:
        """Return the material of a text as --material takes it: a name of `material_names`, numbers, or both.

        A file of a volume is not one. Raises InputError.
        """
        return Material(**json.loads(core.material_json(text)))

    @staticmethod
    def from_colour(reflectance: RGB, mean_free_path: RGB, eta: float = DEFAULT_ETA) -> Material:
        """Return the material that shows a colour where it is thick.

        reflectance: of white light, 0 to below 1; mean_free_path: 1 / sigma_t, mm. Raises InputError.
        """
        return Material.parse(_text(reflectance=reflectance, mean_free_path=mean_free_path, eta=eta))

    @staticmethod
    def from_phase_function(sigma_s: RGB, g: RGB, sigma_a: RGB, eta: float = DEFAULT_ETA) -> Material:
        """Return the material that is similar to one which scatters forwards (docs/physics.md, "Similarity relation").

        sigma_s, sigma_a: 1/mm, >= 0; g: the mean cosine of scattering, above -1 and below 1. Raises InputError.
        """
        return Material.parse(_text(sigma_s=sigma_s, g=g, sigma_a=sigma_a, eta=eta))

    @property
    def text(self) -> str:
        """The text as --material takes it."""
        return _text(**{each.name: getattr(self, each.name) for each in fields(self)})


def _text(**members: object) -> str:
    """What --material takes, of those members that are given."""
    return ",".join(f"{name}={_numbers(value)}" for name, value in members.items() if value is not None)


def _numbers(value: object) -> str:
    value = plain(value)
    return "/".join(map(str, value)) if isinstance(value, tuple) else str(value)


@dataclass(frozen=True, eq=False, repr=False)
class VolumeMaterial:
    """Coefficients at the middles of the cells of a grid, linear between them.

    sigma_s_prime, sigma_a: (nz, ny, nx) or (nz, ny, nx, 3), 1/mm, >= 0; spacing: of cells along x, y, z, mm, or one
    number; origin: of the first cell's middle, mm, None centres the grid on the body; eta: 1 to 3. Beside the grid the
    nearest cell counts. sigma_s_prime_deviation, sigma_a_deviation: standard deviations of the coefficients'
    logarithms, and sigma_s_prime_resolution, sigma_a_resolution: over which lengths they are one number, mm; of their
    shapes; `quadgraph acquire` writes them, and a picture shows them on a plane (`show` of `PictureOptions`). Raises
    InputError.
    """

    sigma_s_prime: npt.NDArray[np.floating]
    sigma_a: npt.NDArray[np.floating]
    spacing: float | Vector
    origin: Vector | None = None
    eta: float = DEFAULT_ETA
    sigma_s_prime_deviation: npt.NDArray[np.floating] | None = None
    sigma_a_deviation: npt.NDArray[np.floating] | None = None
    sigma_s_prime_resolution: npt.NDArray[np.floating] | None = None
    sigma_a_resolution: npt.NDArray[np.floating] | None = None

    def __post_init__(self) -> None:
        """Check shapes and numbers. Raises InputError."""
        shapes = [np.shape(self.sigma_s_prime)[:3], np.shape(self.sigma_a)[:3]]
        if shapes[0] != shapes[1]:
            raise InputError(f"sigma_s_prime and sigma_a: shapes {shapes[0]} and {shapes[1]}, the same are wanted")
        for name in ("sigma_s_prime", "sigma_a"):
            cells = self._cells(name)
            if not (np.isfinite(cells).all() and (cells >= 0).all()):
                raise InputError(f"{name}: negative or not finite somewhere, numbers >= 0 (1/mm) allowed")
        for name in CERTAINTY:
            coefficient, stated = name.rpartition("_")[0], getattr(self, name)
            if stated is None:
                continue
            wanted = np.shape(getattr(self, coefficient))
            if np.shape(stated) != wanted:
                raise InputError(f"{name}: shape {np.shape(stated)} found, that of {coefficient}, {wanted}, wanted")
            if not (np.asarray(stated) >= 0).all():
                raise InputError(f"{name}: negative or no number somewhere, numbers >= 0 allowed")
        if not (np.asarray(self.spacing) > 0).all() or np.shape(self.spacing) not in ((), (3,)):
            raise InputError(f"spacing: {self.spacing} found, one number or three above 0 (mm) allowed")
        if not 1 <= self.eta <= 3:
            raise InputError(f"eta: {self.eta} found, 1 to 3 allowed")

    def __repr__(self) -> str:
        """Return cells and ranges in one line, with their units."""
        size = " x ".join(map(str, np.shape(self.sigma_a)[2::-1]))
        ranges = ", ".join(
            f"{name}={np.min(values):.4g} to {np.max(values):.4g} 1/mm"
            for name, values in (("sigma_s_prime", self.sigma_s_prime), ("sigma_a", self.sigma_a))
        )
        return f"VolumeMaterial({size} cells of {with_unit('spacing', self.spacing)}, {ranges}, eta={text(self.eta)})"

    @classmethod
    def from_function(
        cls, function: Coefficients, box: Box, spacing: float | Vector, eta: float = DEFAULT_ETA
    ) -> VolumeMaterial:
        """Sample a function of position on a grid.

        function: given points of the body at rest, (n, 3) float32 mm, returns sigma_s_prime and sigma_a, 1/mm, each one
        number, (n,), (n, 3), or (3,) for all points; box: the lowest and the highest corner, mm, as `Engine.box` has
        them; spacing: of the samples, mm, the first at the lowest corner: a step of the function is smeared over as
        much. `Engine.set_coefficients` samples at the middles of the tets instead. Raises InputError, also where the
        grid would have more than 11,184,810 cells.
        """
        scattering, absorption = grid_of(function, box, spacing)
        low = tuple(float(each) for each in np.asarray(box, float)[0])
        return cls(scattering, absorption, spacing, low, eta)

    @classmethod
    def load(cls, path: str | Path) -> VolumeMaterial:
        """Read the .npz that `save` and `quadgraph acquire` write. Raises InputError naming file, field and allowed."""
        return cls(**core.Volume(Path(path)).members)

    def mapped(self, body: str | Path, how: VolumeMap | str) -> tuple[VolumeMaterial, MapReport]:
        """Carry it into another body, and say how well that went.

        body: a baked .qgraph; how: a `VolumeMap`, or its text as --map takes it. Raises InputError where the map does
        not fit, FormatError.
        """
        text = how.text if isinstance(how, VolumeMap) else how
        made, report = self._compiled().mapped(core.load(Path(body)), text)
        return VolumeMaterial(**made.members), MapReport(**report)

    def _compiled(self) -> core.Volume:
        spacing = np.broadcast_to(np.asarray(self.spacing, float), 3).tolist()
        origin = None if self.origin is None else np.asarray(self.origin, float).tolist()
        certainty = {name: self._cells(name) for name in CERTAINTY if getattr(self, name) is not None}
        return core.Volume(self._cells("sigma_s_prime"), self._cells("sigma_a"), spacing, origin, self.eta, certainty)

    def _cells(self, name: str) -> Floats:
        """One of the coefficients as (nz, ny, nx, 3). Raises InputError."""
        array = np.asarray(getattr(self, name), np.float32)
        if array.ndim == 3:
            array = np.repeat(array[..., None], 3, axis=3)
        if array.ndim != 4 or array.shape[3] != 3 or array.size == 0:
            raise InputError(f"{name}: shape {array.shape} found, (nz, ny, nx) or (nz, ny, nx, 3) wanted")
        return array

    def save(self, path: str | Path) -> None:
        """Write the .npz file that --material and scene files take. Raises InputError if it cannot be written."""
        members = {each.name: getattr(self, each.name) for each in fields(self)}
        arrays: dict[str, Any] = {name: np.asarray(value) for name, value in members.items() if value is not None}
        with replacing(Path(path)) as stream:
            np.savez(stream, **arrays)

    def set_on(self, engine: core.Engine) -> None:
        """Give it to the compiled engine. Raises InputError."""
        core.set_volume(engine, self._compiled())


def material_names() -> tuple[str, ...]:
    """Return the names that `Material.parse` and --material know."""
    return tuple(core.material_names())
