"""What may be wrong with what a capture says of body, lights and cameras: each as another scene that is predicted."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from scipy import optimize

from quadgraph.acquisition.capture.capture import Capture
from quadgraph.acquisition.causes.bank import Bank, Otherwise
from quadgraph.acquisition.causes.suspects import Scope, Suspect
from quadgraph.acquisition.model.prediction import PLACES
from quadgraph.base.errors import InputError, SolverError

_VECTORS = (*PLACES, "direction", "u", "v")
_LENGTHS = (10.0, 0.1, 1000.0, 0.001)
_INDICES = (1.0, 1.2, 1.35, 1.5, 1.7)
_STEPS = 8  # of a search
_DIFFERENCE = 0.04  # of parameters, by which derivatives are taken
_TURN = 0.1  # the scale of parameters
_AS_GOOD = 1.7  # times the least cost, up to which an index fits about as well
_FREE = 1.3  # handicap of what is searched for
_ROUNDS = 2  # of such searches, with coefficients anew
_FAINTER = 6.0  # logarithm, of a room's light below that of lights
_ROOM = "room"
_AXES = "xyz"

Light = dict[str, Any]


def of_lights(bank: Bank) -> Iterator[Suspect]:
    """One light that is elsewhere, or shines elsewhere."""
    lights = bank.problem.capture.lights
    for name, scope in _lit(bank).items():
        for what, changed in _variants(lights[name]):
            otherwise = _under(bank, scope, {**lights, name: changed})
            if otherwise:
                text = f"lights.{name}: its photographs fit much better {what}; correct it"
                yield Suspect("light", otherwise, 1.0, text)


def of_places(bank: Bank) -> Iterator[Suspect]:
    """One light whose place is searched for, where other photographs know what the body is made of."""
    for name, scope in _lit(bank).items():
        place = next((member for member in PLACES if member in bank.problem.capture.lights[name]), None)
        if place and len(scope) < len(bank.seen):
            yield from _moved(bank, scope, name, place)


def _lit(bank: Bank) -> dict[str, Scope]:
    """Photographs under each light."""
    stated = [one.stated for one in bank.problem.measured]
    found = {
        name: tuple(n for n, each in enumerate(stated) if name in each.lights) for name in bank.problem.capture.lights
    }
    return {name: scope for name, scope in found.items() if scope}


def _variants(light: Light) -> Iterator[tuple[str, Light]]:
    """What is often wrong with a light, in words, and the light without it."""
    vectors = [name for name in _VECTORS if name in light]
    places = [name for name in (*PLACES, "u", "v") if name in light]
    for axis, letter in enumerate(_AXES) if vectors else ():
        yield f"with its {letter} reversed", _mirrored(light, axis)
    if vectors:
        swap = [0, 2, 1]
        exchanged = {name: [light[name][k] for k in swap] for name in vectors}
        yield "with its y and z exchanged", _facing(light | exchanged)
    if "direction" in light:
        yield (
            "shining the other way: `direction` is that in which light travels",
            light | {"direction": [-x for x in light["direction"]]},
        )
    for factor in _LENGTHS if places else ():
        lengths = {name: [factor * x for x in light[name]] for name in places}
        yield f"with its lengths times {factor:g}: they are in mm", light | lengths


def _mirrored(light: Light, axis: int) -> Light:
    """A light with one coordinate of all its vectors reversed."""
    sign = np.where(np.arange(3) == axis, -1.0, 1.0)
    return _facing(light | {name: (sign * light[name]).tolist() for name in _VECTORS if name in light})


def _facing(light: Light) -> Light:
    """A mirrored rectangle's edges exchanged, so that its light is mirrored, too."""
    return light | ({"u": light["v"], "v": light["u"]} if "u" in light else {})


def _under(bank: Bank, scope: Scope, lights: Mapping[str, Light]) -> dict[int, Otherwise]:
    """Photographs under other lights; nothing where the engine refuses those."""
    capture = bank.problem.capture
    some = replace(capture, lights=lights, photographs=tuple(bank.problem.measured[n].stated for n in scope))
    try:
        predictor = bank.predictor.of(some)
        if len(scope) < len(bank.seen):  # the others know what it is made of
            nodes = bank.constant(predictor, bank.coefficients({}, scope))
        else:
            nodes = bank.predicted(predictor, few=True)
    except (InputError, SolverError):
        return {}
    return {number: Otherwise(nodes=each) for number, each in zip(scope, nodes, strict=True)}


def _moved(bank: Bank, scope: Scope, name: str, member: str) -> Iterator[Suspect]:
    """A light whose place is searched for."""
    light = bank.problem.capture.lights[name]
    place = np.array(light[member], float)
    far = float(np.linalg.norm(place)) or 1.0

    def at(shift: np.ndarray) -> dict[int, Otherwise]:
        moved = light | {member: (place + far * shift).tolist()}
        return _under(bank, scope, {**bank.problem.capture.lights, name: moved})

    shift = _searched(bank, at, 3)
    if shift is not None:
        found = ", ".join(f"{x:.3g}" for x in place + far * shift)
        text = f"lights.{name}.{member}: its photographs fit much better with the light about [{found}] mm; measure it"
        yield Suspect("light", at(shift), _FREE, text)


def _searched(bank: Bank, otherwise: Callable[[np.ndarray], dict[int, Otherwise]], count: int) -> np.ndarray | None:
    """(count,) small parameters that fit best, from 0 on; None where none were found."""
    begin = otherwise(np.zeros(count))
    if not begin:
        return None

    def residuals(parameters: np.ndarray) -> np.ndarray:
        return bank.residuals(otherwise(parameters - 1) or begin)

    # About 1, since steps of differences are relative.
    found = optimize.least_squares(
        residuals, np.ones(count), loss="huber", f_scale=3.0, diff_step=_DIFFERENCE, x_scale=_TURN, max_nfev=_STEPS
    )
    return found.x - 1


def of_bodies(bank: Bank) -> Iterator[Suspect]:
    """A body that is mirrored or lies otherwise, cameras of another axis, another index of refraction."""
    capture = bank.problem.capture
    for name, camera in capture.cameras.items():
        other = "z" if camera.get("up", "y") == "y" else "y"
        scope = [n for n, one in enumerate(bank.problem.measured) if one.stated.camera == name]
        if scope:
            changed = {**capture.cameras, name: camera | {"up": other}}
            text = f"cameras.{name}.up: its photographs fit much better with {other} upwards; correct it"
            yield from _as(bank, replace(capture, cameras=changed), "up", text)
    for axis in range(3):
        yield from _mirror(bank, axis)
    for axis, letter in enumerate(_AXES):
        for degrees in (90, -90, 180):
            text = (
                f"deformation: photographs fit much better with the body turned by {degrees} degrees about its "
                f"{letter}; check the axes of the mesh, and its pose"
            )
            yield from _as(
                bank, _posed(capture, np.eye(3)[axis] * np.radians(degrees), np.zeros(3)), "turned body", text
            )
    yield from _indices(bank)


def _indices(bank: Bank) -> Iterator[Suspect]:
    """The index of refraction that fits best, with those that fit about as well."""
    capture = bank.problem.capture
    found = {eta: each for eta in _INDICES for each in _as(bank, replace(capture, eta=eta), "eta", "")}
    costs = {eta: bank.cost(each.otherwise) for eta, each in found.items()}
    if costs:
        best = min(costs, key=lambda eta: costs[eta])
        good = [eta for eta, cost in costs.items() if cost < _AS_GOOD * costs[best]]
        size = f"{good[0]:g}" if len(good) == 1 else f"{good[0]:g} to {good[-1]:g}"
        text = f"eta: found {capture.eta:g}, photographs fit much better with about {size}; look it up"
        yield replace(found[best], text=text)


def of_poses(bank: Bank) -> Iterator[Suspect]:
    """A body whose pose is searched for."""
    capture = bank.problem.capture
    size = bank.predictor.size_mm
    start = np.zeros(6)
    best: dict[int, Otherwise] = {}
    for _ in range(_ROUNDS):
        coefficients = bank.coefficients(best)

        def at(parameters: np.ndarray, base=start, coefficients=coefficients) -> dict[int, Otherwise]:
            whole = base + parameters
            try:
                predictor = bank.predictor.of(_posed(capture, whole[:3], size * whole[3:]))
                nodes = bank.constant(predictor, coefficients)
            except (InputError, SolverError):
                return {}
            return {number: Otherwise(nodes=each) for number, each in enumerate(nodes)}

        found = _searched(bank, at, 6)
        if found is None:
            return
        start = start + found
        posed = _posed(capture, start[:3], size * start[3:])
        best = {n: Otherwise(nodes=each) for n, each in enumerate(bank.predicted(bank.predictor.of(posed), few=True))}
    angle = float(np.linalg.norm(start[:3]))
    axis = ", ".join(f"{x:.2f}" for x in start[:3] / max(angle, 1e-12))
    moved = ", ".join(f"{x:.2g}" for x in size * start[3:])
    text = (
        f"deformation: photographs fit much better with the body turned by {np.degrees(angle):.0f} degrees about "
        f"[{axis}] and moved by [{moved}] mm; correct its pose, or how cameras and lights stand around it"
    )
    yield Suspect("pose", best, _FREE, text)


def _posed(capture: Capture, turn: np.ndarray, shift: np.ndarray) -> Capture:
    """The body turned about its middle by a rotation vector, rad, and moved, mm."""
    angle = float(np.linalg.norm(turn))
    axis = (turn / angle).tolist() if angle > 0 else [0.0, 1.0, 0.0]
    pose = {"type": "transform", "axis": axis, "degrees": float(np.degrees(angle)), "translate": shift.tolist()}
    return replace(capture, deformation=[*capture.deformation, pose])


def _as(bank: Bank, capture: Capture, kind: str, text: str) -> Iterator[Suspect]:
    """All photographs of another scene; nothing where the engine refuses it."""
    try:
        nodes = bank.predicted(bank.predictor.of(capture), few=True)
    except (InputError, SolverError):
        return
    yield Suspect(kind, {number: Otherwise(nodes=each) for number, each in enumerate(nodes)}, 1.0, text)


def _mirror(bank: Bank, axis: int) -> Iterator[Suspect]:
    """A mirrored body: what mirrored cameras and lights see of the body as it is, mirrored."""
    capture = bank.problem.capture
    sign = np.where(np.arange(3) == axis, -1.0, 1.0)
    if capture.deformation or any("file" in light for light in capture.lights.values()):
        return
    cameras = {}
    for name, camera in capture.cameras.items():
        if "eye" not in camera:
            return
        cameras[name] = camera | {member: (sign * camera[member]).tolist() for member in ("eye", "look_at")}
    lights = {name: _mirrored(light, axis) for name, light in capture.lights.items()}
    try:
        nodes = bank.predicted(bank.predictor.of(replace(capture, cameras=cameras, lights=lights)), few=True)
    except (InputError, SolverError):
        return
    otherwise = {}
    for number, (one, each) in enumerate(zip(bank.problem.measured, nodes, strict=True)):
        upright = _AXES[axis] != cameras[one.stated.camera].get("up", "y")
        otherwise[number] = Otherwise(nodes=each[:, :, ::-1] if upright else each[:, ::-1])
    text = (
        f"body: photographs fit much better with the body mirrored, its {_AXES[axis]} reversed; export the mesh with "
        "the handedness of the axes of cameras and lights"
    )
    yield Suspect("body", otherwise, 1.0, text)


def of_rooms(bank: Bank) -> Iterator[Suspect]:
    """Light from all sides in all photographs."""
    capture = bank.problem.capture
    lit = tuple(replace(one.stated, lights=(_ROOM,)) for one in bank.problem.measured)
    room = replace(capture, lights={_ROOM: {"type": "ambient", "irradiance": 1.0}}, photographs=lit)
    nodes = bank.predicted(bank.predictor.of(room))

    def at(size: float) -> dict[int, Otherwise]:
        pairs = zip(bank.nodes, nodes, strict=True)
        return {n: Otherwise(nodes=np.logaddexp(own, other + size)) for n, (own, other) in enumerate(pairs)}

    best = float(np.median([(own.max() - other.max()) for own, other in zip(bank.nodes, nodes, strict=True)]))
    found = optimize.minimize_scalar(
        lambda size: bank.cost(at(size)), bounds=(best - _FAINTER, best + 1), method="bounded", options={"maxiter": 12}
    )
    text = (
        f"photographs.lights: photographs fit much better with light from all sides, too, about {np.exp(found.x):.2g} "
        "W/mm^2: the light of a room was on; take photographs in the dark, or subtract one with the lights off"
    )
    yield Suspect("room", at(found.x), 1.15, text)
