"""What the similarity relation costs: walks that scatter forwards, and the study that holds the reduced ones beside."""

from __future__ import annotations

import numpy as np
import pytest

from quadgraph_validation.accuracy import similarity_study
from quadgraph_validation.truth import monte_carlo

WALKS = 10_000


@pytest.mark.parametrize("g", [-0.4, 0.3, 0.9])
def test_directions_scatter_by_henyey_and_greenstein(g):
    """Moments of the cosine are g and (1 + 2 g^2) / 3, and the azimuth is any."""
    generator = np.random.default_rng(3)
    before = monte_carlo.isotropic(40_000, generator)
    after = monte_carlo.scattered_from(before, g, generator)
    assert np.linalg.norm(after, axis=0) == pytest.approx(1, abs=1e-12)
    cosine = (before * after).sum(axis=0)
    assert cosine.mean() == pytest.approx(g, abs=0.015)  # five standard errors of the widest
    assert (cosine**2).mean() == pytest.approx((1 + 2 * g**2) / 3, abs=0.015)
    across = after - cosine * before
    assert np.abs(across.mean(axis=1)).max() < 0.015


def test_the_reduced_medium_is_another_body_where_light_scatters_little(monkeypatch):
    """On a ball of three mean free paths that absorbs much it is a fifth off; of no g it is the ball itself."""
    monkeypatch.setattr(similarity_study, "CASES", ((3.0, 0.6, 1.3),))
    monkeypatch.setattr(similarity_study, "FORWARD", (0.0, 0.5))
    record = similarity_study.run(None, WALKS)
    none, half = record["rows"]
    assert none["whole"]["error"] < 3 * none["whole"]["noise"]
    assert half["whole"]["error"] > 0.15
    assert half["unlit"]["error"] > 0.3
    assert similarity_study.tables(record)[0].row_count == 1
