"""Rows of the documents' tables have as many cells as their heads."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")])
NO_BAR = re.compile(r"\\\||\$?`[^`]*`\$?")  # an escaped one, code and mathematics


def broken_rows(text: str) -> list[tuple[int, str]]:
    """Numbers, from 1, and the beginnings of rows that are wider or narrower than the first row of their table."""
    found, head, fenced = [], None, False
    for number, line in enumerate(text.splitlines(), 1):
        fenced ^= line.startswith("```")
        if fenced or not line.startswith("|"):
            head = None
            continue
        cells = NO_BAR.sub("", line).count("|")
        head = head or cells
        if cells != head:
            found.append((number, line[:60]))
    return found


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_rows_are_as_wide_as_their_table(page):
    assert broken_rows(page.read_text()) == []


def test_a_broken_row_is_found():
    rows = "| a | b |\n|---|---|\n| `x|y` | $`|z|`$ |\n| 1 | 2 | 3 |\n| 1 |\n\n| c |\n|---|\n"
    assert broken_rows(rows) == [(4, "| 1 | 2 | 3 |"), (5, "| 1 |")]
