"""Documents and comments: what they point to is there."""

from __future__ import annotations

import functools
import re
import subprocess
from pathlib import Path
from urllib.parse import unquote

import pytest
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
DOCUMENTS = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "SECURITY.md", *sorted(DOCS.rglob("*.md"))]
CODE_FOLDERS = ("engine", "shaders", "python", "tools", "tests")
CODE_SUFFIXES = {".h", ".cpp", ".glsl", ".comp", ".vert", ".frag", ".py", ""}

FENCE = re.compile(r"^(```|~~~).*?^\1", re.MULTILINE | re.DOTALL)
CODE_SPAN = re.compile(r"`([^`\n]+)`")
LINK = re.compile(r"\]\(([^()\s]+)\)")
HEADING = re.compile(r"^#+ +(.+?) *$", re.MULTILINE)
TREE_PATH = re.compile(rf"(?:{'|'.join(CODE_FOLDERS)})/[\w./-]*[\w/]")

ENTRY = re.compile(r"^- \*\*\[(?P<tag>[^\]]+)\]\*\* (?P<author>[^,]+),.*?\((?P<year>(?:19|20)\d\d)\)", re.MULTILINE)
YEAR = r"(?:19|20)\d\d"
NAME = r"(?:[Vv]an )?[A-Z][a-zé]+"
# "[QG Eq. 5-6]", "[QG, PG; Groenhuis et al. 1983]", "[Saad 2003, 6.7.3]"; not an array's index or a link's text.
PLACE = r"(?:Eq|Fig|Section|Appendix|Table|\d)"
BRACKETED = re.compile(rf"(?<![\w\])])\[(?=(?:QG|PG|SOP|[A-Z]{{2,4}} {PLACE})|[^\]]*\b{YEAR}\b)([^\]\[]+)\](?!\()")
# "Klose and Larsen 2006", "Jensen et al. (2001)", "Ju, Schaefer and Warren 2005", "Perlin 1985".
BY_NAME = re.compile(rf"({NAME})(?:(?:, {NAME})*,? and {NAME}|, {NAME}| et al\.)?,? \(?({YEAR})\b")
SHORT_TAG = re.compile(r"[A-Z]{2,4}")
NOT_AUTHORS = {"Eurographics", "Schema"}
NAMED_PAGE = re.compile(r"(?:(docs/)|\b)([a-z]+(?:-[a-z]+)*\.md)\b(?:, \\?\"([^\"\\\n]+)\\?\")?")


def code_files() -> list[Path]:
    """All files whose comments are read, but this one."""
    paths = (path for folder in CODE_FOLDERS for path in sorted((ROOT / folder).rglob("*")))
    sources = (path for path in paths if path.suffix in CODE_SUFFIXES and path.is_file())
    return [path for path in sources if path != Path(__file__).resolve()]


def prose(path: Path) -> str:
    """A document without its blocks of code."""
    return FENCE.sub("", path.read_text())


def on_one_line(text: str) -> str:
    """Text or comments with their line breaks taken away."""
    return re.sub(r"\s*\n\s*(?:(?://|#)\s*)?", " ", text)


def anchor(heading: str) -> str:
    """The anchor that GitHub makes of a heading."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "").lower()
    return "".join(c for c in text if c.isalpha() or c.isdecimal() or c in " -_").replace(" ", "-")


@functools.cache
def headings(path: Path) -> tuple[str, ...]:
    return tuple(HEADING.findall(prose(path)))


@functools.cache
def anchors(path: Path) -> set[str]:
    """Anchors of a document's headings; one that comes again is counted, as GitHub does."""
    found: set[str] = set()
    for name in map(anchor, headings(path)):
        count = 0
        while (name if count == 0 else f"{name}-{count}") in found:
            count += 1
        found.add(name if count == 0 else f"{name}-{count}")
    return found


@functools.cache
def references() -> tuple[set[str], set[tuple[str, str]]]:
    """Tags of docs/references.md, and (first author, year) of its entries."""
    entries = list(ENTRY.finditer(prose(DOCS / "references.md")))
    return {e["tag"] for e in entries}, {(e["author"].lower(), e["year"]) for e in entries}


def unresolved(text: str) -> list[str]:
    """Citations in a text that docs/references.md does not have."""
    tags, works = references()
    text, missing = on_one_line(text), []
    for bracket in BRACKETED.findall(text):
        parts = [part.strip() for part in re.split(r"[;,]", bracket)]
        short = [tag for tag in (part.split(" ")[0] for part in parts) if SHORT_TAG.fullmatch(tag)]
        missing += [tag for tag in short if tag not in tags]
    for author, year in BY_NAME.findall(text):
        if author not in NOT_AUTHORS and (author.lower(), year) not in works:
            missing.append(f"{author} {year}")
    return missing


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_lead_somewhere(path):
    broken = []
    for target in LINK.findall(CODE_SPAN.sub("", prose(path))):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, fragment = target.partition("#")
        file = (path.parent / unquote(name)).resolve() if name else path
        if not file.exists() or (fragment and fragment not in anchors(file)):
            broken.append(target)
    assert not broken


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_paths_of_the_tree_exist(path):
    names = {name for span in CODE_SPAN.findall(prose(path)) for name in [span.strip()] if TREE_PATH.fullmatch(name)}
    assert not sorted(name for name in names if not (ROOT / name).exists())


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_citations_of_documents_resolve(path):
    assert not unresolved(prose(path))


def test_a_citation_of_nothing_is_found():
    text = "[QG Eq. 2, XY Eq. 3] and (Nobody and\n// Noone 1999; Klose and Larsen 2006), [DP 2.1], row[Q 2001]"
    assert unresolved(text) == ["XY", "DP", "Nobody 1999"]


def test_citations_of_comments_resolve():
    missing = {str(path.relative_to(ROOT)): unresolved(path.read_text()) for path in code_files()}
    assert not {name: found for name, found in missing.items() if found}


def test_pages_that_comments_name_exist_with_their_headings():
    """`docs/physics.md, "SP3"`: a page by its path, physics.md always with a heading."""
    wrong = []
    for path in code_files():
        for folder, page, heading in NAMED_PAGE.findall(on_one_line(path.read_text())):
            file = DOCS / page
            by_path = folder and file.is_file()
            if page in ("physics.md", "design.md") or folder:
                known = by_path and (heading in headings(file) if heading else page != "physics.md")
                if not known:
                    wrong.append(f"{path.relative_to(ROOT)}: {folder}{page} {heading}".rstrip())
    assert not wrong


def test_every_reference_is_cited():
    cited = "\n".join(prose(path) for path in DOCUMENTS if path.name != "references.md")
    cited += "\n".join(path.read_text() for path in code_files())
    cited = on_one_line(cited)
    named = {(author.lower(), year) for author, year in BY_NAME.findall(cited)}
    for entry in ENTRY.finditer(prose(DOCS / "references.md")):
        by_name = (entry["author"].lower(), entry["year"]) in named
        assert by_name or re.search(rf"\b{re.escape(entry['tag'])}\b", cited), entry["tag"]


def test_the_readme_is_short_with_one_picture_on_its_first_screen():
    text = (ROOT / "README.md").read_text()
    first, _, rest = text.partition("\n## Install\n")
    pictures = [re.findall(r"!\[[^\]]+\]\(([^)]+)\)", part) for part in (first, rest)]
    assert len(text.splitlines()) <= 80
    assert [len(each) for each in pictures] == [1, 1]
    for each in (*pictures[0], *pictures[1]):
        with Image.open(ROOT / each) as picture:
            assert picture.width >= 1200


def test_every_page_is_in_the_index():
    linked = {(DOCS / target.partition("#")[0]).resolve() for target in LINK.findall(prose(DOCS / "index.md"))}
    assert not sorted(str(path) for path in set(DOCUMENTS) - linked if path.name != "index.md")


def test_the_glossary_is_in_order():
    terms = re.findall(r"^\*\*(.+?)\*\*", prose(DOCS / "glossary.md"), re.MULTILINE)
    assert len(terms) > 50
    assert terms == sorted(terms, key=str.casefold)
    assert len(set(terms)) == len(terms)


def test_every_folder_has_its_sentence():
    """The folder table of docs/architecture.md and the folders with tracked files are the same set."""
    table = prose(DOCS / "architecture.md").partition("\n## Folders\n")[2].partition("\n## ")[0]
    rows = re.findall(r"^\| `([^`]+)/` \| \S", table, re.MULTILINE)
    if not (ROOT / ".git").exists():
        pytest.skip("not a checkout of git: tracked folders are unknown")
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    tracked = {Path(name).parent.as_posix() for name in listed.split("\0") if name}
    assert sorted(rows) == sorted(tracked)
