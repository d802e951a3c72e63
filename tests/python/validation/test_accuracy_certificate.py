"""The study of certificates: one body, and how bodies are put together."""

from __future__ import annotations

import pytest

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
pytest.importorskip("quadgraph_validation.truth.mesh_walk", reason="needs the extra walks")
certificate_study = pytest.importorskip("quadgraph_validation.accuracy.certificate_study")


def row(kind: str, deviation: float, stated: float, error: float, noise: float) -> dict:
    part = {"power": 0.0, "power_noise": 0.01, "error": error, "error_noise": noise}
    parts = certificate_study.PARTS
    return {
        "kind": kind,
        "deviations": {"whole": deviation},
        "stated": dict.fromkeys(parts, stated),
        "certificate": dict.fromkeys(parts, part),
    }


def test_deviations_and_ratios_are_put_together_where_they_can_be_told():
    rows = [row("even", 1.0, 0.02, 0.01, 0.001), row("even", -2.5, 0.01, 0.02, 0.001)]
    rows.append(row("veins", 4.0, 9.0, 0.01, 0.01))
    found = certificate_study.summary(rows)
    assert found["deviations"]["even"] == {"powers": 2, "within": [0.5, 1.0]}
    assert found["deviations"]["mixed"] == {"powers": 1, "within": [0.0, 0.0]}
    assert found["ratios"]["whole"]["cases"] == 2  # the third is no more than its noise
    assert found["ratios"]["whole"]["of"] == pytest.approx([0.5, 1.25, 2.0])
    assert len(certificate_study.tables({"rows": [], "summary": found})) == 3


@pytest.mark.long
def test_certificates_of_unseen_bodies_agree_with_walks_that_share_nothing():
    record = certificate_study.run(certificate_study.CertificateRun(401, 4, 10.0, 1_000_000, "cpu"))
    assert all(abs(z) < 6 for found in record["rows"] if found["kind"] == "even" for z in found["deviations"].values())
    for found in record["rows"]:
        assert found["certificate"]["given_up"] == 0
        assert not found["certificate"]["disagreement"]
