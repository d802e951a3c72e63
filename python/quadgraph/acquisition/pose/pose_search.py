"""Where a body lies, by masks alone: poses all around are tried, the best fitted, and what they leave open is said."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from quadgraph.acquisition.pose.outline import OutlinedBody, Silhouette
from quadgraph.acquisition.pose.pose_fit import BodyPose, PoseFit, fit, mask_rays, shared

FLAT = 10.0  # degrees between the ways to the body, below which its distance is not told
LEAST_MASKS = 2
LEAST_SHARED = 0.85  # of masks and outlines, below which a pose does not fit
_TURNS, _KEPT, _BEST = 1500, 32, 4  # poses that are looked at, that are fitted coarsely, and finely
_COARSE_GRID, _GRID, _SHOWN = 20, 128, 6  # rays along a mask's sides, and masks that a coarse look takes
_COARSE_PLACES, _PLACES = 80, 1500  # of an outline
_COARSE_STEPS, _STEPS = 12, 40
_REACH = 0.25  # of a mask's extent
_ALIKE, _ALIKE_COST = 1.2, 0.02  # times the best's cost, and so much more, within which another pose fits as well
_SAME, _SAME_SHARE = 3.0, 0.004  # times what outlines are off, and of the radius, up to which two surfaces are one
_SAMPLES, _NEAR = 20_000, 8  # places of a surface, and of them near one, whose tangents stand for it
_TURNED, _COARSELY_TURNED = 0.05, 0.25  # radians, from which on two turns are not one
_UNTOLD = 6e-3  # of what a move changes the outlines, squared, below which a turn as far on the surface is none


@dataclass(frozen=True)
class PoseByMasks:
    """How a pose was told. off: RMS distance of the body's outlines from the masks' edges, pixels; shared: of masks and
    outlines, intersection over union; degrees, mm: standard deviations of how it is turned, and of the place of its
    middle, by leaving out each photograph in turn, None of two; photographs: by how many; symmetric: whether the body
    looks the same turned otherwise; others: what masks that were left out share with it, by their paths; lowest: its
    lowest place over the board, mm.
    """

    off: float
    shared: float
    degrees: float | None
    mm: float | None
    photographs: int
    symmetric: bool
    others: Mapping[str, float]
    lowest: float

    def line(self) -> str:
        """How certain it is."""
        told = "" if self.degrees is None else f", turned to {self.degrees:.2g} degrees and placed to {self.mm:.2g} mm"
        alike = "; it looks the same turned otherwise" if self.symmetric else ""
        return (
            f"by {self.photographs} masks, {self.off:.2f} pixels off (RMS){told}{alike}; its lowest place is "
            f"{self.lowest:+.2f} mm over the board"
        )


@dataclass(frozen=True, eq=False)
class FoundPose:
    """A pose, and how it was told."""

    pose: BodyPose
    told: PoseByMasks


class PoseError(Exception):
    """Masks do not tell the pose; the message says why."""


def refined(body: OutlinedBody, silhouettes: Sequence[Silhouette], start: BodyPose) -> FoundPose:
    """The pose near a stated one. Raises PoseError."""
    _check(silhouettes)
    coarse = fit(body, silhouettes, start, _COARSE_PLACES, 2 * _COARSE_STEPS, _reach(silhouettes))
    near = fit(body, silhouettes, coarse.pose, _PLACES, _STEPS)
    return _judged(body, *_agreeing(body, silhouettes, [near]))


def searched(
    body: OutlinedBody, silhouettes: Sequence[Silhouette], advance: Callable[[float], None] = lambda share: None
) -> FoundPose:
    """The pose that fits best of all around. Raises PoseError, also where two poses fit as well."""
    _check(silhouettes)
    kept, fits, others = _agreeing(body, silhouettes, _fits(body, silhouettes, advance))
    if others:  # in which a part of the body is missing, so that they led the search astray
        _check(kept)
        kept, fits, more = _agreeing(body, kept, _fits(body, kept, advance))
        others |= more
    return _judged(body, kept, fits, others)


def _fits(body: OutlinedBody, silhouettes: Sequence[Silhouette], advance: Callable[[float], None]) -> list[PoseFit]:
    """The best of poses all around, turned otherwise each."""
    middle = _middle_of(silhouettes)
    some = _spread(silhouettes)
    poses = [BodyPose(turn, middle - turn @ body.surface.middle) for turn in _turns()]
    rays, shares = mask_rays(some, _COARSE_GRID), []
    for number, pose in enumerate(poses):
        shares.append(shared(body, rays, pose))
        advance(0.5 * (number + 1) / len(poses))
    best = np.argsort(-np.array(shares), kind="stable")[:_KEPT]
    reach, coarse = _reach(silhouettes), []
    for count, number in enumerate(best):
        coarse.append(fit(body, some, poses[number], _COARSE_PLACES, _COARSE_STEPS, reach))
        advance(0.5 + 0.4 * (count + 1) / len(best))
    return [fit(body, silhouettes, each.pose, _PLACES, _STEPS) for each in _unlike(coarse)]


def _check(silhouettes: Sequence[Silhouette]) -> None:
    if len(silhouettes) < LEAST_MASKS:
        raise PoseError(f"{len(silhouettes)} photographs have a mask, allowed are {LEAST_MASKS} or more")
    ways = [_way(each) for each in silhouettes]
    widest = max(float(np.degrees(np.arccos(np.clip(a @ b, -1, 1)))) for a in ways for b in ways)
    if widest < FLAT:
        raise PoseError(
            f"all masks are seen from one side, to {widest:.1f} degrees, allowed are more than {FLAT:g}: photograph "
            "from other sides, too"
        )


def _way(silhouette: Silhouette) -> np.ndarray:
    """(3,) unit, from the eye to the middle of a mask."""
    way = silhouette.rays(silhouette.middle[None])[0]
    return np.asarray(way / np.linalg.norm(way))


def _middle_of(silhouettes: Sequence[Silhouette]) -> np.ndarray:
    """(3,) the place nearest to the ways to all masks' middles; only whole masks count, where there are two."""
    whole = [each for each in silhouettes if each.whole]
    sums, right = np.zeros((3, 3)), np.zeros(3)
    for each in whole if len(whole) > 1 else silhouettes:
        way = _way(each)
        across = np.eye(3) - np.outer(way, way)
        sums += across
        right += across @ each.pose.eye
    return np.asarray(np.linalg.solve(sums + 1e-9 * np.eye(3), right))


def _spread(silhouettes: Sequence[Silhouette]) -> list[Silhouette]:
    """At most so many as a coarse look takes, each as far from those before it as can be."""
    ways = np.array([_way(each) for each in silhouettes])
    chosen = [0]
    while len(chosen) < min(_SHOWN, len(silhouettes)):
        nearest = (ways @ ways[chosen].T).max(axis=1)
        nearest[chosen] = np.inf
        chosen.append(int(nearest.argmin()))
    return [silhouettes[each] for each in chosen]


def _turns() -> np.ndarray:
    """(n, 3, 3) rotations spread evenly over all: super-Fibonacci spirals (Alexa, 2022)."""
    golden, cubic = 2**0.5, 1.533751168755204288118041
    places = np.arange(_TURNS) + 0.5
    share = places / _TURNS
    first, second = 2 * np.pi * places / golden, 2 * np.pi * places / cubic
    low, high = np.sqrt(share), np.sqrt(1 - share)
    quaternions = np.stack(
        [low * np.sin(first), low * np.cos(first), high * np.sin(second), high * np.cos(second)], axis=1
    )
    return np.asarray(Rotation.from_quat(quaternions).as_matrix())


def _reach(silhouettes: Sequence[Silhouette]) -> float:
    return _REACH * max(float(-each.beside.min()) for each in silhouettes)


def _agreeing(
    body: OutlinedBody, silhouettes: Sequence[Silhouette], fits: list[PoseFit]
) -> tuple[list[Silhouette], list[PoseFit], dict[str, float]]:
    """Masks that agree with the body where it fits best, the fits by these, best first, and what the others share with
    it, by their paths: masks in which a part of the body is missing, at most half of them.
    """
    kept, others = list(silhouettes), dict[str, float]()
    while True:
        fits = sorted(fits, key=lambda each: each.cost)
        shares = [shared(body, mask_rays([each], _GRID), fits[0].pose) for each in kept]
        worst = int(np.argmin(shares))
        if shares[worst] > LEAST_SHARED or len(kept) <= max(LEAST_MASKS, len(silhouettes) / 2):
            return kept, fits, others
        others[kept.pop(worst).path] = shares[worst]
        fits = [fit(body, kept, each.pose, _PLACES, _STEPS) for each in fits]


def _unlike(fits: list[PoseFit]) -> list[PoseFit]:
    """The best fits that are turned otherwise than all that are better."""
    chosen: list[PoseFit] = []
    for each in sorted(fits, key=lambda each: each.cost):
        if len(chosen) < _BEST and all(_turned(each, other) > _COARSELY_TURNED for other in chosen):
            chosen.append(each)
    return chosen


def _turned(first: PoseFit, second: PoseFit) -> float:
    """Radians between two poses."""
    return float(Rotation.from_matrix(first.pose.rotation @ second.pose.rotation.T).magnitude())


def _judged(
    body: OutlinedBody, silhouettes: Sequence[Silhouette], fits: list[PoseFit], others: dict[str, float]
) -> FoundPose:
    """The best of fits. Raises PoseError where it does not fit, or another one fits as well."""
    best = fits[0]
    share = shared(body, mask_rays(silhouettes, _GRID), best.pose)
    if share < LEAST_SHARED:
        raise PoseError(
            f"where it fits best the body shares {share:.0%} with the masks, allowed are {LEAST_SHARED:.0%} or more: "
            "is it the mesh of this body, in this unit, and do the masks show all of it?"
        )
    symmetric = _turns_freely(best)
    distances = [np.linalg.norm(each.pose.eye - best.pose.translation) / each.lens.fx for each in silhouettes]
    pixel = float(np.median(distances))
    for other in fits[1:]:
        if other.cost > _ALIKE * best.cost + _ALIKE_COST:
            continue
        apart = _apart(body, best, other)
        if apart > max(_SAME * best.off * pixel, _SAME_SHARE * body.surface.radius):
            raise PoseError(
                f"two poses fit as well, {apart:.2g} mm apart: state in `pose` about how it lies, or photograph from "
                "more sides"
            )
        symmetric |= _turned(other, best) > _TURNED
    degrees, mm = _deviations(body, silhouettes, best) if len(silhouettes) > 2 else (None, None)
    lowest = float(best.pose.places(body.surface.vertices)[:, 2].min())
    told = PoseByMasks(best.off, share, degrees, mm, len(silhouettes), symmetric, others, lowest)
    return FoundPose(best.pose, told)


def _apart(body: OutlinedBody, first: PoseFit, second: PoseFit) -> float:
    """How far, mm, the farthest hundredth of the surface in one pose is from that in another: nothing to speak of for
    a body that was turned about an axis of symmetry.
    """
    samples, triangles = body.surface.samples(_SAMPLES)
    here, there = first.pose.places(samples), second.pose.places(samples)
    normals = body.surface.normals[triangles] @ second.pose.rotation.T
    near = cKDTree(there).query(here, k=_NEAR)[1]
    beside = np.einsum("nkx,nkx->nk", here[:, None] - there[near], normals[near])
    return float(np.quantile(np.abs(beside).min(axis=1), 0.99))


def _deviations(body: OutlinedBody, silhouettes: Sequence[Silhouette], best: PoseFit) -> tuple[float, float]:
    """Of turns, degrees, and of the middle's place, mm: the jackknife over photographs, RMS over the three axes."""
    count = len(silhouettes)
    middle = best.pose.places(body.surface.middle[None])[0]
    steps = np.empty((count, 6))
    for number in range(count):
        others = [each for place, each in enumerate(silhouettes) if place != number]
        pose = fit(body, others, best.pose, _PLACES // 3, _COARSE_STEPS).pose
        steps[number, :3] = Rotation.from_matrix(pose.rotation @ best.pose.rotation.T).as_rotvec()
        steps[number, 3:] = pose.places(body.surface.middle[None])[0] - middle
    variances = (count - 1) * steps.var(axis=0)
    return float(np.degrees(np.sqrt(variances[:3].sum() / 3))), float(np.sqrt(variances[3:].sum() / 3))


def _turns_freely(best: PoseFit) -> bool:
    """Whether there is an axis about which a turn changes no outline to speak of."""
    turns, both, places = best.normal[:3, :3], best.normal[:3, 3:], best.normal[3:, 3:]
    alone = turns - both @ np.linalg.solve(places, both.T)
    return bool(np.linalg.eigvalsh(alone)[0] < _UNTOLD * np.trace(places) / 3)
