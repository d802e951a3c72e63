"""All photographs as a function of what each tet is made of, uncorrected, and its derivative."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np

from quadgraph.acquisition.model.prediction import Predictor
from quadgraph.acquisition.model.problem import Problem
from quadgraph.acquisition.volume.samples import Samples
from quadgraph.api.derivatives import Views

Channels = list[np.ndarray]  # (n, 3) of each photograph's squares


class UnderLights(NamedTuple):
    """Photographs under the same lights: their numbers, the rays of all their squares, and where each's end but for
    the last.
    """

    lights: tuple[str, ...]
    photographs: list[int]
    views: Views
    ends: np.ndarray


def by_lights(problem: Problem, samples: Samples) -> list[UnderLights]:
    """All photographs, by the lights that were on."""
    result = []
    for first in dict.fromkeys(problem.alike.tolist()):
        group = np.flatnonzero(problem.alike == first).tolist()
        chosen = [(samples.views[problem.measured[each].stated.camera], samples.squares[each].rays) for each in group]
        views = Views(*(np.concatenate([np.asarray(of[k])[rays] for of, rays in chosen]) for k in range(3)))
        ends = np.cumsum([len(rays) for _, rays in chosen])[:-1]
        result.append(UnderLights(problem.measured[first].stated.lights, group, views, ends))
    return result


class Linearised:
    """Radiances of the squares of all photographs around some coefficients of a level's tets, W/(mm^2 sr)."""

    def __init__(
        self,
        predictor: Predictor,
        groups: Sequence[UnderLights],
        level: int,
        coefficients: tuple[np.ndarray, np.ndarray],
        advance: Callable[[], None],
        model: str = "sp3",
    ) -> None:
        """coefficients: sigma_a and sigma_s_prime of the tets, (n_t, 3) 1/mm each; model: of the fluence. Raises
        InputError, SolverError.
        """
        self._groups = groups
        self._models = []
        for each in groups:
            self._models.append(predictor.model(each.lights, level, coefficients, each.views, model))
            advance()
        self.radiances = self._split([model.outgoing.radiance for model in self._models])

    def along(self, absorption: np.ndarray, scattering: np.ndarray) -> Channels:
        """How radiances change when the coefficients of the tets, (n_t, 3), change so."""

        def one(number: int) -> np.ndarray:
            return self._models[number].jvp(sigma_a=absorption, sigma_s_prime=scattering).radiance

        return self._split(self._each(one))

    def lit(self) -> list[np.ndarray]:
        """(n, 1) of each photograph's squares: whether a light shines on the face where its ray leaves."""
        shone = [
            np.any(model.entering > 0, axis=1, keepdims=True)[np.asarray(each.views.face)]
            for model, each in zip(self._models, self._groups, strict=True)
        ]
        return self._split(shone)

    def back(self, weights: Channels, only_operator: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives of the sum of radiances times weights by sigma_a and sigma_s_prime of the tets, (n_t, 3) each.

        only_operator: as `ForwardModel.vjp` has it.
        """

        def one(number: int) -> tuple[np.ndarray, np.ndarray]:
            mine = np.concatenate([weights[each] for each in self._groups[number].photographs])
            found = self._models[number].vjp(radiance=mine, only_operator=only_operator)
            return found.sigma_a, found.sigma_s_prime

        found = self._each(one)
        return sum(a for a, _ in found), sum(s for _, s in found)

    def _each(self, one: Callable) -> list:
        """Of all models, side by side, in their order."""
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            return list(pool.map(one, range(len(self._models))))

    def _split(self, radiances: Sequence[np.ndarray]) -> Channels:
        result: Channels = [np.empty((0, 3))] * sum(len(each.photographs) for each in self._groups)
        for each, whole in zip(self._groups, radiances, strict=True):
            for number, part in zip(each.photographs, np.split(whole, each.ends), strict=True):
                result[number] = part
        return result
