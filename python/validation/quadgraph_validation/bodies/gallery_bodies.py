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


def _turned(profile: str, edge: float) -> Field:
    """What a profile, corners as radius,height from axis to axis, sweeps about the y axis.

    edge: mm that its corners are cut by at first, and then, as far as that leaves corners, by less.
    """
    corners = np.array([corner.split(",") for corner in profile.split()], float)
    for most in (edge, 0.4 * edge):
        corners = _cut(corners, most)
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


def _cut(corners: np.ndarray, most: float) -> np.ndarray:
    """A line of straight pieces with its corners cut, by `most` and at most a third of a piece."""
    pieces = np.diff(corners, axis=0)
    share = np.minimum(most / np.linalg.norm(pieces, axis=1), 1 / 3)[:, None]
    between = np.stack([corners[:-1] + share * pieces, corners[1:] - share * pieces], axis=1).reshape(-1, 2)
    return np.vstack([corners[:1], between[1:-1], corners[-1:]])


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
    eyes = _union([_ball((2.0 * side, 8.6, 4.7), 0.95) for side in both], 0.1)
    return _without(bear, eyes, 0.25)


def _soap() -> Field:
    """A bar of 86 x 32 x 58 mm with an oval sunk into its top."""
    bar = _union([_box((42, 14, 28), 13), _ball((0, 0, 0), (41, 16, 27))], 4)

    def oval(p: np.ndarray) -> np.ndarray:
        ring = np.abs(np.hypot(p[..., 0] / 27, p[..., 2] / 15) - 1) * 15 - 1.4
        return np.maximum(ring, 13.2 - p[..., 1])

    return _without(bar, oval, 1.2)


def _candle() -> Field:
    """A candle of 70 mm that has burnt down into itself, wax that ran down its side."""
    body = _turned("0,-36 24,-36 25.2,-20 24.6,10 25,33.5 20.6,33.5 19.6,22 16.5,8 9,-4 0,-7", 2.2)
    turns, ends = (0.15, 0.8, 1.5, 2.6, 3.5, 4.4, 5.5), (10, -8, 15, -4, 12, -14, 4)  # of what ran down, mm
    drips: list[Field] = []
    for turn, end in zip(turns, ends, strict=True):
        way = np.array([np.sin(turn), 0, np.cos(turn)])
        drips += [_capsule(23.6 * way + 31 * _UP, 24.4 * way + end * _UP, 2.0, 1.7), _ball(24.6 * way + end * _UP, 2.6)]
    return _union([body, *drips], 2.4)


def _crown() -> Field:
    """The crown that a drop throws up from milk, 68 mm across, and the drop that follows in its middle."""
    wall = _turned(
        "0,-14.5 34,-14.5 34,-11 27.5,-10.6 24,-8 22.6,-2 23.8,4 25.6,8.2 "
        "23.6,8.2 21.2,1 20.4,-5 18.6,-9 14,-11 0,-11.2",
        1.2,
    )
    count = 17
    turns = 2 * np.pi * (np.arange(count) + 0.25 * np.sin(5.0 * np.arange(count))) / count
    heights = 13 + 3.5 * np.sin(7.0 * np.arange(count) + 1)
    parts: list[Field] = [wall]
    for turn, height in zip(turns, heights, strict=True):
        way = np.array([np.sin(turn), 0, np.cos(turn)])
        foot, tip = 24.4 * way + _UP * 6.2, (25.4 + 0.22 * height) * way + _UP * height
        parts += [_capsule(foot, tip, 1.7, 1.0), _ball(tip + 0.8 * _UP, 1.9)]
    jet = [_capsule((0, -8, 0), (0, 8, 0), 5.5, 2.0), _ball((0, 10.5, 0), 3.8)]
    return _union([*parts, *jet], 2.2)


def _hand() -> Field:
    """A hand of 240 mm with its wrist, fingers up and spread, its palm towards +z."""
    palm = _union([_box((37, 40, 10), 9.5), _ball((20, -24, 5), (17, 26, 10)), _ball((-24, -18, 3), (13, 28, 10))], 12)
    wrist = _capsule((0, -34, 0), (0, -102, 0), 24, 22)
    # Of each finger where it begins, how far it leans outwards in degrees, its three bones and its thickness, mm.
    fingers = [
        (-29, 30, -14, (24, 17, 13), 7.4),
        (-11, 37, -5, (32, 22, 15), 8.4),
        (8, 38, 3, (34, 24, 15), 8.6),
        (27, 32, 11, (30, 20, 14), 8.2),
        (27, -18, 46, (36, 24, 18), 11.0),
    ]
    parts = []
    for x, y, lean, bones, thick in fingers:
        at = np.array([x, y, 0.0])
        finger = []
        for number, bone in enumerate(bones):
            turn, bent = np.radians(lean * (1 - 0.2 * number)), np.radians(8 * number)
            to = at + bone * np.array([np.sin(turn), np.cos(turn) * np.cos(bent), np.sin(bent)])
            finger.append(_capsule(at, to, thick, 0.91 * thick))
            at, thick = to, 0.91 * thick
        parts.append(_union(finger, 1.0))
    return _union([_union([palm, wrist], 18), *parts], 6.0)


def _leaf() -> Field:
    """A leaf of 105 mm with its stalk, a millimetre thin between veins of three, bent along and across."""

    def field(p: np.ndarray) -> np.ndarray:
        x, y, z = p[..., 0], p[..., 1], p[..., 2]
        along = np.clip((y + 42) / 84, 0, 1)
        width = 25 * np.sin(np.pi * along**0.75) ** 0.8 * (1 - 0.35 * along) + 0.01
        bend = 7 * (x / 25) ** 2 + 9 * (along - 0.3) ** 2 - 1.2 * np.sin(0.3 * y + 2 * np.sign(x)) * (x / 25) ** 2
        off = np.abs(z - bend)
        # mm from the nearest side vein; those of the left side begin between those of the right
        across = np.abs(x)
        side = np.abs(np.mod(1.05 * across - 0.013 * across**2 - y + np.where(x < 0, 6.5, 2), 9) - 4.5)
        fine = 0.22 * np.exp(-((np.abs(np.mod(0.9 * y + 1.1 * across, 3) - 1.5) / 0.35) ** 2)) * (across > 1)
        vein = np.maximum(0.75 * np.exp(-((side / 0.75) ** 2)) * (1 - 0.5 * across / 25), fine)
        vein = np.maximum(vein, 1.5 * np.exp(-((x / 1.2) ** 2)) * (1.1 - 0.8 * along))
        blade = np.maximum(off - 0.5 - vein, (across - width) * 0.7)
        stalk = _capsule((0, -62, 5.5), (0, -38, 1.0), 1.3, 1.7)(p)
        return least(blade, stalk, 1.5)

    return field


def _bowl() -> Field:
    """A bowl of 90 mm with a wall of 3, on a foot."""
    return _turned(
        "0,-22 18,-22 17,-16.5 27,-12.5 36.5,-3 42,9 45,27.6 41.6,27.6 38.8,10.5 33.4,-0.5 24.5,-9.2 12,-12.6 0,-13",
        3.0,
    )


def _grapes() -> Field:
    """A bunch of 86 mm with its stalk, its berries grown together where they touch."""
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
    profile = "0,-40 21,-40 21,-33 18.5,-31 17,-27 12,-21 9,-10 7.6,4 7.6,10 13,12 13,15 8.2,16.5 0,17"
    return _union([_turned(profile, 1.0), _ball((0, 26.5, 0), 12.5)], 1.5)


def _egg() -> Field:
    """An egg of 60 mm on its blunt end."""
    return lambda p: (
        (np.sqrt((p[..., 0] ** 2 + p[..., 2] ** 2) / (22 - 0.16 * p[..., 1]) ** 2 + (p[..., 1] / 30) ** 2) - 1) * 22
    )


# Where the lids of the left eye begin and end, mm: two pieces of the upper one, two of the lower.
_LIDS = (
    (2.5, 31.4, 15.8, 6.2, 34.0, 17.0),
    (6.2, 34.0, 17.0, 10.6, 31.6, 14.1),
    (2.8, 31.0, 15.8, 6.4, 29.3, 16.5),
    (6.4, 29.3, 16.5, 10.4, 31.2, 14.1),
)


def _bust_head() -> Field:
    """The head of the bust without its hair, on its neck, its face towards +z."""
    both = [-1.0, 1.0]
    skull = [_ball((0, 39, -3), (17, 19, 21)), _ball((0, 27.5, 5), (13.0, 17, 12.6))]
    skull += [_ball((0, 18, 6), (9.4, 8, 8.6)), _ball((0, 12.2, 12.6), (3.8, 3.2, 3.4))]
    skull += [_ball((8.2 * side, 24.5, 10), (4.6, 4.2, 4.6)) for side in both]
    head = _union(skull, 6.0)
    sockets = _union([_ball((6.4 * side, 32.0, 18.6), (4.7, 3.4, 3.9)) for side in both], 0.5)
    head = _without(head, sockets, 2.6)
    eyes = _union([_ball((6.3 * side, 31.7, 12.9), 4.2) for side in both], 0.1)
    head = _union([head, eyes], 0.5)
    lids = [_capsule((x * side, y, z), (u * side, v, w), 0.9) for side in both for x, y, z, u, v, w in _LIDS]
    head = _union([head, _union(lids, 0.5)], 0.7)
    brows = [_capsule((2.2 * side, 36.2, 16.9), (10.6 * side, 35.6, 11.6), 1.8, 0.8) for side in both]
    nose = [_capsule((0, 36.5, 17.2), (0, 26.2, 20.4), 1.7, 1.8), _ball((0, 25.4, 20.6), 2.2)]
    nose += [_ball((2.3 * side, 24.6, 18.6), (1.6, 1.5, 2.1)) for side in both]
    head = _union([head, _union(nose, 1.5), *brows], 2.2)
    lips = [_capsule((0.9 * side, 19.9, 17.0), (4.7 * side, 18.6, 15.7), 1.3, 0.6) for side in both]
    lips += [_capsule((-1.9, 17.0, 16.7), (1.9, 17.0, 16.7), 1.4)]
    head = _union([head, *lips], 1.0)
    slit = _union([_capsule((0, 18.4, 18.4), (4.6 * side, 18.5, 16.5), 0.5, 0.4) for side in both], 0.2)
    head = _without(head, slit, 1.0)
    ears = _union([_ball((16.3 * side, 30, -1.5), (2.2, 5.8, 3.8)) for side in both], 0.5)
    bowls = _union([_ball((18.9 * side, 31, -0.6), (1.5, 3.2, 1.8)) for side in both], 0.1)
    head = _union([head, _without(ears, bowls, 1.2)], 1.2)
    return _union([head, _capsule((0, 22, -4), (0, -10, -6), 8.8, 10.8)], 4.0)


def _bust_hair() -> Field:
    """The hair of the bust, in waves from a parting back into a knot."""

    def field(p: np.ndarray) -> np.ndarray:
        x, y, z = p[..., 0], p[..., 1], p[..., 2]
        cap = _ball((0, 40, -4.2), (18.6, 20.2, 21.6))(p)
        turn = np.arctan2(np.abs(x), y - 37)  # about the axis of the knot, 0 at the parting
        strands = np.cos(19 * turn + 1.3 * np.sin(0.42 * z + 4 * turn))
        cap = cap - 0.75 * strands * np.clip(np.hypot(x, y - 37) / 9 - 0.3, 0, 1) * np.clip(np.abs(x) / 3, 0.4, 1)
        edge = 0.5 * (z - 11) - 0.78 * (y - 42) + 1.4 - 0.2 * np.abs(x)  # beyond the hairline
        return -least(-cap, -edge, 1.6)

    knot = _ball((0, 37, -27), (8.5, 8.5, 7.5))
    return _union([field, knot], 2.0)


def _bust() -> Field:
    """A classical bust of 122 mm on its socle, hair in a knot, a cloth about its shoulders."""
    both = [-1.0, 1.0]
    parts = [_ball((0, -24, -2), (30, 24, 17)), _capsule((0, -6, -6), (0, -14, -6), 14)]
    parts += [_capsule((10 * side, -9, -5), (36 * side, -17, -5), 9, 11.5) for side in both]
    torso = _union(parts, 9.0)

    def cloth(p: np.ndarray) -> np.ndarray:
        x, y, z = p[..., 0], p[..., 1], p[..., 2]
        hang = y - 0.011 * (x - 4) ** 2 + 0.1 * x + 0.35 * np.sin(0.2 * x)
        depth = (0.75 + 0.25 * np.cos(0.37 * hang + 0.06 * x)) * np.clip((z + 10) / 10, 0, 1)
        folds = depth * np.cos(hang + 0.8 * np.sin(0.09 * x + 1))
        over = hang + 17.0 - 14 * np.clip(-z / 6, 0, 1)  # the neckline, higher behind
        return -least(-(torso(p) - 2.0 - 0.9 * folds), -over, 2.5)

    body = _union([_bust_head(), torso], 6.0)
    body = _union([body, cloth], 0.8)
    body = _union([body, _bust_hair()], 0.8)
    kept = _ball((0, 14, -4), (43, 53, 60))

    def outside(p: np.ndarray) -> np.ndarray:
        return -np.where(p[..., 1] < 14, kept(p), np.abs(p[..., 0]) - 43)

    body = _without(body, outside, 2.5)
    socle = "0,-62 22,-62 22,-57 19.5,-55.5 17,-52 11,-47 10,-42 13,-37 13,-33 0,-33"
    return _union([body, _turned(socle, 1.0)], 1.5)


# Field, half the side of the box that it is in (mm), cells along that, triangles.
BODIES: dict[str, tuple[Callable[[], Field], float, int, int]] = {
    "bear": (_gummy_bear, 15.0, 150, 24_000),
    "bowl": (_bowl, 50.0, 190, 70_000),
    "bust": (_bust, 66.0, 280, 80_000),
    "candle": (_candle, 40.0, 170, 36_000),
    "crown": (_crown, 38.0, 220, 50_000),
    "egg": (_egg, 34.0, 140, 40_000),
    "grapes": (_grapes, 48.0, 180, 40_000),
    "hand": (_hand, 132.0, 200, 40_000),
    "leaf": (_leaf, 66.0, 330, 70_000),
    "pawn": (_pawn, 44.0, 180, 24_000),
    "soap": (_soap, 48.0, 160, 24_000),
}
