"""Where studies keep what is costly to make: one answer, whatever the environment says."""

from __future__ import annotations

from pathlib import Path

import pytest

from quadgraph import cli
from quadgraph.base.cache_folder import cache_folder


@pytest.mark.parametrize("value", ["", None, "elsewhere"])
def test_stability_keeps_its_truths_where_all_studies_keep_theirs(value, tmp_path, monkeypatch):
    if value is None:
        monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    else:
        monkeypatch.setenv("XDG_CACHE_HOME", value and str(tmp_path / value))
    expected = tmp_path / value / "quadgraph" if value else Path.home() / ".cache" / "quadgraph"
    added = cli.added_commands()
    args = cli.build_parser({}, added).parse_args(["stability"])
    assert args.truth == cache_folder() == expected
