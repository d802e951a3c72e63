"""The published inverse diffusion [PG Section 4, Table I], as a baseline for the fit of volume_fit.py.

Unknown are kappa and sigma_a at the points of the grid, in each channel by itself. Minimised is the sum of the squared
differences between radiances of pixels that no light shines on, over the mean square of these, plus LAMBDA times the
sum of the squared slopes of kappa; by Polak and Ribiere's conjugate gradients, with a golden section search along each
direction and the gradient of the continuous adjoint equation. Light is diffusion's, without any correction, and the
noise is not asked for. Not as published are the mesh (linear elements on tets in place of a polygrid), the buried
source, the gathered radiance, and bounds that keep coefficients above zero.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from quadgraph.acquisition.volume.linearised import Channels, Linearised
from quadgraph.acquisition.volume.volume_model import VolumeSetting
from quadgraph.base.errors import InputError
from quadgraph.base.progress import ProgressCallback

LAMBDA = 1e-5
ENOUGH = 1e-4  # of the squares of the data, that are left
MOST_STEPS = 40
SECTIONS = 9  # predictions of a search: the bracket is then 1/76 of what it was
_LONGEST = 0.5  # of a coefficient, what a search changes it by at most
_GAINED = 1e-3  # of the cost, that a step has to gain in some channel
_KAPPA, SIGMA = (1e-5, 1e3), (1e-7, 1e4)  # bounds of kappa, mm, and coefficients, 1/mm
_GOLDEN = (np.sqrt(5) - 1) / 2


@dataclass(frozen=True, eq=False)
class PublishedVolume:
    """A volume and its predictions. unknowns (2, n, 3): kappa in mm and sigma_a in 1/mm."""

    fit: PublishedFit
    unknowns: np.ndarray

    @cached_property
    def model(self) -> Linearised:
        """Diffusion around it."""
        kappa, absorption = (np.asarray(self.fit.at_tets @ each) for each in self.unknowns)
        scattering = np.maximum(1 / (3 * kappa) - absorption, 0)
        return self.fit.setting.linearised_at(absorption, scattering, "diffusion")

    @cached_property
    def left(self) -> Channels:
        """Predicted less measured radiances, 0 where a light shines."""
        pairs = zip(self.model.radiances, self.fit.measured, self.fit.unlit, strict=True)
        return [np.where(unlit, predicted - measured, 0) for predicted, measured, unlit in pairs]

    @cached_property
    def misfit(self) -> np.ndarray:
        """(3,) of the squares of the data."""
        return sum((each**2).sum(axis=0) for each in self.left) / self.fit.scale

    @cached_property
    def cost(self) -> np.ndarray:
        """(3,) what is minimised."""
        kappa = self.unknowns[0]
        return self.misfit + LAMBDA * (kappa * (self.fit.slopes @ kappa)).sum(axis=0)

    def gradient(self) -> np.ndarray:
        """(2, n, 3) of the cost by the continuous adjoint equation."""
        weights = [2 * each / self.fit.scale for each in self.left]
        by_absorption, by_scattering = self.model.back(weights, only_operator=True)
        kappa = np.asarray(self.fit.at_tets @ self.unknowns[0])
        by_kappa = self.fit.at_tets.T @ (-by_scattering / (3 * kappa**2))
        return np.stack(
            [
                np.asarray(by_kappa) + 2 * LAMBDA * (self.fit.slopes @ self.unknowns[0]),
                np.asarray(self.fit.at_tets.T @ (by_absorption - by_scattering)),
            ]
        )

    def moved(self, step: np.ndarray) -> PublishedVolume:
        """Further along a step (2, n, 3), within the bounds."""
        kappa, absorption = self.unknowns + step
        return PublishedVolume(self.fit, np.stack([np.clip(kappa, *_KAPPA), np.clip(absorption, *SIGMA)]))


class PublishedFit:
    """The data of a setting as the published scheme takes them. measured and unlit: radiances of all squares, and
    whether they count; scale (3,): sum of the squares of those that do; slopes (n, n): matrix of the squared slopes.
    """

    def __init__(self, setting: VolumeSetting) -> None:
        """Raise InputError where gains are unknown, or no square is unlit."""
        problem = setting.problem
        if problem.groups:
            raise InputError(
                f"{problem.capture.path}: photographs: unknown gains found, the published scheme has none; state each "
                '"gain" as a number, or use another --scheme'
            )
        self.setting, self.at_tets = setting, setting.at_tets
        known = problem.exposure * problem.factor
        self.measured = [values / of for values, of in zip(setting.split(setting.data), known, strict=True)]
        self.unlit: list[np.ndarray] = []
        self.slopes: sparse.csr_array = sum(each.T @ each for each in setting.grid.differences())
        self.scale = np.ones(3)

    def begin(self, coefficients: np.ndarray) -> PublishedVolume:
        """The same coefficients (2, 3), 1/mm, throughout."""
        absorption, scattering = coefficients
        kappa = 1 / (3 * (absorption + scattering))
        start = PublishedVolume(
            self, np.repeat(np.stack([kappa, absorption])[:, None, :], self.setting.grid.count, axis=1)
        )
        lit = start.model.lit()
        counts = (each.counts for each in self.setting.samples.squares)
        self.unlit = [counted & ~shone for counted, shone in zip(counts, lit, strict=True)]
        if not any(each.any() for each in self.unlit):
            raise InputError(
                f"{self.setting.problem.capture.path}: photographs: no pixel found that no light shines on, of which "
                "the published scheme has its data; photograph the unlit side, too, or use another --scheme"
            )
        pairs = zip(self.measured, self.unlit, strict=True)
        self.scale = sum((np.where(unlit, each, 0) ** 2).sum(axis=0) for each, unlit in pairs)
        return start


def descend(start: PublishedVolume, tell: ProgressCallback) -> tuple[PublishedVolume, list[np.ndarray]]:
    """The minimum, and the misfits (3,) of all steps: until ENOUGH, MOST_STEPS, or a step that gains little."""
    at, misfits = start, [start.misfit]
    descent = -at.gradient()
    direction = descent
    for number in range(MOST_STEPS):
        step = _searched(at, direction)
        following = at.moved(step)
        misfits.append(following.misfit)
        tell(f"step {number + 1}: misfit {', '.join(f'{100 * np.sqrt(each):.3g}%' for each in following.misfit)}")
        gained = (at.cost - following.cost).max() > _GAINED * at.cost.max()
        at = following
        if (at.misfit < ENOUGH).all() or not gained:
            break
        before, descent = descent, -at.gradient()
        size = np.maximum((before**2).sum(axis=(0, 1)), 1e-300)
        direction = descent + np.maximum((descent * (descent - before)).sum(axis=(0, 1)) / size, 0) * direction
    return at, misfits


def _searched(at: PublishedVolume, direction: np.ndarray) -> np.ndarray:
    """The step along a direction, of the length that is best in each channel by golden section."""
    relative = np.abs(direction) / at.unknowns
    longest = _LONGEST / np.maximum(relative.max(axis=(0, 1)), 1e-300)

    def cost(length: np.ndarray) -> np.ndarray:
        return at.moved(length * direction).cost

    low, high = np.zeros(3), longest
    inner = [high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)]
    costs = [cost(each) for each in inner]
    for _ in range(SECTIONS - 2):
        left = costs[0] < costs[1]
        low, high = np.where(left, low, inner[0]), np.where(left, inner[1], high)
        kept, cost_kept = np.where(left, inner[0], inner[1]), np.where(left, costs[0], costs[1])
        new = low + high - kept
        cost_new = cost(new)
        inner = [np.where(left, new, kept), np.where(left, kept, new)]
        costs = [np.where(left, cost_new, cost_kept), np.where(left, cost_kept, cost_new)]
    best = np.where(costs[0] < costs[1], inner[0], inner[1])
    # No step where every length made it worse.
    return np.where(np.minimum(*costs) < at.cost, best, 0) * direction
