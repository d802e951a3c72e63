"""`quadgraph accuracy` as a user runs it."""

from __future__ import annotations

import json

import pytest

from quadgraph import cli
from quadgraph_validation.accuracy import (
    coarse_study,
    cutoff_study,
    half_space_study,
    orders_study,
    radiance_study,
    similarity_study,
    slab_study,
    sphere_study,
)
from quadgraph_validation.commands.accuracy import ON_ENGINE, STUDIES

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

MODULES = {
    "slab": slab_study,
    "sphere": sphere_study,
    "half-space": half_space_study,
    "similarity": similarity_study,
    "cutoff": cutoff_study,
    "orders": orders_study,
    "coarse": coarse_study,
    "radiance": radiance_study,
}


def test_a_study_prints_its_table_and_records_it(tmp_path, capsys):
    path = tmp_path / "coarse.json"
    assert cli.main(["accuracy", "coarse", "--reference", "--json", str(path)]) == 0
    assert "marble R" in capsys.readouterr().out
    record = json.loads(path.read_text())
    assert record["study"] == "coarse"
    assert [row["layers"] for row in record["rows"]] == list(coarse_study.LAYERS)
    assert coarse_study.tables(record)[0].row_count == len(coarse_study.LAYERS)


def test_an_unknown_study_is_refused_with_the_list(capsys):
    with pytest.raises(SystemExit) as stop:
        cli.main(["accuracy", "bunny"])
    assert stop.value.code == 2
    assert "half-space" in capsys.readouterr().err


@pytest.mark.long
@pytest.mark.parametrize("study", [study for study in STUDIES if study not in ON_ENGINE])  # which have their own tests
def test_every_study_runs_on_the_engine(study, tmp_path):
    path = tmp_path / "record.json"
    assert cli.main(["accuracy", study, "--json", str(path)]) == 0
    assert MODULES[study].tables(json.loads(path.read_text()))
