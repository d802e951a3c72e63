"""One of many independent runs, and the content by which its result is known again."""

from __future__ import annotations

import functools
import hashlib
import importlib.util
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from quadgraph.base import regular_file
from quadgraph.base.errors import InputError

_ENGINE = "quadgraph._core"  # compiled; found, not imported


@dataclass(frozen=True)
class Task:
    """A pure function with its arguments.

    name: for people; function: "package.module:function", which takes the arguments as keywords, returns what is ready
    for JSON and writes files whole or not at all; arguments: ready for JSON; reads, writes: its files; folder: where
    relative paths and texts that name files begin.
    """

    name: str
    function: str
    arguments: Mapping[str, Any]
    reads: tuple[Path, ...] = ()
    writes: tuple[Path, ...] = ()
    folder: Path = field(default_factory=Path.cwd)

    def content(self) -> dict[str, Any]:
        """Everything that its result follows from, ready for JSON. Raises InputError where a file cannot be read."""
        package = self.function.partition(":")[0].partition(".")[0]
        return {
            "function": self.function,
            "arguments": dict(self.arguments),
            "code": {name: code_of(name) for name in sorted({"quadgraph", package})},
            "reads": {str(path): _sha256_of(self.folder / path) for path in self.reads},
        }

    def order(self, ledger: Path) -> str:
        """The task as text that any process can work by; ledger: folder in which it notes what is finished."""
        document = {
            "name": self.name,
            "function": self.function,
            "arguments": dict(self.arguments),
            "reads": [str(path) for path in self.reads],
            "writes": [str(path) for path in self.writes],
            "folder": str(self.folder),
            "content": self.content(),
            "ledger": str(ledger.absolute()),
        }
        return json.dumps(document)


def of_order(document: Mapping[str, Any]) -> Task:
    """The task of an order's document."""
    reads, writes = (tuple(map(Path, document[name])) for name in ("reads", "writes"))
    given = (document["name"], document["function"], document["arguments"])
    return Task(*given, reads, writes, Path(document["folder"]))


def key_of(content: Mapping[str, Any]) -> str:
    """SHA-256 of a content."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def sha256_of(path: Path) -> str:
    """Of a file's bytes. Raises InputError where it cannot be read."""
    try:
        return hashlib.sha256(regular_file.read_bytes(path)).hexdigest()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error


def _sha256_of(path: Path) -> str:
    """As `sha256_of`, read once as long as nothing writes to the file: many frames show one body."""
    try:
        found = path.stat()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error
    return _of_state(path, found.st_mtime_ns, found.st_size)


@functools.lru_cache(maxsize=4096)
def _of_state(path: Path, _modified: int, _size: int) -> str:
    return sha256_of(path)


@functools.cache
def code_of(package: str) -> str | None:
    """SHA-256 of an installed package's modules, the compiled engine among quadgraph's; None where it is not there."""
    found = importlib.util.find_spec(package)
    if found is None:
        return None
    digest = hashlib.sha256()
    for place in map(Path, found.submodule_search_locations or ()):
        for path in sorted(place.rglob("*.py")):
            digest.update(f"{path.relative_to(place)} ".encode() + path.read_bytes())
    engine = importlib.util.find_spec(_ENGINE) if package == "quadgraph" else None
    for file in (each.origin for each in (found, engine) if each is not None and each.origin):
        digest.update(Path(file).read_bytes())
    return digest.hexdigest()
