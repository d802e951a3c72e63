"""docs/python.md names all that is public, and no document goes past it to the compiled module."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
DOCUMENTS = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]


def test_the_page_names_what_is_public():
    listed = tomllib.loads((ROOT / "docs/public_api.toml").read_text())
    rows = re.findall(r"^\| `(\w+)` \|", (ROOT / "docs/python.md").read_text(), re.MULTILINE)
    assert sorted(rows) == sorted(listed)


def test_no_document_imports_the_compiled_module():
    wrong = re.compile(r"import _core\b|import quadgraph\._core\b")
    assert not [path.name for path in DOCUMENTS if wrong.search(path.read_text())]
