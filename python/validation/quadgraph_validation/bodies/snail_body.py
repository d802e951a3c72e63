"""A snail, generated: what a material that was found in a block is carried onto."""

from __future__ import annotations

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph.mesh.surface import Surface
from quadgraph_validation.bodies.implicit import Field, capsule, least, meshed, valid

_HALF, _CELLS, _TRIANGLES = 26.0, 220, 40_000  # mm of half the box, cells along it
_TURNS, _STEPS = 3.0, 90  # of the shell's spiral


def snail() -> Surface:
    """A snail of 46 mm with its shell, mm, y up, its head towards +x. Raises InputError without scikit-image."""
    made = valid(meshed(_field(), _HALF, _CELLS), _TRIANGLES)
    if made is None:
        raise InputError("snail: no valid surface was found")
    return Surface(made.vertices * (2 * _HALF / (_CELLS - 1)) - _HALF, made.triangles).rounded()


def _field() -> Field:
    parts = [
        _limb((-21, -14.6, 0), (-6, -13.2, 0), 1.4, 3.6),
        _limb((-6, -13.2, 0), (12, -12.8, 0), 3.6, 3.8),
        _limb((12, -12.8, 0), (18.5, -3, 0), 3.8, 2.9),
        _limb((18.5, -3, 0), (20.5, -1.5, 0), 3.0, 2.6),
    ]
    for side in (-1, 1):
        parts += [_limb((19.5, -1, 1.2 * side), (21.5, 8, 4.2 * side), 0.9, 0.7), _ball((21.6, 8.4, 4.3 * side), 1.2)]
        parts += [_limb((21.5, -3, 1.0 * side), (24.0, -4.5, 2.2 * side), 0.8, 0.6)]
    shell = [_ball(*_of_shell(k / _STEPS)) for k in range(_STEPS + 1)]

    def field(p: np.ndarray) -> np.ndarray:
        body, house = parts[0](p), shell[0](p)
        for part in parts[1:]:
            body = least(body, part(p), 1.6)
        for part in shell[1:]:
            house = least(house, part(p), 0.4)
        return least(body, house, 1.2)

    return field


def _of_shell(share: float) -> tuple[tuple[float, float, float], float]:
    """Middle and radius of the tube of the shell, from its mouth to its tip: each turn about half the one before."""
    turn, size = 2 * np.pi * _TURNS * share, 0.5 ** (_TURNS * share)
    middle = (-3 + 7.2 * size * np.cos(turn - 1.1), 0.5 + 7.2 * size * np.sin(turn - 1.1), 5.5 * (1 - size))
    return middle, 6.4 * size


def _ball(middle: tuple[float, float, float], radius: float) -> Field:
    centre = np.array(middle)
    return lambda p: np.linalg.norm(p - centre, axis=-1) - radius


def _limb(start: tuple[float, float, float], end: tuple[float, float, float], thick: float, thin: float) -> Field:
    way = np.subtract(end, start)
    length = float(np.linalg.norm(way))
    return capsule(np.array(start), way / length, length, thick, thin)
