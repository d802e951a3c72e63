"""The bodies of the gallery: things that are made of what light goes through, mm, y up."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph.mesh.surface import Surface
from quadgraph_validation.bodies.implicit import Field, box, capsule, least, meshed, valid

Place: TypeAlias = Sequence[float] | np.ndarray
_UP = np.array([0.0, 1.0, 0.0])


def surface_of(name: str) -> Surface:
    """A body of BODIES, one closed piece. Raises InputError for another name, and without scikit-image."""
    if name not in BODIES:
        raise InputError(f"gallery body: {name!r} found, allowed are {', '.join(BODIES)}")
    make, half, cells, triangles = BODIES[name]
    made = valid(meshed(make(), half, cells), triangles)
    if made is None:
        raise InputError(f"gallery body: {name!r} has no valid surface with {cells} cells and {triangles} triangles")
    return Surface(made.vertices * (2 * half / (cells - 1)) - half, made.triangles).rounded()


def _ball(centre: Place, radii: float | tuple[float, ...]) -> Field:
    middle, size = np.array(centre), np.broadcast_to(np.array(radii, float), 3)
    return lambda p: (np.linalg.norm((p - middle) / size, axis=-1) - 1) * size.min()


def _capsule(start: Place, end: Place, thick: float, thin: float | None = None) -> Field:
    """From one end, as thick as `thick`, to the other."""
    way = np.subtract(end, start, dtype=float)
    length = float(np.linalg.norm(way))
    return capsule(np.array(start, float), way / length, length, thick, thick if thin is None else thin)


def _box(half: tuple[float, float, float], edge: float) -> Field:
    """A box of these half sides, its edges rounded."""
    return box(np.array(half) - edge, edge, np.eye(3))


def _turned(profile: str) -> Field:
    """What a closed profile, its corners as radius,height, sweeps about the y axis."""
    corners = np.array([corner.split(",") for corner in profile.split()], float)
    edges = np.roll(corners, -1, axis=0) - corners

    def field(p: np.ndarray) -> np.ndarray:
        radius, height = np.hypot(p[..., 0], p[..., 2]), p[..., 1]
        square, inside = np.full(radius.shape, np.inf), np.zeros(radius.shape, bool)
        for (r, h), (dr, dh) in zip(corners, edges, strict=True):
            along = np.clip(((radius - r) * dr + (height - h) * dh) / (dr * dr + dh * dh), 0, 1)
            square = np.minimum(square, (radius - r - along * dr) ** 2 + (height - h - along * dh) ** 2)
            crosses = (h > height) != (h + dh > height)
            if dh != 0:
                inside ^= crosses & (radius < r + (height - h) * dr / dh)
        return np.where(inside, -1, 1) * np.sqrt(square)

    return field


def _union(parts: list[Field], blend: float) -> Field:
    def field(p: np.ndarray) -> np.ndarray:
        value = parts[0](p)
        for part in parts[1:]:
            value = least(value, part(p), blend)
        return value

    return field


def _without(body: Field, cut: Field, blend: float) -> Field:
    return lambda p: -least(-body(p), cut(p), blend)


def _gummy_bear() -> Field:
    """Sitting, 25 mm tall, its front towards +z."""
    both = [-1.0, 1.0]
    parts = [_ball((0, -2.5, 0), (6.6, 8.0, 5.6)), _ball((0, 7.2, 0.3), (5.2, 4.6, 4.6)), _ball((0, 6.0, 4.2), 2.1)]
    parts += [_ball((3.9 * side, 11.0, -0.2), (2.1, 2.1, 1.5)) for side in both]
    parts += [_capsule((5.0 * side, 1.2, 1.5), (4.6 * side, -1.6, 6.2), 2.2, 2.0) for side in both]
    parts += [_capsule((3.6 * side, -9.0, 1.0), (4.4 * side, -9.6, 7.4), 3.0, 2.6) for side in both]
    bear = _union(parts, 1.3)
    eyes = _union([_ball((1.9 * side, 8.4, 4.6), 0.7) for side in both], 0.1)
    return _without(bear, eyes, 0.3)


def _soap() -> Field:
    """A bar of 84 x 28 x 56 mm with an oval sunk into its top."""
    bar = _union([_box((42, 14, 28), 13), _ball((0, 0, 0), (41, 16, 27))], 4)

    def oval(p: np.ndarray) -> np.ndarray:
        ring = np.abs(np.hypot(p[..., 0] / 27, p[..., 2] / 15) - 1) * 15 - 1.4
        return np.maximum(ring, 13.2 - p[..., 1])

    return _without(bar, oval, 1.2)


def _candle() -> Field:
    """A candle of 72 mm that has burnt down into itself, wax that ran down its side."""
    body = _turned("0,-36 24,-36 25,-34 25,30 23.5,33 21.5,31 20.5,24 17,8 9,-3 0,-6")
    turns, ends = (0.3, 0.9, 1.5, 2.6, 3.6, 4.4, 5.4), (6, -12, 14, -4, 10, -18, 2)  # of what ran down, mm
    drips = []
    for turn, end in zip(turns, ends, strict=True):
        way = np.array([np.sin(turn), 0, np.cos(turn)])
        drips.append(_capsule(24.6 * way + 31 * _UP, 25.4 * way + end * _UP, 1.7, 2.4))
    return _union([body, *drips], 2.0)


def _crown() -> Field:
    """The crown that a drop throws up from milk, 60 mm across, and the drop above it."""
    wall = _turned("0,-13 27,-13 29,-12 27,-10.4 22.5,-8 21.5,-2 23.8,6 22.6,6.4 19.6,-2 19.2,-8 14,-10.6 0,-11")
    count = 17
    turns = 2 * np.pi * (np.arange(count) + 0.25 * np.sin(5.0 * np.arange(count))) / count
    heights = 12 + 3.5 * np.sin(7.0 * np.arange(count) + 1)
    parts: list[Field] = [wall]
    for turn, height in zip(turns, heights, strict=True):
        way = np.array([np.sin(turn), 0, np.cos(turn)])
        foot, tip = 23.0 * way + _UP * 5.4, (24.6 + 0.22 * height) * way + _UP * height
        parts += [_capsule(foot, tip, 1.5, 0.95), _ball(tip + 0.8 * _UP, 1.9)]
    jet = [_capsule((0, -7, 0), (0, 9, 0), 5.5, 2.0), _ball((0, 11.5, 0), 4.2)]
    return _union([*parts, *jet], 1.6)


def _leaf() -> Field:
    """A leaf of 90 mm, half a millimetre thin between veins of two."""

    def field(p: np.ndarray) -> np.ndarray:
        x, y, z = p[..., 0], p[..., 1], p[..., 2]
        along = np.clip((y + 42) / 84, 0, 1)
        width = 27 * np.sin(np.pi * along**0.8) ** 0.9 * (1 - 0.3 * along) + 0.01
        bend = 5.5 * (x / 27) ** 2 + 4.0 * np.sin(2.2 * along) + 0.7 * np.sin(0.42 * y) * np.abs(x) / 27
        off = np.abs(z - bend)
        side = np.abs(np.mod(np.abs(x) * 0.75 - y + 2.5, 11) - 5.5)  # mm, from the nearest side vein
        vein = np.maximum(0.65 * np.exp(-((side / 0.9) ** 2)), 1.25 * np.exp(-((x / 1.3) ** 2)) * (1.1 - 0.7 * along))
        blade = np.maximum(off - 0.55 - vein, (np.abs(x) - width) * 0.7)
        stalk = _capsule((0, -60, -1.0), (0, -38, 0.4), 1.5, 1.9)(p)
        return least(blade, stalk, 1.5)

    return field


def _bowl() -> Field:
    """A bowl of 90 mm with a wall of 3, on a foot."""
    return _turned(
        "0,-22 17,-22 18.5,-20.5 17,-17 24,-14 35,-4 42,10 45,26 43.4,27.6 41.6,26 38.6,11 32,-1 22,-10.5 0,-13"
    )


def _grapes() -> Field:
    """A bunch of 70 mm, its berries grown together where they touch, and a stalk."""
    generator = np.random.default_rng(4)
    parts: list[Field] = []
    for row, count in enumerate((7, 8, 7, 5, 4, 2, 1)):
        height = 18 - 9.4 * row
        ring = 13.5 * (count - 1) / 7 if count > 1 else 0.0
        for k in range(count):
            turn = 2 * np.pi * (k + 0.5 * (row % 2)) / count
            place = np.array([ring * np.sin(turn), height, ring * np.cos(turn)]) + generator.normal(0, 0.7, 3)
            parts.append(_ball(place, (6.7, 7.3, 6.7)))
    parts += [_capsule((0, 14, 0), (0, -20, 0), 7, 3), _capsule((0, 20, 0), (3, 38, 1), 1.9, 2.3)]
    return _union(parts, 0.9)


def _pawn() -> Field:
    """A pawn of 80 mm."""
    profile = "0,-40 20,-40 21,-38 21,-33 18.5,-31 17,-27 12,-21 9,-10 7.6,4 7.6,10 12.5,12 13,13.5 12,15 8.2,16.5 0,17"
    return _union([_turned(profile), _ball((0, 26.5, 0), 12.5)], 1.5)


def _egg() -> Field:
    """An egg of 60 mm on its blunt end."""
    return lambda p: (
        (np.sqrt((p[..., 0] ** 2 + p[..., 2] ** 2) / (22 - 0.16 * p[..., 1]) ** 2 + (p[..., 1] / 30) ** 2) - 1) * 22
    )


# Field, half the side of the box that it is in (mm), cells along that, triangles.
BODIES: dict[str, tuple[Callable[[], Field], float, int, int]] = {
    "bear": (_gummy_bear, 15.0, 150, 24_000),
    "bowl": (_bowl, 50.0, 200, 40_000),
    "candle": (_candle, 40.0, 180, 40_000),
    "crown": (_crown, 36.0, 220, 50_000),
    "egg": (_egg, 34.0, 100, 12_000),
    "grapes": (_grapes, 48.0, 180, 40_000),
    "leaf": (_leaf, 64.0, 300, 60_000),
    "pawn": (_pawn, 44.0, 180, 24_000),
    "soap": (_soap, 48.0, 160, 24_000),
}
