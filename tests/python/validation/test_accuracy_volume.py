"""The study of `quadgraph acquire --volume`: its blocks, what it judges, and one draw recovered."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from quadgraph.acquisition.volume.volume_fit import VolumeFit
from quadgraph.acquisition.volume.volume_grid import VolumeGrid
from quadgraph_validation.accuracy import volume_study
from quadgraph_validation.accuracy.volume_study import SIDES, Ball, Block, VolumeRun


def fit_of(grid: VolumeGrid, absorption: np.ndarray, scattering: np.ndarray, deviation: float) -> VolumeFit:
    coefficients = np.stack([absorption, scattering])
    spread = np.full(coefficients.shape, deviation)
    inside, chi = np.ones(grid.count, bool), np.ones(3)
    return VolumeFit(grid, coefficients, spread, spread, inside, chi, np.ones((1, 3)), [], np.ones((1, 3)), [])


@pytest.mark.parametrize("per_mm", [0.5, 1.5])
def test_the_block_is_a_solid_of_its_sides(per_mm):
    surface = volume_study.block(per_mm)
    mesh = trimesh.Trimesh(surface.vertices, surface.triangles, process=False)
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(np.prod(SIDES), rel=1e-6)
    np.testing.assert_allclose(np.ptp(surface.vertices, axis=0), SIDES, rtol=1e-6)


def test_draws_are_those_of_their_seeds_and_lie_apart_in_the_block():
    assert volume_study.drawn(5) == volume_study.drawn(5) != volume_study.drawn(6)
    for seed in range(1, 30):
        case = volume_study.drawn(seed)
        dark, cloudy = (np.array(ball.middle) for ball in (case.dark, case.cloudy))
        assert np.linalg.norm(dark - cloudy) > case.dark.radius + case.cloudy.radius
        for ball in (case.dark, case.cloudy):
            assert (np.abs(np.array(ball.middle)) + ball.radius < SIDES / 2).all()
            assert ball.factor > 1.2


def test_the_truth_itself_is_judged_right_and_an_even_block_has_no_contrast():
    grid = VolumeGrid.around(np.stack([-SIDES, SIDES]) / 2, 0.5)
    case = volume_study.at_depth(2.5)
    scattering, absorption = volume_study.truth(case, grid.points())
    judged = volume_study.judged(case, fit_of(grid, absorption, scattering, 0.1))
    for name in ("sigma_a", "sigma_s_prime"):
        assert judged[name]["bias"] == pytest.approx([0] * 3, abs=1e-3)
        assert judged[name]["rms"] == pytest.approx([0] * 3, abs=1e-2)
        assert judged[name]["contrast"] == pytest.approx([1] * 3, abs=0.02)
        assert judged[name]["other_ball"] == pytest.approx([0] * 3, abs=1e-3)
        assert judged[name]["within_two_deviations_beside"] == 1
    even = np.ones_like(absorption)
    judged = volume_study.judged(case, fit_of(grid, 1.1 * volume_study.ABSORPTION * even, scattering, 0.01))
    assert judged["sigma_a"]["bias"] == pytest.approx([0.1] * 3)
    assert judged["sigma_a"]["contrast"] == pytest.approx([0] * 3, abs=1e-9)
    assert judged["sigma_a"]["within_two_deviations_beside"] == 0


@pytest.mark.long
def test_a_block_is_recovered(tmp_path, monkeypatch):
    """On a coarse mesh, with balls that are larger, for the time."""
    monkeypatch.setattr(volume_study, "_COARSE", 1.0)
    monkeypatch.setattr(volume_study, "_FINE", 1.5)
    monkeypatch.setattr(volume_study, "_PATCHES", 2)
    monkeypatch.setattr(volume_study, "_SPOT", {"angle": 10.0, "edge": 1.0, "power": 100.0})
    large = Block("draw", Ball((4, 0, 0.5), 3.0, 4.0), Ball((-4, 0, 0.5), 3.0, 2.0))
    monkeypatch.setattr(volume_study, "_cases", lambda wanted: iter([(large, wanted.schemes[0])]))
    record = volume_study.run(VolumeRun(1, 1, ("total-variation",), "cpu"))
    (row,) = record["rows"]
    assert min(row["sigma_s_prime"]["contrast"]) > 0.4
    assert max(np.abs(row["sigma_s_prime"]["bias"])) < 0.15
    assert row["relighting"] < 0.1
    assert record["within_two_deviations"]["sigma_s_prime"] > 0.6
    assert volume_study.tables(record)[0].row_count == 1
