"""What MkDocs is told about these pages: files outside docs/, links to them, formulae, and pages made of the code."""

from __future__ import annotations

import os
import posixpath
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from latex2mathml.converter import convert

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.files import Files
    from mkdocs.structure.pages import Page

sys.path.insert(0, str(Path(__file__).parent))

import reference_pages

ROOT = Path(__file__).resolve().parents[2]
# Documents beside docs/, and the pages of the site that show them.
OUTSIDE = {
    "README.md": "project/readme.md",
    "CONTRIBUTING.md": "project/contributing.md",
    "SECURITY.md": "project/security.md",
    "CHANGELOG.md": "project/changes.md",
    "third_party/README.md": "project/third-party.md",
    "LICENSE": "project/licence.md",
}
FENCE = re.compile(r"^(```|~~~).*?^\1$", re.MULTILINE | re.DOTALL)
DISPLAYED = re.compile(r"^```math\n(.*?)^```$", re.MULTILINE | re.DOTALL)
INLINE = re.compile(r"\$`([^`]+)`\$")
PRIME_ABOVE = re.compile(r"<msubsup>((?:(?!<msubsup>).)*?)<mi>&#x02032;</mi></msubsup>")
PRIME = re.compile(r"<msup>((?:(?!<msup>).)*?)<mi>&#x02032;</mi></msup>")
LINK = re.compile(r"\]\(([^()\s:#]+)(#[^()\s]*)?\)")


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Leave out of the navigation what is not there (yet): pages that neither docs/ has nor the hooks make."""
    made = {*OUTSIDE.values(), *reference_pages.PAGES}
    config.nav = _present(config.nav, lambda name: name in made or (Path(config.docs_dir) / name).is_file())
    return config


def _present(entries: list, known) -> list:
    kept = []
    for entry in entries:
        if isinstance(entry, str):
            kept += [entry] if known(entry) else []
            continue
        (title, value), *_ = entry.items()
        if isinstance(value, list):
            kept.append({title: _present(value, known)})
        elif known(value):
            kept.append(entry)
    return kept


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the documents beside docs/ and the pages of the reference, and leave pictures of studies' truth out."""
    from mkdocs.structure.files import File

    for name, target in OUTSIDE.items():
        text = (ROOT / name).read_text()
        files.append(File.generated(config, target, content=f"# Licence\n\n{text}" if name == "LICENSE" else text))
    for target, make in reference_pages.PAGES.items():
        files.append(File.generated(config, target, content=make(ROOT)))
    files.append(File.generated(config, "site.css", content=(Path(__file__).parent / "site.css").read_text()))
    shim = ROOT / "third_party/iframe-worker/shim.js"
    files.append(File.generated(config, "iframe-worker.js", content=shim.read_text()))
    for file in [file for file in files if file.src_uri.startswith("benchmarks/truth/")]:
        files.remove(file)
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Show formulae as MathML, which browsers draw by themselves, and lead links that leave docs/ to their pages."""
    text = DISPLAYED.sub(lambda found: _formula(found[1], "block"), markdown)
    pieces, end = [], 0
    for fence in FENCE.finditer(text):
        pieces += [_prose(text[end : fence.start()], page.file.src_uri), fence[0]]
        end = fence.end()
    return "".join([*pieces, _prose(text[end:], page.file.src_uri)])


def _formula(latex: str, display: str) -> str:
    made = convert(" ".join(latex.split()), display=display)
    # A prime as a superscript would be raised twice: fonts without a table for mathematics draw it raised already.
    made = PRIME_ABOVE.sub(r"<mrow><msub>\1</msub><mo>&#x02032;</mo></mrow>", made)
    made = PRIME.sub(r"<mrow>\1<mo>&#x02032;</mo></mrow>", made)
    return f'<div class="formula">{made}</div>' if display == "block" else made


def _prose(text: str, page: str) -> str:
    text = INLINE.sub(lambda found: _formula(found[1], "inline"), text)
    return LINK.sub(lambda found: f"]({_target(found[1], page)}{found[2] or ''})", text)


def _target(link: str, page: str) -> str:
    """A link of a page as one between pages of the site."""
    origin = next((name for name, target in OUTSIDE.items() if target == page), f"docs/{page}")
    path = posixpath.normpath(posixpath.join(posixpath.dirname(origin), link))
    inside = OUTSIDE.get(path, path.removeprefix("docs/") if path.startswith("docs/") else None)
    return link if inside is None else os.path.relpath(inside, posixpath.dirname(page) or ".")
