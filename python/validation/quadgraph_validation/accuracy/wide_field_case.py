"""The wide-field example of redbirdpy: a block in parallel light that falls on a square, and what leaves it in patches.

A block of 60 x 60 x 30 mm about the origin; light along z onto the middle 40 x 40 mm of its lowest face, and a detector
as large opposite. All is per watt that enters.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from quadgraph.tets.graph import Graph
from quadgraph_validation.bodies import meshes
from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.truth import pmmc_field

SIDES = np.array([60.0, 60.0, 30.0])  # mm
HALF = 20.0  # mm, of the lit square and of the detector
ETA = 1.37
MEDIUM = Medium(1.0, 0.005)
PATCH = 5.0  # mm
REGIONS = ("lit", "unlit front", "back", "sides")
_BATCHES = 10
_SLICE = 1.0  # mm, of the fluence at the detector
_HALVES = SIDES / 2
# Across each face, and whether it is the upper one.
_FACES = [(axis, upper) for axis in range(3) for upper in (False, True)]


@dataclass(frozen=True)
class Left:
    """What leaves of a watt that entered: faces, W/mm^2 by patches of each of the six faces, whose order is x, y, z and
    of each the lower one first; detector: mean fluence 1/(sigma_a + sigma_s') below the detector, W/mm^2, NaN untold.
    """

    faces: list[np.ndarray]
    detector: float

    def regions(self) -> dict[str, np.ndarray]:
        """The patches of REGIONS, (n,) each."""
        front, back = self.faces[4], self.faces[5]
        middle = (np.arange(len(front)) + 0.5) * PATCH - _HALVES[0]
        lit = (np.abs(middle) < HALF)[:, None] & (np.abs(middle) < HALF)[None]
        sides = np.concatenate([face.ravel() for face in self.faces[:4]])
        return {"lit": front[lit], "unlit front": front[~lit], "back": back.ravel(), "sides": sides}

    @property
    def power(self) -> float:
        """W."""
        return float(sum(face.sum() for face in self.faces)) * PATCH**2

    def symmetric(self) -> Left:
        """The mean over all that the block's symmetries carry into each other."""
        ends = []
        for face in self.faces[4:]:
            turned = [face, face[::-1], face[:, ::-1], face[::-1, ::-1]]
            ends.append(np.mean([*turned, *(each.T for each in turned)], axis=0))
        side = np.mean([each for face in self.faces[:4] for each in (face, face[::-1])], axis=0)
        return Left([side] * 4 + ends, self.detector)


def in_patches(position: np.ndarray, power: np.ndarray, detector: float) -> Left:
    """Of powers (n,) W that leave at (n, 3) mm."""
    faces = []
    for axis, upper in _FACES:
        there = np.abs(position[:, axis] - (_HALVES[axis] if upper else -_HALVES[axis])) < 1e-3
        across = [k for k in range(3) if k != axis]
        edges = [np.linspace(-_HALVES[k], _HALVES[k], round(SIDES[k] / PATCH) + 1) for k in across]
        places = np.clip(position[there][:, across], -_HALVES[across] + 1e-6, _HALVES[across] - 1e-6)
        first, second = places.T
        faces.append(np.histogram2d(first, second, edges, weights=power[there])[0] / PATCH**2)
    return Left(faces, detector)


def detector_points() -> np.ndarray:
    """(n, 3) mm, spread evenly where the detector has its fluence."""
    along = (np.arange(40) + 0.5) / 40 * 2 * HALF - HALF
    x, y = (part.ravel() for part in np.meshgrid(along, along))
    return np.column_stack([x, y, np.full(len(x), _HALVES[2] - 1 / MEDIUM.sigma_t)])


def walked(body: Graph, walks: int, seed: int) -> Left:
    """By pmmc through a body's tets. Raises InputError as pmmc_walk.load does."""
    found = pmmc_field.square(body, MEDIUM, ETA, HALF, walks, seed)
    middles = body.vertices[body.tets].mean(axis=1)
    deep = _HALVES[2] - 1 / MEDIUM.sigma_t
    there = (np.abs(middles[:, :2]) < HALF).all(axis=1) & (np.abs(middles[:, 2] - deep) < _SLICE / 2)
    corners = body.vertices[body.tets[there]]
    volume = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1]))
    share = found.entered / found.walks
    detector = float(np.average(found.fluence[there], weights=volume)) / share
    return in_patches(found.position, found.weight / found.entered, detector)


@dataclass(frozen=True)
class Truth:
    """mean: over batches of walks, made symmetric; error: standard errors of that."""

    mean: Left
    error: Left
    power_error: float


def truth(walks: int, tell: Any) -> Truth:
    """By pmmc through few tets, which do not matter to it. tell: is given what is done."""
    half = _SLICE / 2
    deep = _HALVES[2] - 1 / MEDIUM.sigma_t
    across = np.array([-30.0, -20.0, 0.0, 20.0, 30.0])
    body = meshes.box(across, across, np.array([-15.0, 0.0, deep - half, deep + half, 15.0]), meshes.no_wall)
    batches = []
    for number in range(_BATCHES):
        tell(f"truth, {number + 1} of {_BATCHES}")
        batches.append(walked(body, max(walks // _BATCHES, 1), 1000 + number).symmetric())
    scale = 1 / np.sqrt(_BATCHES - 1)
    faces = [np.array([each.faces[k] for each in batches]) for k in range(len(_FACES))]
    detectors, powers = np.array([each.detector for each in batches]), np.array([each.power for each in batches])
    error = Left([face.std(axis=0) * scale for face in faces], float(detectors.std() * scale))
    mean = Left([face.mean(axis=0) for face in faces], float(detectors.mean()))
    return Truth(mean, error, float(powers.std() * scale))


def judged(found: Left, true: Truth) -> dict[str, Any]:
    """Relative: of the power that leaves, of the detector, and RMS over the patches of each region, of their RMS, with
    the truth's own noise in them, `noise`.
    """
    exact, noise = true.mean.regions(), true.error.regions()
    rms = {name: _rms(values - exact[name]) / _rms(exact[name]) for name, values in found.regions().items()}
    return {
        "power": found.power / true.mean.power - 1,
        "detector": found.detector / true.mean.detector - 1,
        "rms": rms,
        "noise": {name: _rms(noise[name]) / _rms(exact[name]) for name in REGIONS},
    }


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt((values**2).mean()))
