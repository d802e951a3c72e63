"""The published scheme by itself, on radiances that are linear in kappa and sigma_a: no engine and no photographs."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import sparse

from quadgraph.acquisition.volume import published_fit
from quadgraph.acquisition.volume.published_fit import PublishedFit, descend
from quadgraph.acquisition.volume.volume_grid import VolumeGrid
from quadgraph.base.errors import InputError

GRID = VolumeGrid((0.0, 0.0, 0.0), 1.0, (3, 2, 2))
SQUARES = 40


@dataclass
class LinearModel:
    """Radiances of two photographs; the last square of each is lit."""

    matrix: np.ndarray
    absorption: np.ndarray
    scattering: np.ndarray
    asked: list[bool] = field(default_factory=list)

    @property
    def radiances(self) -> list[np.ndarray]:
        kappa = 1 / (3 * (self.absorption + self.scattering))
        both = np.concatenate([10 * kappa, self.absorption])
        return list(np.stack([1 + rows @ both for rows in self.matrix]))

    def lit(self) -> list[np.ndarray]:
        return [np.arange(SQUARES)[:, None] == SQUARES - 1 for _ in self.matrix]

    def back(self, weights: list[np.ndarray], only_operator: bool) -> tuple[np.ndarray, np.ndarray]:
        self.asked.append(only_operator)
        both = sum(rows.T @ weight for rows, weight in zip(self.matrix, weights, strict=True))
        total = self.absorption + self.scattering
        by_extinction = 10 * both[: GRID.count] * -1 / (3 * total**2)
        return both[GRID.count :] + by_extinction, by_extinction


class LinearSetting:
    """What PublishedFit reads of a setting, with data of known coefficients."""

    def __init__(self, gains: bool = False) -> None:
        random = np.random.default_rng(4)
        self.matrix = random.uniform(-1, 1, (2, SQUARES, 2 * GRID.count))
        self.grid, self.at_tets = GRID, sparse.eye_array(GRID.count, format="csr")
        self.true = random.uniform(0.015, 0.025, (GRID.count, 3)), random.uniform(0.9, 1.1, (GRID.count, 3))
        self.models: list[LinearModel] = []
        data = np.array(self.linearised_at(*self.true, "diffusion").radiances)
        data[:, -1] = 50  # what a light shines on says nothing
        self.data = np.concatenate(list(2 * data))  # exposures of 2
        one = np.ones(2)
        self.problem = SimpleNamespace(
            groups=["lamp"] if gains else [], exposure=2 * one, factor=one, capture=SimpleNamespace(path="capture.json")
        )
        squares = SimpleNamespace(counts=np.ones((SQUARES, 3), bool))
        self.samples = SimpleNamespace(squares=[squares, squares])

    def split(self, values: np.ndarray) -> list[np.ndarray]:
        return np.split(values, 2)

    def linearised_at(self, absorption: np.ndarray, scattering: np.ndarray, model: str) -> LinearModel:
        assert model == "diffusion"
        self.models.append(LinearModel(self.matrix, absorption, scattering))
        return self.models[-1]


def test_it_descends_to_what_the_data_say_and_ignores_what_is_lit(monkeypatch):
    monkeypatch.setattr(published_fit, "ENOUGH", 1e-9)
    monkeypatch.setattr(published_fit, "LAMBDA", 0.0)
    setting = LinearSetting()
    start = PublishedFit(setting).begin(np.array([[0.02] * 3, [1.0] * 3]))
    found, misfits = descend(start, lambda text: None)
    whole = np.array(misfits)
    assert (np.diff(whole, axis=0) <= 1e-12).all()
    assert (whole[-1] < 0.05 * whole[0]).all()
    kappa, absorption = found.unknowns
    true = 1 / (3 * (setting.true[0] + setting.true[1]))
    assert np.abs(kappa - true).max() < 0.5 * np.abs(1 / 3.06 - true).max()
    assert (absorption > 0).all()
    assert all(only for model in setting.models for only in model.asked)


def test_the_slopes_of_kappa_cost_as_published():
    setting = LinearSetting()
    start = PublishedFit(setting).begin(np.array([[0.02] * 3, [1.0] * 3]))
    tilt = np.zeros((2, GRID.count, 3))
    tilt[0] = 0.01 * GRID.points()[:, :1]
    # Two slopes of .01 in each of four rows of points.
    moved = start.moved(tilt)
    assert moved.cost - moved.misfit == pytest.approx(published_fit.LAMBDA * 8 * 1e-4)
    along = np.random.default_rng(5).normal(size=tilt.shape) * 1e-3
    slope = (moved.moved(1e-3 * along).cost - moved.moved(-1e-3 * along).cost) / 2e-3
    assert (moved.gradient() * along).sum(axis=(0, 1)) == pytest.approx(slope, rel=1e-6)


def test_unknown_gains_are_refused():
    with pytest.raises(InputError, match=r'capture\.json: photographs: unknown gains found, .* "gain" as a number'):
        PublishedFit(LinearSetting(gains=True))


def test_photographs_of_the_lit_side_alone_are_refused(monkeypatch):
    monkeypatch.setattr(LinearModel, "lit", lambda self: [np.ones((SQUARES, 1), bool)] * 2)
    with pytest.raises(InputError, match=r"no pixel found that no light shines on"):
        PublishedFit(LinearSetting()).begin(np.array([[0.02] * 3, [1.0] * 3]))
