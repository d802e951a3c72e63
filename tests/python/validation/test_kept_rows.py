"""Long studies that are gone on with, row by row."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from quadgraph import cli
from quadgraph.base.errors import InputError
from quadgraph_validation.accuracy import kept_rows
from quadgraph_validation.accuracy.kept_rows import KeptRows

MADE = [(name, lambda name=name: {"length": len(name)}) for name in ("a", "bb", "ccc")]


def test_rows_that_are_there_are_not_made_again_and_each_new_one_is_written():
    told: list[str] = []
    written: list[list[str]] = []
    kept = KeptRows(
        (),
        [{"name": "bb", "length": 7}],
        lambda rows: written.append([row["name"] for row in rows]),
        told.append,
    )
    rows = kept.complete(MADE)
    assert [row["length"] for row in rows] == [1, 7, 3]
    assert told == ["a", "ccc"]
    assert written == [["a", "bb"], ["a", "bb", "ccc"]]


def test_only_what_is_wanted_is_made_and_what_is_there_stays():
    kept = KeptRows(("a",), [{"name": "ccc", "length": 3}])
    assert [row["name"] for row in kept.complete(MADE)] == ["a", "ccc"]
    assert [row["name"] for row in KeptRows((), [{"name": "d"}]).complete(MADE[:1])] == ["a", "d"]
    with pytest.raises(InputError, match="--scene: d found, allowed are a, bb, ccc"):
        KeptRows(("d",)).complete(MADE)


def test_a_record_of_something_else_is_refused(tmp_path: Path):
    path = tmp_path / "record.json"
    assert kept_rows.read(path, "acquire", walks=3) == []
    path.write_text(json.dumps({"study": "acquire", "walks": 3, "rows": [{"name": "a"}]}))
    assert kept_rows.read(path, "acquire", walks=3) == [{"name": "a"}]
    with pytest.raises(InputError, match="'walks': 3"):
        kept_rows.read(path, "acquire", walks=4)
    with pytest.raises(InputError, match="not a record"):
        kept_rows.read(path, "acquire", walks=3, light="sky")
    member = '{"study": "acquire", "walks": 3'
    for text in ("{", "[]", f"{member}}}", f'{member}, "rows": 1}}', f'{member}, "rows": [{{}}]}}'):
        path.write_text(text)
        with pytest.raises(InputError, match="not a record"):
            kept_rows.read(path, "acquire", walks=3)


def test_resume_needs_a_record_to_go_on_with(capsys):
    assert cli.main(["accuracy", "acquire", "--resume"]) == 1
    assert "--resume: found without --json" in capsys.readouterr().err
