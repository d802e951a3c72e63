"""What a body answers to light as a function of what it is made of, with exact derivatives."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from quadgraph import core
from quadgraph.api.values import Doubles, numbers
from quadgraph.base.errors import InputError


class Views(NamedTuple):
    """Rays that leave a body, along which radiance is wanted.

    face: (n,), outside faces of the level; direction: (n, 3), unit, from the body to the eye; barycentric: (n, 3),
    where on its face each starts.
    """

    face: npt.ArrayLike
    direction: npt.ArrayLike
    barycentric: npt.ArrayLike


class Outgoing(NamedTuple):
    """Light that leaves a body, or its derivative along a direction; float64.

    exitance: (n_f, 3) W/mm^2, of light that was scattered; unscattered: (n_f, 3) W/mm^2, of light that was not; both
    per outside face of the level; radiance: (n, 3) W/(mm^2 sr), of scattered light, per ray of `Views`.
    """

    exitance: Doubles
    unscattered: Doubles
    radiance: Doubles


class Gradient(NamedTuple):
    """The derivatives of one number by all that a body and its light are; float64.

    sigma_s_prime and sigma_a: (n_t, 3), by those of every tet of the level, per 1/mm; power: (beams, 3), by the factor
    of every beam that the light is made of.
    """

    sigma_s_prime: Doubles
    sigma_a: Doubles
    power: Doubles


class ForwardModel:
    """Outgoing light of one level as a function of coefficients and powers, in double precision on the processor.

    The function is the solve by linear elements with buried source and inter-reflection, and gathered radiance, without
    the transport correction and what is done for display (docs/physics.md, "Derivatives"). `Engine.forward_model` makes
    one. Where it was solved: sigma_s_prime and sigma_a (n_t, 3) 1/mm, power (beams, 3), factors. Its mesh: vertices
    (n_v, 3) mm, tets (n_t, 4), faces (n_f, 3), counter-clockwise from outside. entering: (n_f, 3) W/mm^2 that lights
    send into each face. bounces: whether light that leaves one part and enters another is in it.
    """

    def __init__(self, model: core.ForwardModel, level: core.Level, bounces: bool) -> None:
        """Take what `Engine.forward_model` made."""
        self._model = model
        self.bounces = bounces
        self.vertices, self.tets, self.faces = (np.array(each) for each in (level.vertices, level.tets, level.faces))
        self.outgoing = Outgoing(*model.outgoing)
        self.entering = model.entering
        self._parameters = Gradient(*model.parameters)
        self.sigma_s_prime, self.sigma_a, self.power = self._parameters

    def __repr__(self) -> str:
        """Return the sizes in one line."""
        exitance, _, radiance = self.outgoing
        sizes = f"{len(self.sigma_a):,} tets to {len(exitance):,} faces and {len(radiance):,} rays"
        return f"ForwardModel({sizes}, {'with' if self.bounces else 'without'} inter-reflection)"

    def jvp(
        self,
        sigma_s_prime: npt.ArrayLike | None = None,
        sigma_a: npt.ArrayLike | None = None,
        power: npt.ArrayLike | None = None,
    ) -> Outgoing:
        """Return J v: how outgoing light changes along a direction, of shapes as in `Gradient`; what is left out is 0.

        Raises InputError for another shape, SolverError where a solve does not end.
        """
        own = zip(Gradient._fields, (sigma_s_prime, sigma_a, power), self._parameters, strict=True)
        return Outgoing(*self._model.tangent(*(_like(name, along, at) for name, along, at in own)))

    def vjp(
        self,
        exitance: npt.ArrayLike | None = None,
        unscattered: npt.ArrayLike | None = None,
        radiance: npt.ArrayLike | None = None,
        only_operator: bool = False,
    ) -> Gradient:
        """Return J^T w: the derivatives of the sum of `outgoing` times weights of its shapes; what is left out is 0.

        only_operator: hold the light that enters and what view rays meet on their way fixed, as the continuous adjoint
        equation of inverse diffusion does [PG Eq. 5 to 7]; that is not the gradient of what is computed. Raises
        InputError for another shape, SolverError where a solve does not end.
        """
        own = zip(Outgoing._fields, (exitance, unscattered, radiance), self.outgoing, strict=True)
        out, straight, seen = (_like(name, weight, light) for name, weight, light in own)
        return Gradient(*self._model.adjoint(out, straight, seen, only_operator))


def forward_model(
    engine: core.Engine,
    level: int,
    parameters: tuple[npt.ArrayLike | None, npt.ArrayLike | None, npt.ArrayLike | None],
    views: Views | None,
    model: str,
    bounces: bool | None,
    tolerance: float,
) -> ForwardModel:
    """Make what `Engine.forward_model` returns. Raises as it does."""
    levels = engine.graph.levels
    if not 0 <= level < len(levels):
        raise InputError(f"level: {level} found, 0 to {len(levels) - 1} allowed")
    if not 0 < tolerance < 1:
        raise InputError(f"tolerance: {tolerance:g} found, allowed is more than 0 and less than 1")
    own = [number for number, each in enumerate(levels) if len(each.seen) > len(each.faces) + 1]
    if bounces and own and level not in own:
        known = f"level {own[0]} of the file knows what its faces see"
        raise InputError(f"bounces: {known}, not level {level}; False is allowed")
    rays = views or Views([], np.empty((0, 3)), np.empty((0, 3)))
    face = numbers("views: face", rays.face, "(n,) is wanted")
    if face.ndim != 1 or (face < 0).any():
        raise InputError(f"views: face: shape {face.shape} found, (n,) of numbers from 0 on is wanted")
    tets = len(levels[level].tets), 3
    scattering, absorption, power = (
        None if values is None else _as_doubles(name, values, shape)  # of beams, the engine knows how many
        for name, values, shape in zip(Gradient._fields, parameters, (tets, tets, None), strict=True)
    )
    places = _as_doubles("views: barycentric", rays.barycentric, (len(face), 3))
    ways = _as_doubles("views: direction", rays.direction, (len(face), 3))
    rays_in = face.astype(np.uint32), places, ways
    point = scattering, absorption, power
    found = core.ForwardModel(engine, level, *point, *rays_in, model, bounces is not False, tolerance)
    return ForwardModel(found, levels[level], bounces is not False and level in own)


def _like(name: str, values: npt.ArrayLike | None, other: Doubles) -> Doubles:
    return np.zeros(other.shape) if values is None else _as_doubles(name, values, (len(other), 3))


def _as_doubles(name: str, values: npt.ArrayLike, shape: tuple[int, int] | None) -> Doubles:
    array = numbers(name, values, f"{shape or '(beams, 3)'} is wanted").astype(np.float64)
    if shape is not None and array.shape != shape:
        raise InputError(f"{name}: shape {array.shape} found, {shape} is wanted")
    if not np.isfinite(array).all():
        raise InputError(f"{name}: numbers that are not finite")
    return array
