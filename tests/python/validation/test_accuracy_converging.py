"""The study of pictures that converge: its record, its table, and one body by few walks."""

from __future__ import annotations

import pytest

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
pytest.importorskip("quadgraph_validation.truth.camera_walks", reason="needs the extra walks")
converging_study = pytest.importorskip("quadgraph_validation.accuracy.converging_study")

RUN = converging_study.ConvergingRun(501, 2, 100, 0.01, 10.0, "cpu")


def test_bodies_are_in_even_light_and_those_that_are_kept_are_not_made_again():
    """Seeds of even light are even; rows by their names are enough."""
    kept = converging_study.KeptRows(rows=[{"name": "502"}, {"name": "504"}])
    record = converging_study.run(RUN, kept)
    assert [row["name"] for row in record["rows"]] == ["502", "504"]
    assert (record["walks"], record["converge"], record["for_material"]) == (100, 0.01, False)


def test_the_table_has_what_is_stated_beside_what_is_true_and_marks_what_is_not_reached():
    row = {
        "seed": 502,
        "kind": "even",
        "eta": 1.3,
        "size": 10.0,
        "albedo": 0.9,
        "noise": 0.004,
        "true": {"uncorrected": 0.2, "one sweep": 0.03, "default": 0.02, "converged": 0.0123},
        "stated": {"one sweep": 0.05, "default": 0.025, "converged": 0.0145},
        "seconds": {"default": 2.0, "converged": 20.0},
        "reached": False,
        "steps": [{"solves": 1, "sweeps": 2}, {"solves": 7, "sweeps": 3}],
    }
    (table,) = converging_study.tables({"converge": 0.01, "seconds": 60.0, "rows": [row]})
    cells = [next(iter(column.cells)) for column in table.columns]
    assert cells[2:] == ["20.00", "3.00 (5.00)", "2.00 (2.50)", "1.23 (1.45)", "0.40", "7 of 3*", "2.0, 20.0"]


@pytest.mark.long
def test_a_picture_that_has_converged_is_not_further_off_than_twice_what_is_stated():
    record = converging_study.run(converging_study.ConvergingRun(506, 1, 1500, 0.02, 60.0, "cpu"))
    (row,) = record["rows"]
    assert row["true"]["converged"] < 0.5 * row["true"]["uncorrected"]
    assert row["true"]["converged"] < 2 * row["stated"]["converged"] + row["noise"]
    assert row["stated"]["converged"] <= row["stated"]["default"]
