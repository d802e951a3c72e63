"""The study of balls that scatter forwards: what it holds against walks, and that g takes most of the error away."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
forward_study = pytest.importorskip("quadgraph_validation.accuracy.forward_study", reason="needs the extra walks")


@pytest.mark.long
def test_by_two_moments_most_of_what_the_reduced_coefficient_misses_is_there(monkeypatch):
    monkeypatch.setattr(forward_study, "CASES", ((3.0, 0.6, 1.3),))
    monkeypatch.setattr(forward_study, "FORWARD", (0.8,))
    record = forward_study.run("cpu", Path(), (), walks=60_000)
    (row,) = record["rows"]
    error = {by: {part: off["error"] for part, off in row[by].items()} for by in ("reduced", "with_g")}
    assert error["with_g"]["whole"] < 0.4 * error["reduced"]["whole"]
    assert error["with_g"]["unlit"] < 0.4 * error["reduced"]["unlit"]
    assert error["reduced"]["whole"] > 0.15
    assert row["with_g"]["whole"]["noise"] < 0.045
    assert 0.5 * error["with_g"]["whole"] < row["stated"][0] < 0.3
    assert forward_study.tables(record)[0].row_count == 1
