"""The parts of a volume's recovery by themselves: grid, smoothing, deviations and weights, without photographs."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import sparse

from quadgraph import core
from quadgraph.acquisition.volume import posterior
from quadgraph.acquisition.volume.smoothing import Smoothing
from quadgraph.acquisition.volume.volume_grid import VolumeGrid

GRID = VolumeGrid((-3.0, 1.0, 0.5), 0.75, (5, 4, 6))


def test_coefficients_lie_between_points_as_the_engine_takes_them(tmp_path):
    pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
    random = np.random.default_rng(1)
    coefficients = random.uniform(0.1, 2, (2, GRID.count, 3))
    GRID.material(coefficients, 1.3).save(tmp_path / "volume.npz")
    points = np.array(GRID.low) + random.uniform(-1.5, 6, (200, 3))  # some of them beside the grid
    scattering, absorption = core.Volume(tmp_path / "volume.npz").at(points.astype(np.float32), (0, 0, 0))
    weights = GRID.weights(points)
    np.testing.assert_allclose(weights @ coefficients[0], absorption, rtol=2e-5)
    np.testing.assert_allclose(weights @ coefficients[1], scattering, rtol=2e-5)


def test_a_grid_holds_its_points_and_knows_slopes():
    points = np.random.default_rng(2).uniform(-4, 7, (50, 3))
    found = VolumeGrid.around(points, 1.3)
    low, high = np.array(found.low), np.array(found.low) + 1.3 * (np.array(found.size) - 1)
    assert (points >= low).all()
    assert (points <= high).all()
    assert (high - low < np.ptp(points, axis=0) + 1.3).all()
    slope = np.array([0.5, -2.0, 3.0])
    for axis, difference in enumerate(found.differences()):
        along = (difference @ (found.points() @ slope)).reshape(found.size[::-1])
        inside = np.take(along, range(found.size[axis] - 1), axis=2 - axis)
        np.testing.assert_allclose(inside, slope[axis])
        assert not np.take(along, -1, axis=2 - axis).any()


def smoothing(edges: bool = True) -> Smoothing:
    random = np.random.default_rng(3)
    return Smoothing(GRID, random.uniform(0.2, 1, GRID.count), np.ones((2, GRID.count)), 0.05, edges)


@pytest.mark.parametrize("edges", [True, False])
def test_the_matrices_are_the_slope_of_the_smoothing(edges):
    random = np.random.default_rng(4)
    logs = random.normal(size=(2, GRID.count, 3)) * np.geomspace(1e-3, 1, GRID.count)[:, None]
    along = random.normal(size=logs.shape)
    step = 1e-6
    smooth = smoothing(edges)
    change = (smooth.cost(logs + step * along) - smooth.cost(logs - step * along)) / (2 * step)
    matrices = smooth.matrices(logs)
    expected = 2 * sum(float((along[k] * (matrices[k] @ logs[k])).sum()) for k in range(2))
    assert change == pytest.approx(expected, rel=1e-6)
    assert smooth.cost(np.ones_like(logs)) == 0


def test_slopes_of_twice_the_size_cost_four_times_as_much_without_edges():
    logs = np.random.default_rng(4).normal(size=(2, GRID.count, 3))
    slopes = smoothing(edges=False)
    assert slopes.cost(2 * logs) == pytest.approx(4 * slopes.cost(logs))
    assert smoothing().cost(2 * logs) < 2.1 * smoothing().cost(logs)


def test_one_edge_costs_the_same_in_one_channel_as_its_norm_in_three():
    """Vectorial: edges of several channels at one place are cheaper than at several."""
    z = GRID.points()[:, 2]
    together, apart = np.zeros((2, 2, GRID.count, 3))
    for channel in range(3):
        together[0, :, channel] = z > 2.0
        apart[0, :, channel] = z > 1.0 + 0.75 * channel
    smooth = Smoothing(GRID, np.ones(GRID.count), np.ones((2, GRID.count)), 1e-9)
    assert smooth.cost(apart) / smooth.cost(together) == pytest.approx(np.sqrt(3), rel=1e-6)


@pytest.mark.parametrize("rank", [30, 80])
def test_deviations_are_those_of_the_dense_matrix_or_more_where_the_rank_falls_short(rank):
    """And what is resolved is the diagonal of 1 - C L, or less."""
    random = np.random.default_rng(5)
    smooth = smoothing().matrices(np.zeros((2, GRID.count, 3)))
    told = [np.square(9 * random.normal(size=(1, 1))) * (g.T @ g) for g in random.normal(size=(3, rank, 240))]

    def along(direction: np.ndarray) -> np.ndarray:
        return np.stack([told[k] @ direction[..., k].ravel() for k in range(3)], axis=1).reshape(direction.shape)

    found = posterior.known(along, smooth, (2, GRID.count, 3))
    least = [matrix + 1e-6 * matrix.diagonal().max() * sparse.eye_array(GRID.count) for matrix in smooth]
    for channel in range(3):
        whole = told[channel] + sparse.block_diag(least).toarray()
        covariance = np.linalg.inv(whole)
        ratio = found.deviations[..., channel] / np.sqrt(np.diag(covariance)).reshape(2, -1)
        resolved = np.diag(np.eye(len(whole)) - covariance @ sparse.block_diag(least).toarray()).reshape(2, -1)
        assert (ratio > 1 - 1e-4).all()
        assert found.resolved[..., channel].sum() < resolved.sum() * (1 + 1e-4)
        if rank <= posterior.RANK:
            assert (ratio < 1 + 1e-4).all()
            np.testing.assert_allclose(found.resolved[..., channel], resolved, atol=1e-4)
    lengths = found.lengths(GRID.spacing)
    assert (lengths >= GRID.spacing).all()
    np.testing.assert_allclose((GRID.spacing / lengths) ** 3, np.maximum(found.resolved, 1 / GRID.count))
