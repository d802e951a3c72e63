"""The text of all shader files, and the structs and arrays that they declare."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

Texts = dict[str, str]  # files by their path below shaders/

KINDS = {".h", ".glsl", ".comp", ".vert", ".frag"}
STAGES = {".comp", ".vert", ".frag"}
INCLUDE = re.compile(r'^#include "([^"]+)"', re.M)
DECLARATION = re.compile(r"\s*(?:QG_REF\((\w+)\)|(\w+))\s+(\w.*);\s*")
ARRAY = re.compile(r"^QG_(?:COHERENT_|ALIGNED_)?ARRAY\((\w+), (\w+)", re.M)
HEADED = re.compile(r"^QG_HEADED_ARRAY\((\w+), (\w+), (\w+), (\w+)\);", re.M)
BLOCK = re.compile(r"^layout\(buffer_reference[^)]*\)[a-z ]* buffer (\w+) \{", re.M)


@dataclass(frozen=True)
class Member:
    type: str  # in GLSL; for a buffer reference the name of its block
    name: str
    count: str = ""  # for an array what stands in its brackets


@dataclass(frozen=True)
class Struct:
    name: str
    members: tuple[Member, ...]


def read_shaders(folder: Path) -> Texts:
    paths = sorted(path for path in folder.rglob("*") if path.suffix in KINDS)
    return {path.relative_to(folder).as_posix(): path.read_text() for path in paths}


def with_includes(texts: Texts, file: str) -> list[str]:
    """The file and all that it includes at any depth, what is included first; files that the build makes left out."""
    files: list[str] = []

    def add(one: str, above: tuple[str, ...]) -> None:
        if one not in texts or one in files or one in above:
            return
        for included in INCLUDE.findall(texts[one]):
            add(included, (*above, one))
        files.append(one)

    add(file, ())
    return files


def name_of(file: str) -> str:
    """What a shader is called in C++: NAME of a compute shader, NAME_STAGE of others."""
    path = PurePosixPath(file)
    return path.stem if path.suffix == ".comp" else path.name.replace(".", "_")


def seen_lines(text: str, cpp: bool, moments: int) -> Iterator[str]:
    """The lines that a compiler sees. Of conditions, __cplusplus and "MOMENTS == N" count; all others hold."""
    holds = {"#ifdef __cplusplus": cpp, "#ifndef __cplusplus": not cpp}
    holds |= {f"#if MOMENTS == {n}": moments == n for n in (1, 2)}
    conditions: list[bool] = []
    for line in text.splitlines():
        if line.startswith("#if"):
            conditions.append(holds.get(line, True))
        elif line.startswith("#else"):
            conditions[-1] = not conditions[-1]
        elif line.startswith("#endif"):
            conditions.pop()
        elif all(conditions):
            yield line


def members_of(line: str) -> list[Member]:
    """What one line declares: "type a, b;", "QG_REF(Type) a;", "type a[N];". ValueError for anything else."""
    code = line.split("//")[0]
    declaration = DECLARATION.fullmatch(code)
    if declaration is None:
        if ";" in code:
            raise ValueError(f"not one declaration a line: {line}")
        return []
    found = re.findall(r"(\w+)(?:\[(\w+)\])?", declaration[3])
    return [Member(declaration[1] or declaration[2], name, count) for name, count in found]


def structs_of(text: str, cpp: bool, moments: int) -> list[Struct]:
    structs: list[Struct] = []
    name, members = "", []
    for line in seen_lines(text, cpp, moments):
        if begin := re.match(r"struct (\w+) \{", line):
            name, members = begin[1], []
        elif name and line.startswith("};"):
            structs.append(Struct(name, tuple(members)))
            name = ""
        elif name:
            members += members_of(line)
    return structs


def references_of(texts: Texts) -> set[str]:
    """Names of all blocks that are reached through addresses."""
    patterns = (ARRAY, HEADED, BLOCK)
    return {found[1] for text in texts.values() for pattern in patterns for found in pattern.finditer(text)}


def elements_of(texts: Texts) -> set[str]:
    """Types of the elements of all arrays that are reached through addresses."""
    all_text = "\n".join(texts.values())
    return {found[2] for found in ARRAY.finditer(all_text)} | {found[4] for found in HEADED.finditer(all_text)}
