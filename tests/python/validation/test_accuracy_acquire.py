"""The study of `quadgraph acquire`: what it draws, what it judges, and one body recovered from walks."""

from __future__ import annotations

import numpy as np
import pytest

from quadgraph.api.materials import Material
from quadgraph.baking.pipeline import check_options
from quadgraph_validation.accuracy import acquire_study
from quadgraph_validation.accuracy.acquire_study import AcquireRun


def row(true: list[list[float]], found: list[list[float]], deviation: float) -> dict:
    fit = {"coefficients": found, "deviations": np.full((2, 3), deviation).tolist(), "chi_squared": [1.0] * 3}
    return {"name": "body", "true": true, "known": fit, "unknown": fit}


def test_random_bodies_and_materials_are_those_of_their_seeds():
    first, second = (acquire_study.drawn(seed) for seed in (3, 4))
    assert first == acquire_study.drawn(3)
    assert first != second
    for material in (first, second):
        scattering, absorption = np.array(material.sigma_s_prime), np.array(material.sigma_a)
        depth = (scattering + absorption) * acquire_study.LENGTH
        assert ((depth > 4.9) & (depth < 61)).all()
        assert (absorption > 0).all()
    surface = acquire_study.body(3)
    assert np.ptp(surface.vertices, axis=0).max() == pytest.approx(acquire_study.LENGTH, rel=1e-4)
    np.testing.assert_array_equal(surface.vertices, acquire_study.body(3).vertices)
    assert not np.array_equal(surface.vertices, acquire_study.body(4).vertices)


def test_coefficients_are_judged_by_size_and_by_what_is_said_of_them():
    true = [[0.01, 0.02, 0.0001], [1.0, 1.0, 1.0]]
    found = [[0.0105, 0.03, 0.0003], [1.04, 1.06, 1.0]]
    judged = row(true, found, 0.3)
    relative, deviations = acquire_study.off(judged, "known")
    np.testing.assert_allclose(relative, [[0.05, 0.5, 2.0], [0.04, 0.06, 0]], atol=1e-12)
    assert deviations[0, 1] == pytest.approx(np.log(1.5) / 0.3)
    shares = acquire_study.summary([judged])["known"]
    assert shares["sigma_s_prime_within_5_percent"] == pytest.approx(2 / 3)
    # Of the palest channel, three deviations off: neither within 10% nor within two.
    assert shares["sigma_a_within_10_percent_or_pale_and_two_deviations"] == pytest.approx(1 / 3)
    assert shares["within_two_deviations"] == pytest.approx({"sigma_a": 2 / 3, "sigma_s_prime": 1.0})
    wide = acquire_study.summary([row(true, found, 1.0)])["known"]
    assert wide["sigma_a_within_10_percent_or_pale_and_two_deviations"] == pytest.approx(2 / 3)


def test_what_absorbs_nothing_is_judged_by_what_is_found_beside_scattering():
    relative, deviations = acquire_study.off(row([[0.0] * 3, [2.0] * 3], [[0.001] * 3, [2.0] * 3], 0.1), "known")
    np.testing.assert_allclose(relative[0], 0.0005)
    assert np.isfinite(deviations).all()


@pytest.mark.parametrize("name", acquire_study.measured())
def test_a_bake_for_each_measured_material_is_allowed(name, tmp_path):
    """Also for one that absorbs nothing."""
    check_options(tmp_path / "body.qgraph", acquire_study.bake_options(Material.parse(name)))


@pytest.mark.long
def test_a_body_is_recovered_from_walks(monkeypatch):
    monkeypatch.setattr(acquire_study, "measured", list)
    record = acquire_study.run(AcquireRun(seed=1, count=1, walks=2048, device="cpu"))
    relative, deviations = acquire_study.off(record["rows"][0], "known")
    assert (np.abs(relative) < 0.2).all()
    assert (np.abs(deviations) < 4).all()
    assert [table.row_count for table in acquire_study.tables(record)] == [1, 2]
