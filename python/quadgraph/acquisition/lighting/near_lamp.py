"""Place and power of a lamp that is small and near, from how brightly it lights the white paper of the board.

Paper of reflectance rho, taken as Lambertian, shows the radiance rho / pi (P z / (4 pi r^3) + a): P the power, r the
distance to a lamp z above the paper, a the irradiance of other light. A lamp that shines forwards, as a small
Lambertian surface does, brings P c z / (pi r^3), c the cosine to its axis, which meets the paper somewhere. Photographs
show that times a gain, which is the same for all; so what is found is power times gain.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import OptimizeResult, least_squares

from quadgraph.acquisition.lighting.board_whites import Whites
from quadgraph.base.errors import InputError

REFLECTANCE, REFLECTANCE_DEVIATION = 0.85, 0.05  # of printers' paper
_UNEVEN = 0.01  # of a value, by which the paper itself differs from place to place
_GLOSS = 25.0  # degrees around the mirrored lamp, where paper shines
_CLEAR_FALL, _LEAST_FOR_FALL = 2.0, 3  # deviation of the fall-off that is taken for granted; photographs that tell it
_MOST_UNSURE = 0.15  # of the distance, its deviation
_DIRECTIONS, _DISTANCES = 160, np.geomspace(0.3, 20, 16)  # of the grid that the fit starts from, of the board's size
_STARTS, _SHORT, _LONG = 3, 15, 150  # starts, and evaluations of each, and of the best one
_AROUND = 10  # unknowns of a lamp that shines all around; one that shines forwards has two more
_UNLIKE = 12.0  # of samples times the logarithm of what is left, by which one that shines forwards has to fit better
_ROBUST = 2.5  # deviations, beyond which a sample counts for less


@dataclass(frozen=True, eq=False)
class NearLamp:
    """A lamp that was found.

    position, position_deviation: (3,) mm; power, power_deviation: (3,) W times gain; ambient: (3,) W/mm^2 times gain,
    of all other light; share: of it in the light on the board; falloff: c of a lens that shows exp(-c s^2) of the light
    at the slope s; off: RMS of the samples, of their values; samples, photographs: how many; aim: (2,) mm, where its
    axis meets the board, None of one that shines all around; unlike: whether it is rather of the other kind.
    """

    position: np.ndarray
    position_deviation: np.ndarray
    power: np.ndarray
    power_deviation: np.ndarray
    ambient: np.ndarray
    share: float
    falloff: float
    off: float
    samples: int
    photographs: int
    aim: np.ndarray | None
    unlike: bool


@dataclass(frozen=True, eq=False)
class _Samples:
    """Those of all photographs. places (n, 3), values, deviations (n, 3), slopes2 (n,), eyes (n, 3)."""

    places: np.ndarray
    values: np.ndarray
    deviations: np.ndarray
    slopes2: np.ndarray
    eyes: np.ndarray
    photographs: int

    def only(self, kept: np.ndarray) -> _Samples:
        """Those of a mask, (n,)."""
        places, values, deviations = self.places[kept], self.values[kept], self.deviations[kept]
        return _Samples(places, values, deviations, self.slopes2[kept], self.eyes[kept], self.photographs)


def fit(
    where: str,
    whites: Sequence[Whites],
    reflectance: float = REFLECTANCE,
    deviation: float = REFLECTANCE_DEVIATION,
    forwards: bool = False,
) -> NearLamp:
    """The lamp that lights the samples of one photograph or more.

    reflectance, deviation: of the white paper; forwards: as a small Lambertian surface, not all around. Raises
    InputError, which begins with `where`, if they do not tell how far away it is.
    """
    samples = _together(whites)
    starts = [_turned(start, samples) if forwards else start for start in _starts(samples)]
    best = min((_solved(samples, start, _SHORT) for start in starts), key=lambda each: float(each.cost))
    found = _solved(samples, best.x)
    matt = _matt(samples, _place(found.x))
    if matt.sum() > len(matt) / 3 and not matt.all():
        samples = samples.only(matt)
        found = _solved(samples, found.x)
    other = _solved(samples, _turned(found.x, samples))
    better = len(samples.places) * np.log(float(found.cost) / float(other.cost))
    return _lamp(where, samples, found, reflectance, deviation, bool(better > (-_UNLIKE if forwards else _UNLIKE)))


def _together(whites: Sequence[Whites]) -> _Samples:
    places = np.concatenate([each.places for each in whites])
    values = np.concatenate([each.values for each in whites])
    variances = np.concatenate([each.variances for each in whites])
    deviations = np.sqrt(variances + (_UNEVEN * np.abs(values)) ** 2)
    eyes = np.concatenate([np.broadcast_to(each.eye, (len(each.places), 3)) for each in whites])
    slopes2 = np.concatenate([each.slopes2 for each in whites])
    flat = np.concatenate([places, np.zeros((len(places), 1))], axis=1)
    return _Samples(flat, values, deviations, slopes2, eyes, len(whites))


def _lit(places: np.ndarray, lamps: np.ndarray) -> np.ndarray:
    """(m, n) irradiance of each of m lamps, (m, 3), of 1 W at places (n, 3) of the paper, W/mm^2."""
    away = lamps[:, None] - places
    distance = np.linalg.norm(away, axis=2)
    return np.asarray(away[..., 2] / (4 * np.pi * distance**3))


def _starts(samples: _Samples) -> list[np.ndarray]:
    """Unknowns of the best lamps of a grid of directions and distances, each of the powers that suit it."""
    middle = samples.places.mean(axis=0)
    size = float(np.ptp(samples.places[:, :2], axis=0).max())
    turns = np.pi * (3 - np.sqrt(5)) * np.arange(_DIRECTIONS)
    high = (np.arange(_DIRECTIONS) + 0.5) / _DIRECTIONS
    level = np.sqrt(1 - high**2)
    ways = np.stack([level * np.cos(turns), level * np.sin(turns), high], axis=1)
    lamps = middle + (_DISTANCES[:, None, None] * size * ways).reshape(-1, 3)
    weights = 1 / samples.deviations.mean(axis=1)
    grey = samples.values.mean(axis=1) * weights
    off = _misfits(_lit(samples.places, lamps) * weights, weights, grey)
    starts = []
    for lamp in lamps[np.argsort(off)[:_STARTS]]:
        lit = _lit(samples.places, lamp[None])[0]
        power = np.pi * np.median(samples.values / lit[:, None], axis=0)
        other = 0.01 * np.pi * np.median(samples.values, axis=0)
        starts.append(np.concatenate([lamp[:2], np.log([lamp[2], *np.maximum(power, 1e-300)]), [0.0], other]))
    return starts


def _turned(unknowns: np.ndarray, samples: _Samples) -> np.ndarray:
    """The unknowns of the other kind of lamp: one that shines forwards, first to the middle of the board, or around."""
    forwards = len(unknowns) == _AROUND
    start = unknowns[:_AROUND].copy()
    start[3:6] += -np.log(4) if forwards else np.log(4)
    return np.concatenate([start, samples.places.mean(axis=0)[:2]]) if forwards else start


def _misfits(shapes: np.ndarray, even: np.ndarray, grey: np.ndarray) -> np.ndarray:
    """(m,) squares of what is left of the samples, (n,), by the best power of each shape, (m, n), and the best other
    light, neither of them below nothing.
    """
    lengths = np.linalg.norm(shapes, axis=1)
    even = even / np.linalg.norm(even)
    both, shown, other = shapes @ even / lengths, shapes @ grey / lengths, float(even @ grey)
    apart = np.maximum(1 - both**2, 1e-12)
    power, ambient = (shown - both * other) / apart, (other - both * shown) / apart
    alone = np.maximum(shown, 0)
    power, ambient = (
        np.where(power < 0, 0, np.where(ambient < 0, alone, power)),
        np.where(power < 0, max(other, 0), np.where(ambient < 0, 0, ambient)),
    )
    told = power**2 + ambient**2 + 2 * power * ambient * both - 2 * power * shown - 2 * ambient * other
    return np.asarray(grey @ grey + told)


def _place(unknowns: np.ndarray) -> np.ndarray:
    """The lamp's place: x and y, and z by its logarithm, as it is above the paper."""
    return np.array([unknowns[0], unknowns[1], np.exp(np.clip(unknowns[2], -20, 20))])


def _shape(unknowns: np.ndarray, places: np.ndarray) -> np.ndarray:
    """(n,) irradiance of the lamp, of 1 W, at places (n, 3) of the paper, W/mm^2."""
    lamp = _place(unknowns)
    lit = _lit(places, lamp[None])[0]
    if len(unknowns) == _AROUND:
        return np.asarray(lit)
    axis, ways = np.array([*unknowns[_AROUND:], 0.0]) - lamp, places - lamp
    cosine = ways @ axis / np.linalg.norm(axis) / np.linalg.norm(ways, axis=1)
    return np.asarray(4 * np.maximum(cosine, 0) * lit)


def _off(unknowns: np.ndarray, samples: _Samples) -> np.ndarray:
    """By how many deviations each sample is off, as of white paper of reflectance 1; and the fall-off, of its own."""
    lit = _shape(unknowns, samples.places)[:, None] * np.exp(np.clip(unknowns[3:6], -700, 700))
    lit = lit + unknowns[7:_AROUND]
    fall = unknowns[6] if samples.photographs >= _LEAST_FOR_FALL else 0.0
    shown = lit / np.pi * np.exp(-fall * samples.slopes2)[:, None]
    off = (shown - samples.values) / samples.deviations
    return np.append(off.ravel(), unknowns[6] / _CLEAR_FALL)


def _slopes(unknowns: np.ndarray, samples: _Samples) -> np.ndarray:
    """Derivatives of `_off` with respect to the unknowns."""
    count = len(samples.places)
    shape, shape_slopes = _shape(unknowns, samples.places), _shape_slopes(unknowns, samples.places)
    power = np.exp(np.clip(unknowns[3:6], -700, 700))
    told = samples.photographs >= _LEAST_FOR_FALL
    fall = np.exp(-(unknowns[6] if told else 0.0) * samples.slopes2)
    weights = fall[:, None] / np.pi / samples.deviations
    found = np.zeros((count, 3, len(unknowns)))
    lit = shape[:, None] * power
    placed = (weights * power)[:, :, None] * shape_slopes[:, None]
    found[:, :, :3], found[:, :, _AROUND:] = placed[:, :, :3], placed[:, :, 3:]
    for channel in range(3):
        found[:, channel, 3 + channel] = weights[:, channel] * lit[:, channel]
        found[:, channel, 7 + channel] = weights[:, channel]
    if told:
        found[:, :, 6] = -samples.slopes2[:, None] * weights * (lit + unknowns[7:_AROUND])
    last = np.zeros((1, len(unknowns)))
    last[0, 6] = 1 / _CLEAR_FALL
    return np.concatenate([found.reshape(3 * count, -1), last])


def _shape_slopes(unknowns: np.ndarray, places: np.ndarray) -> np.ndarray:
    """(n, 3) derivatives of `_shape` with respect to x, y and the logarithm of z; (n, 5), and to where the axis meets
    the paper, of a lamp that shines forwards.
    """
    lamp = _place(unknowns)
    away = lamp - places
    distance = np.linalg.norm(away, axis=1)[:, None]
    lit = away[:, 2:] / (4 * np.pi * distance**3)
    slopes = np.array([0, 0, 1.0]) / (4 * np.pi * distance**3) - 3 * lit * away / distance**2
    if len(unknowns) > _AROUND:
        axis = np.array([*unknowns[_AROUND:], 0.0]) - lamp
        length = float(np.linalg.norm(axis))
        cosine = -(away @ axis)[:, None] / length / distance
        by_way = axis / (length * distance) + cosine * away / distance**2
        by_axis = -away / (length * distance) - cosine * axis / length**2
        shines = 4.0 * (cosine > 0)
        placed = shines * (cosine * slopes - lit * (by_way + by_axis))
        slopes = np.concatenate([placed, shines * lit * by_axis[:, :2]], axis=1)
    slopes[:, 2] *= lamp[2] if abs(unknowns[2]) < 20 else 0.0
    return np.asarray(slopes)


def _solved(samples: _Samples, start: np.ndarray, most: int = _LONG) -> OptimizeResult:
    other = 0.1 * np.pi * np.abs(samples.values).mean(axis=0) + 1e-300
    scale = np.concatenate([[100.0, 100.0], np.ones(5), other, np.full(len(start) - _AROUND, 100.0)])
    return least_squares(
        _off, start, _slopes, x_scale=scale, loss="soft_l1", f_scale=_ROBUST, args=(samples,), max_nfev=most
    )


def _matt(samples: _Samples, lamp: np.ndarray) -> np.ndarray:
    """(n,) which samples are seen from elsewhere than where the paper mirrors the lamp."""
    mirrored = (samples.places - lamp) * [1, 1, -1]
    seen = samples.eyes - samples.places
    cosine = (mirrored * seen).sum(axis=1) / np.linalg.norm(mirrored, axis=1) / np.linalg.norm(seen, axis=1)
    return np.asarray(cosine < np.cos(np.radians(_GLOSS)))


def _lamp(
    where: str, samples: _Samples, found: OptimizeResult, reflectance: float, deviation: float, unlike: bool
) -> NearLamp:
    """The lamp of a fit with its deviations. Raises InputError where the distance is not told."""
    place, power = _place(found.x), np.exp(found.x[3:6]) / reflectance
    off = _off(found.x, samples)[:-1].reshape(-1, 3)
    covariance = _covariance(found.jac, off, place[2])
    middle = samples.places.mean(axis=0)
    away = place - middle
    distance = float(np.linalg.norm(away))
    way = away / distance
    told = np.isfinite(covariance).all()
    unsure = float(np.sqrt(way @ covariance[:3, :3] @ way)) if told else np.inf
    if unsure > _MOST_UNSURE * distance:
        raise InputError(_not_told(where, distance, unsure, way, covariance, samples))
    other = found.x[7:_AROUND]
    relative = samples.deviations * off / np.maximum(samples.values, 1e-300)
    return NearLamp(
        place,
        np.sqrt(np.diag(covariance)[:3]),
        power,
        power * np.sqrt(np.diag(covariance)[3:6] + (deviation / reflectance) ** 2),
        other / reflectance,
        float(np.median(other / (other + np.exp(found.x[3:6]) * _shape(found.x, middle[None])))),
        float(found.x[6]),
        float(np.sqrt((relative**2).mean())),
        len(samples.places),
        samples.photographs,
        found.x[_AROUND:] if len(found.x) > _AROUND else None,
        unlike,
    )


def _covariance(jacobian: np.ndarray, off: np.ndarray, high: float) -> np.ndarray:
    """Of all unknowns, z in place of its logarithm; infinite where the samples do not tell one of them."""
    scale = np.linalg.norm(jacobian, axis=0)
    scale[2] /= high
    columns = jacobian / np.linalg.norm(jacobian, axis=0)
    # Channels share what is wrong with paper and pose, so that three say no more than one.
    scatter = max(1.4826 * float(np.median(np.abs(off))), 1.0) ** 2 * 3
    with np.errstate(all="ignore"):
        try:
            found = np.linalg.inv(columns.T @ columns) * scatter / np.outer(scale, scale)
        except np.linalg.LinAlgError:
            return np.diag(np.full(len(scale), np.inf))
    return found if (np.diag(found) >= 0).all() else np.diag(np.full(len(scale), np.inf))


def _not_told(
    where: str, distance: float, unsure: float, way: np.ndarray, covariance: np.ndarray, samples: _Samples
) -> str:
    """What to say of a lamp whose distance the board does not tell, and what to do."""
    beside = np.eye(3) - np.outer(way, way)
    place = np.nan_to_num(covariance[:3, :3], posinf=1e12)
    turned = np.degrees(np.sqrt(max(float(np.linalg.eigvalsh(beside @ place @ beside)[-1]), 0)) / distance)
    values = float((samples.values.max() - samples.values.min()) / np.median(samples.values))
    found = f"{where}: found a lamp {distance:.0f} mm away, give or take {min(unsure, 9.9 * distance):.0f}"
    even = f"the paper is lit too evenly (brightest to darkest {values:.0%}) to tell how far it is"
    said = f"{found}: {even}; allowed is {_MOST_UNSURE:.0%}. Bring the lamp nearer, shade other light, take more"
    if turned < 5:
        stated = ", ".join(f"{-each:.3f}" for each in way)
        return f'{said} photographs, or state "type": "directional", "direction": [{stated}] (to {turned:.1f} degrees)'
    return f"{said} photographs, or measure where it is and state `position`"
