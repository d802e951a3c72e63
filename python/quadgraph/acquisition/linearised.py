"""All photographs as a function of what each tet is made of, uncorrected, and its derivative."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from quadgraph.acquisition.prediction import Predictor
from quadgraph.acquisition.problem import Problem
from quadgraph.acquisition.samples import Samples
from quadgraph.api.derivatives import Views

Channels = list[np.ndarray]  # (n, 3) of each photograph's squares


class Linearised:
    """Radiances of the squares of all photographs around some coefficients of a level's tets, W/(mm^2 sr)."""

    def __init__(
        self,
        problem: Problem,
        predictor: Predictor,
        samples: Samples,
        level: int,
        coefficients: tuple[np.ndarray, np.ndarray],
        advance: Callable[[], None],
    ) -> None:
        """coefficients: sigma_a and sigma_s_prime of the tets, (n_t, 3) 1/mm each. Raises InputError, SolverError."""
        sets: dict[tuple[str, ...], list[int]] = {}
        for number, one in enumerate(problem.measured):
            sets.setdefault(one.stated.lights, []).append(number)
        self._groups = list(sets.values())
        self._ends = [np.cumsum([len(samples.squares[each].rays) for each in group])[:-1] for group in self._groups]
        self._models = []
        for lights, group in sets.items():
            chosen = [
                (samples.views[problem.measured[each].stated.camera], samples.squares[each].rays) for each in group
            ]
            views = Views(*(np.concatenate([np.asarray(of[k])[rays] for of, rays in chosen]) for k in range(3)))
            self._models.append(predictor.model(lights, level, coefficients, views))
            advance()
        self.radiances = self._split([model.outgoing.radiance for model in self._models])

    def along(self, absorption: np.ndarray, scattering: np.ndarray) -> Channels:
        """How radiances change when the coefficients of the tets, (n_t, 3), change so."""

        def one(number: int) -> np.ndarray:
            return self._models[number].jvp(sigma_a=absorption, sigma_s_prime=scattering).radiance

        return self._split(self._each(one))

    def back(self, weights: Channels) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives of the sum of radiances times weights by sigma_a and sigma_s_prime of the tets, (n_t, 3) each."""

        def one(number: int) -> tuple[np.ndarray, np.ndarray]:
            mine = np.concatenate([weights[each] for each in self._groups[number]])
            found = self._models[number].vjp(radiance=mine)
            return found.sigma_a, found.sigma_s_prime

        found = self._each(one)
        return sum(a for a, _ in found), sum(s for _, s in found)

    def _each(self, one: Callable) -> list:
        """Of all models, side by side, in their order."""
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            return list(pool.map(one, range(len(self._models))))

    def _split(self, radiances: Sequence[np.ndarray]) -> Channels:
        result: Channels = [np.empty((0, 3))] * sum(map(len, self._groups))
        for group, ends, whole in zip(self._groups, self._ends, radiances, strict=True):
            for number, part in zip(group, np.split(whole, ends), strict=True):
                result[number] = part
        return result
