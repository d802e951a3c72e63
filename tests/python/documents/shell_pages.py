"""The shell commands of the documents: read from their blocks, and what each would start, found without starting it."""

from __future__ import annotations

import argparse
import functools
import importlib
import os
import re
import subprocess
import sys
import tempfile
import tomllib
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from quadgraph import cli

ROOT = Path(__file__).resolve().parents[3]
PAGES = [
    path.relative_to(ROOT).as_posix()
    for path in [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
]
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
PROGRAMS = ("quadgraph", "quadgraph-engine")
# Options of the programs whose values are files that they write.
WRITES = ("-o", "--output", "--json", "--field", "--chart", "--images")

# Writes down what would be run, a line each, its words apart by the unit separator.
RECORDER = """
command_not_found_handle() {
  local IFS=$'\\x1f'
  printf '%s\\n' "$*" >>"$RECORD"
}
"""


@dataclass(frozen=True)
class Command:
    """A command as a page has it, with all lines of a loop or a function; `page` is relative to the root."""

    page: str
    text: str


def blocks(page: str, language: str) -> list[str]:
    """The contents of the fenced blocks of a language."""
    return [text for name, text in BLOCK.findall((ROOT / page).read_text()) if name == language]


# A program and its plain arguments: complete without asking bash, which takes a while for all pages.
PLAIN = re.compile(r"(?:quadgraph|quadgraph-engine|python|pip|tools/\w+)(?: [\w./:=,+%@-]+)*")


def _complete(text: str) -> bool:
    if PLAIN.fullmatch(text.strip()):
        return True
    return subprocess.run(["bash", "-n", "-c", text], capture_output=True).returncode == 0


@functools.cache
def commands(page: str) -> tuple[Command, ...]:
    """The commands of a page's shell blocks, in order, without the comments that follow them."""
    found = []
    for block in blocks(page, "sh"):
        gathered = ""
        for line in block.splitlines():
            gathered += ("\n" if gathered else "") + re.sub(r"(^|\s+)# .*", "", line)
            if gathered.strip() and not gathered.endswith("\\") and _complete(gathered):
                found.append(Command(page, gathered))
                gathered = ""
        assert not gathered.strip(), f"{page}: a block that bash does not take for complete: {gathered}"
    return tuple(found)


@functools.cache
def started(script: tuple[Command, ...]) -> tuple[tuple[str, ...], ...]:
    """The words of every program that a script would start: loops and variables are bash's to expand."""
    with tempfile.TemporaryDirectory() as name:
        folder, record = Path(name), Path(name) / "record"
        for made in ("out/tour", "nothing", "tools", ".venv/bin"):
            (folder / made).mkdir(parents=True)
        (folder / ".venv/bin/activate").touch()
        for tool in (ROOT / "tools").iterdir():
            (folder / "tools" / tool.name).write_text(f'#!/bin/bash\n{RECORDER}command_not_found_handle "$0" "$@"\n')
            (folder / "tools" / tool.name).chmod(0o755)
        record.touch()
        text = RECORDER + "\n".join(command.text for command in script)
        environment = {"PATH": str(folder / "nothing"), "RECORD": str(record)}
        subprocess.run(["/bin/bash", "-euc", text], cwd=folder, env=environment, check=True, capture_output=True)
        return tuple(tuple(line.split("\x1f")) for line in record.read_text().splitlines())


def written(script: tuple[Command, ...]) -> set[str]:
    """The files and folders that the programs of a script are told to write, `%04d` in a name as `*`."""
    files = set()
    for words in started(script):
        if words[0] in PROGRAMS:
            files |= {value for option, value in pairwise(words) if option in WRITES}
    return {re.sub(r"%0\dd", "*", name) for name in files}


@functools.cache
def exceptions() -> dict[str, dict[Command, str]]:
    """The reviewed list: `never` and `long`, reasons by commands; an entry without any is for the rest of its page."""
    found: dict[str, dict[Command, str]] = {"never": {}, "long": {}}
    listed = tomllib.loads((Path(__file__).parent / "exceptions.toml").read_text())
    for kind in ("never", "long"):
        for entry in listed[kind]:
            page = entry["page"]
            whole = [command for command in commands(page) if command not in found["never"]]
            named = [Command(page, text) for text in entry.get("commands", [])]
            found[kind] |= dict.fromkeys(named or whole, entry["reason"])
    return found


def script(page: str, *, long: bool) -> tuple[Command, ...]:
    """The commands of a page that a test runs: without those of `never`, and of `long` unless they are asked for."""
    left_out = exceptions()["never"] | ({} if long else exceptions()["long"])
    return tuple(command for command in commands(page) if command not in left_out)


@functools.cache
def parser() -> argparse.ArgumentParser:
    """The parser of `quadgraph`, with the subcommands of the validation."""
    own = {name: importlib.import_module(f"quadgraph.commands.{module}") for name, module in cli.SUBCOMMANDS.items()}
    return cli.build_parser(own, cli.added_commands())


def environment(folder: Path) -> dict[str, str]:
    """An environment with this interpreter's programs first, and with a cache of bodies in the folder."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    return os.environ | {"PATH": path, "XDG_CACHE_HOME": str(folder / "cache")}
