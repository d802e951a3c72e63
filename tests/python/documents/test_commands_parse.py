"""Every command of the documents can be read by the program that it is for: a stale option or value fails at once."""

from __future__ import annotations

import re
import shlex
import subprocess
from pathlib import Path

import pytest
from shell_pages import BLOCK, PAGES, PROGRAMS, ROOT, commands, exceptions, parser, started

import quadgraph
from engine_program import ENGINE
from quadgraph import cli
from quadgraph.commands import own_material

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
pytest.importorskip("quadgraph_validation", reason="quadgraph-validation is not installed: run tools/setup")

STANDING_FOR = {"STUDY": "slab", "SCENE": "sphere", "N": "1"}
WITH_COMMANDS = [page for page in PAGES if commands(page)]


def prose(page: str) -> str:
    """A page without its blocks of code."""
    return BLOCK.sub("", (ROOT / page).read_text())


@pytest.fixture
def demonstrated(tmp_path, monkeypatch):
    """A current folder like that of a reader after tools/demo: the documents' files, and out/ to write to."""
    (tmp_path / "docs").symlink_to(ROOT / "docs")
    (tmp_path / "out").mkdir()
    monkeypatch.chdir(tmp_path)
    return tmp_path


def engine_fault(words: list[str], folder: Path) -> str:
    """What quadgraph-engine says of its options, of a body that is not there; nothing where they can be read."""
    if ENGINE is None:
        return ""
    without_window = [] if "--headless" in words else ["--headless", "-o", str(folder / "picture.png")]
    whole = [ENGINE, str(folder / "nothing.qgraph"), *words, *without_window]
    said = subprocess.run(whole, capture_output=True, text=True, timeout=60).stderr
    return "" if "nothing.qgraph: cannot be read" in said else said


def fault(words: tuple[str, ...], folder: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """What is wrong with a command line, in the words of its program; nothing where it can be read."""
    if words[0] == "quadgraph-engine":
        return engine_fault([*words[2:]], folder)
    try:
        args = parser().parse_args(cli.join_negative_values(words[1:]))
    except SystemExit as end:
        return capsys.readouterr().err if end.code else ""
    try:
        material = getattr(args, "material", None)
        if isinstance(material, str) and own_material.is_own(material):
            own_material.options_of(material, args.file)
        elif isinstance(material, str) and not material.endswith(".npz"):  # the file of a volume, not there yet
            quadgraph.Material.parse(material)
        quadgraph.core.picture_light(getattr(args, "light", None) or [])
    except quadgraph.QuadGraphError as error:
        return str(error)
    return engine_fault(args.options, folder) if args.command == "view" else ""


@pytest.mark.parametrize("page", WITH_COMMANDS)
def test_every_command_can_be_read(page, demonstrated, capsys):
    lines = [words for words in started(commands(page)) if words[0] in PROGRAMS]
    faults = {" ".join(words): fault(words, demonstrated, capsys) for words in lines}
    assert {line: said for line, said in faults.items() if said} == {}


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("quadgraph render a.qgraph --materiel jade -o a.png", "--materiel"),
        ("quadgraph render a.qgraph --material jaed -o a.png", "jaed"),
        ("quadgraph render a.qgraph --light directional:0,0:1 -o a.png", "directional"),
        ("quadgraph render a.qgraph --method femm -o a.png", "femm"),
        ("quadgraph accuracy slabs", "slabs"),
        ("quadgraph view a.qgraph --longest 40mm", "--longest"),
        ("quadgraph-engine a.qgraph --headless --methods fem", "--methods"),
    ],
)
def test_a_stale_command_is_found(line, said, tmp_path, capsys):
    if ENGINE is None and ("view" in line or "engine" in line):
        pytest.skip("quadgraph-engine is not built: run tools/setup")
    assert said in fault(tuple(line.split()), tmp_path, capsys)


@pytest.mark.parametrize("page", PAGES)
def test_commands_in_sentences_can_be_read(page, demonstrated, capsys):
    """Spans of code that begin with a subcommand and an argument; STUDY and the like stand for one."""
    spans = re.findall(rf"`(quadgraph (?:{'|'.join([*cli.SUBCOMMANDS, *cli.VALIDATION])}) [^`]+)`", prose(page))
    lines = [tuple(STANDING_FOR.get(word, word) for word in shlex.split(span)) for span in spans]
    faults = {" ".join(words): fault(words, demonstrated, capsys) for words in lines}
    assert {line: said for line, said in faults.items() if said} == {}


@pytest.mark.parametrize("page", PAGES)
def test_commands_stand_in_blocks_of_their_own(page):
    """A block without a language, or an indented one, would be read by no test."""
    text = (ROOT / page).read_text()
    indented = ("    quadgraph", "    tools/", "    pip ")
    assert not [line for line in prose(page).splitlines() if line.startswith(indented)]
    bare = [content for name, content in BLOCK.findall(text) if name not in ("sh", "python")]
    assert not [line for content in bare for line in content.splitlines() if line.startswith(PROGRAMS)]


@pytest.mark.parametrize("kind", ["never", "long"])
def test_no_exception_is_stale(kind):
    """What is left out of a run is on its page, once in the list, and has a reason."""
    listed = exceptions()[kind]
    assert not [command for command in listed if command not in commands(command.page)]
    assert not [command for command in listed if not listed[command].strip()]
    assert not exceptions()["never"].keys() & exceptions()["long"].keys()
