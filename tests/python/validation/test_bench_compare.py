"""`quadgraph bench --compare`: what counts as slower, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from quadgraph import cli
from quadgraph.base.errors import InputError
from quadgraph_validation.benchmark import comparison, figures

ABOUT = {"schema": figures.SCHEMA, "commit": "abc", "device": "abacus", "driver": "beads 9", "cores": 2, "load": 0.1}


def record(**values: figures.Figure) -> dict[str, Any]:
    """A record of these figures, whose names have a slash for each underscore."""
    return ABOUT | {"version": "1", "figures": {name.replace("_", "/"): figure for name, figure in values.items()}}


def ms(median: float, spread: float | None = 0.1, runs: int = 5) -> figures.Figure:
    return {"value": median, "unit": "ms", "spread": spread, "runs": runs}


def verdict(old: figures.Figure, new: figures.Figure) -> str:
    """The verdict on the one figure of two records."""
    (change,) = comparison.compare(record(frame_ms=old), record(frame_ms=new)).changes
    return change.verdict


def run(tmp_path: Path, old: str, new: str) -> int:
    """The exit status of a comparison of files with these contents."""
    paths = [tmp_path / "old.json", tmp_path / "new.txt"]
    for path, text in zip(paths, (old, new), strict=True):
        path.write_text(text)
    return cli.main(["bench", "--compare", *map(str, paths)])


def test_a_change_beyond_the_noise_is_named_either_way():
    assert verdict(ms(10), ms(11)) == "slower"
    assert verdict(ms(11), ms(10)) == "faster"
    assert verdict(ms(10), ms(10)) == ""


def test_the_noise_is_that_of_the_runs():
    assert verdict(ms(10, spread=1), ms(11, spread=1)) == ""
    assert verdict(ms(10, spread=1, runs=3), ms(13, spread=1, runs=3)) == ""
    assert verdict(ms(10, spread=1, runs=30), ms(13, spread=1, runs=30)) == "slower"


def test_less_than_two_percent_is_no_change_however_quiet_the_runs():
    assert verdict(ms(100, spread=0.001), ms(101.9, spread=0.001)) == ""
    assert verdict(ms(100, spread=0.001), ms(102.1, spread=0.001)) == "slower"


def test_a_time_taken_once_is_not_judged_and_a_count_is():
    assert verdict(ms(10), ms(99, spread=None, runs=1)) == "not judged"
    assert verdict(figures.count(5, "cycles"), figures.count(6, "cycles")) == "slower"
    assert verdict(figures.count(0, "cycles"), figures.count(0, "cycles")) == ""


def test_the_same_runs_again_are_named_no_oftener_than_promised():
    chance, rng = 0.05, np.random.default_rng(1)
    named = 0
    for old, new in rng.normal(100, 5, size=(4000, 2, 5)):
        before, after = figures.times(old), figures.times(new)
        named += after["value"] - before["value"] > comparison.noise(before, after, chance)
    assert 0.5 * chance < named / 4000 < 1.2 * chance


def test_more_figures_leave_as_few_false_alarms():
    old, new = {f"a{n}": ms(10) for n in range(100)}, {f"a{n}": ms(10.4) for n in range(100)}
    assert comparison.compare(record(a0=old["a0"]), record(a0=new["a0"])).names("slower") == ["a0"]
    assert comparison.compare(record(**old), record(**new)).names("slower") == []


def test_figures_are_medians_and_standard_deviations():
    assert figures.times([3.0, 1.0, 2.0]) == {"value": 2.0, "unit": "ms", "spread": 1.0, "runs": 3}
    assert figures.times([3.0])["spread"] is None


def test_the_exit_status_says_whether_something_is_slower(tmp_path, capsys):
    old = record(frame_light_ms=ms(10), walk_ms=ms(5))
    same = "a table\n\n" + figures.line(old) + "\n"
    assert run(tmp_path, json.dumps(old, indent=1), same) == 0
    assert "2 figures: 0 slower, 0 faster" in capsys.readouterr().out
    slower = figures.line(record(frame_light_ms=ms(12), walk_ms=ms(4)) | {"commit": "def"})
    assert run(tmp_path, json.dumps(old, indent=1), slower) == 3
    printed = capsys.readouterr().out
    for words in ("slower: frame/light/ms", "faster: walk/ms", "+20.0%", "commit: abc before, def after"):
        assert words in printed


def test_missing_figures_are_an_error_after_the_table_and_new_ones_are_told(tmp_path, capsys):
    old, new = record(frame_ms=ms(10), walk_ms=ms(5)), record(frame_ms=ms(10), gather_ms=ms(5))
    assert run(tmp_path, figures.line(old), figures.line(new)) == 1
    printed = capsys.readouterr()
    assert "lacks 1 figures of the old one: walk/ms" in printed.err
    assert "only in the new run: gather/ms" in printed.out
    assert "frame/ms" in printed.out


def test_names_are_shown_as_they_are(tmp_path, capsys):
    odd = ABOUT | {"version": "1", "figures": {"[/red]\x1b[2J": ms(10), ":warning:": ms(1)}}
    assert run(tmp_path, figures.line(odd), figures.line(odd)) == 0
    printed = capsys.readouterr().out
    assert ":warning:" in printed
    assert "[/red]\\x1b[2J" in printed


def test_another_device_a_unit_changed_and_nothing_in_common_are_refused():
    old = record(frame_ms=ms(10))
    with pytest.raises(InputError, match=r"abacus before, slide rule after"):
        comparison.compare(old, old | {"device": "slide rule"})
    with pytest.raises(InputError, match=r"frame/ms: unit ms before, cycles after"):
        comparison.compare(old, record(frame_ms=figures.count(3, "cycles")))
    with pytest.raises(InputError, match=r"no figure in common: frame/ms before, walk/ms after"):
        comparison.compare(old, record(walk_ms=ms(10)))


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"schema": "quadgraph-bench/2"}, "schema: quadgraph-bench/2 found, quadgraph-bench/1 allowed"),
        ({"device": None}, "device: a text"),
        ({"figures": {}}, "figures: 1 to"),
        ({"figures": {str(n): ms(1) for n in range(10_001)}}, "figures: 1 to"),
        ({"figures": {"a": 3}}, "figures: a: value, unit"),
        ({"figures": {"a": ms(-1)}}, "figures: a: value"),
        ({"figures": {"a": ms(float("nan"))}}, "figures: a: value"),
        ({"figures": {"a": ms(10**400)}}, "figures: a: value"),
        ({"figures": {"a": ms(True)}}, "figures: a: value"),
        ({"figures": {"a": ms(1) | {"unit": "furlongs"}}}, "figures: a: unit: one of ms"),
        ({"figures": {"a": ms(1) | {"unit": ["ms"]}}}, "figures: a: unit: one of ms"),
        ({"figures": {"a": ms(1, spread=float("inf"))}}, "figures: a: spread"),
        ({"figures": {"a": {"value": 1, "unit": "ms", "runs": 1}}}, "figures: a: spread"),
        ({"figures": {"a": ms(1, runs=0)}}, "figures: a: runs"),
        ({"figures": {"a": ms(1, runs=10**12)}}, "figures: a: runs"),
    ],
)
def test_a_record_with_a_wrong_field_is_refused_by_its_name(tmp_path, change, told):
    path = tmp_path / "record.json"
    path.write_text(json.dumps(record(frame_ms=ms(10)) | change))
    with pytest.raises(InputError) as caught:
        comparison.read(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert told in str(caught.value)


@pytest.mark.parametrize(
    "text",
    ["", "no JSON\n", '{"schema": ', "\x00", '"text"', "[" * 100_000, "9" * 5000, "[]", "null"],
    ids=["empty", "words", "cut", "zero", "text", "deep", "digits", "list", "null"],
)
def test_what_is_no_record_is_refused(tmp_path, text):
    path = tmp_path / "record.json"
    path.write_text(text)
    with pytest.raises(InputError, match=r"record\.json: (neither the file|schema)"):
        comparison.read(path)


def test_a_file_that_cannot_be_read_is_refused(tmp_path, monkeypatch):
    with pytest.raises(InputError, match="cannot be read"):
        comparison.read(tmp_path / "missing.json")
    with pytest.raises(InputError, match="cannot be read"):
        comparison.read(tmp_path)
    (tmp_path / "bytes").write_bytes(b"\xff\xfe{}")
    with pytest.raises(InputError, match="neither"):
        comparison.read(tmp_path / "bytes")
    with (tmp_path / "large").open("wb") as file:
        file.truncate((64 << 20) + 1)
    with pytest.raises(InputError, match="more than 64 MiB"):
        comparison.read(tmp_path / "large")


@pytest.mark.parametrize("option", [["--passes"], ["body.qgraph"], ["--json", "out.json"], ["--device", "abacus"]])
def test_comparing_measures_nothing(tmp_path, capsys, option):
    assert cli.main(["bench", *option, "--compare", str(tmp_path / "old"), str(tmp_path / "new")]) == 1
    assert "--compare measures nothing" in capsys.readouterr().err
