"""Sealed `.qgraph` files: metadata or the table of sections changed, and the checksums made right again."""

from __future__ import annotations

import json
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from attack import texts
from attack.case import Case, Outcome, Place
from attack.physics import PICTURED, SOLVE_OUTPUTS, engine, pictured_as, solve, solved_as
from attack.texts import Rng
from quadgraph.file import qgraph_file
from quadgraph.file.qgraph_file import HEADER, SECTION

BODY = ("body.qgraph",)
INFO = ("quadgraph", "info", "body.qgraph")
Sections = dict[str, np.ndarray]


def opened(path: Path) -> tuple[dict[str, Any], Sections]:
    """Metadata and sections of a body, to be changed."""
    file = qgraph_file.read(path)
    return json.loads(json.dumps(file.metadata)), {name: array.copy() for name, array in file.sections.items()}


def seal(path: Path, metadata: bytes, sections: Sections) -> None:
    """Write a file whose checksums are right, whatever it says."""
    rest = {name: array for name, array in sections.items() if name != "metadata"}
    qgraph_file.write_sections(path, {}, {"metadata": np.frombuffer(metadata, np.uint8), **rest})


def changed(change: Callable[[dict[str, Any], Sections], bytes | None], body: str = "ring") -> Callable[[Place], None]:
    """Prepare a body that `change` alters in place; it may return the metadata as text."""

    def prepare(place: Place) -> None:
        metadata, sections = opened(place.bodies.body(body))
        text = change(metadata, sections)
        seal(place.folder / "body.qgraph", json.dumps(metadata).encode() if text is None else text, sections)

    return prepare


def commands(rng: Rng) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """A command that reads a body, and its outputs."""
    return texts.pick(rng, [(INFO, ()), (solve(), SOLVE_OUTPUTS), (engine(), ("out.png",))])


def deep_metadata(rng: Rng) -> Case:
    """A key of the metadata nested beyond all limits."""
    key, depth = texts.pick(rng, ["front", "options", "unknown", "levels", "tools"]), texts.depth(rng)
    value = texts.nested(rng, depth)

    def change(metadata: dict[str, Any], sections: Sections) -> bytes:
        metadata.pop(key, None)
        return (json.dumps(metadata)[:-1] + f', "{key}": {value}}}').encode()

    command, outputs = commands(rng)
    name = f"{command[0]} {command[1]}, metadata {key} {depth} deep"
    return Case(name, command, BODY, changed(change), outputs, expect="refused")


def wrong_types(rng: Rng) -> Case:
    """A value of the metadata replaced by one of another kind."""
    value = texts.junk(rng)
    draw = int(rng.integers(2**31))

    def change(metadata: dict[str, Any], sections: Sections) -> bytes:
        paths = texts.places(metadata)
        return json.dumps(texts.replaced(metadata, paths[draw % len(paths)], value)).encode()

    command, outputs = commands(rng)
    return Case(f"{command[0]} {command[1]}, metadata {draw} is {value!r:.60}", command, BODY, changed(change), outputs)


def missing_keys(rng: Rng) -> Case:
    """A key of the metadata left out, or one too many."""
    draw, more = int(rng.integers(2**31)), bool(rng.integers(3) == 0)

    def change(metadata: dict[str, Any], sections: Sections) -> None:
        path = [path for path in texts.places(metadata) if isinstance(path[-1], str)]
        chosen = path[draw % len(path)]
        holder = texts.at(metadata, chosen[:-1])
        holder["more"] = 1
        if not more:
            del holder[chosen[-1]], holder["more"]

    command, outputs = commands(rng)
    word = "one too many" if more else "left out"
    return Case(f"{command[0]} {command[1]}, key {draw} {word}", command, BODY, changed(change), outputs)


def escapes(rng: Rng) -> Case:
    """Terminal escapes in texts that `info` shows."""
    path = texts.pick(rng, [("generator",), ("source", "name"), ("mesher", "options"), ("mesher", "version")])
    text = texts.pick(rng, ["\x1b[2J\x1b[31m", "\x1b]0;title\x07", "\x9b31m", "a\rb\x08\x08", "\u202e\x7f"]) * 3

    def change(metadata: dict[str, Any], sections: Sections) -> bytes:
        return json.dumps(texts.replaced(metadata, path, text)).encode()

    return Case(f"info, {'/'.join(path)} is {text!r}", INFO, BODY, changed(change))


def lying_counts(rng: Rng) -> Case:
    """Counts of the metadata that are not those of the sections: `info` must not print them."""
    key = texts.pick(rng, ["vertices", "surface_vertices", "tets", "faces", "volume_mm3", "area_mm2"])
    level, value = int(rng.integers(2)), int(rng.integers(10**5, 10**8))

    def change(metadata: dict[str, Any], sections: Sections) -> None:
        metadata["levels"][level][key] = value

    def judge(place: Place, outcome: Outcome) -> str:
        return f"info prints the {key} that is not there" if f"{value:,}" in outcome.stdout else ""

    return Case(f"info, level {level} {key} {value}", INFO, BODY, changed(change), judge=judge)


def broken_json(rng: Rng) -> Case:
    """Metadata that is no JSON object."""
    draw = int(rng.integers(8))

    def change(metadata: dict[str, Any], sections: Sections) -> bytes:
        text = json.dumps(metadata).encode()
        return [
            text[: max(1, int(len(text) * 0.7))],
            text + b"}",
            b"[1, 2]",
            text.replace(b'"unit_mm": 1.0', b'"unit_mm": NaN'),
            text.replace(b'"unit_mm": 1.0', b'"unit_mm": 1e999'),
            text.decode().encode("utf-16"),
            text[:-1] + b', "generator": "twice"}',
            text.replace(b"quadgraph", b"\xff\xfe\xc0"),
        ][draw]

    command, outputs = commands(rng)
    return Case(f"{command[0]} {command[1]}, broken metadata {draw}", command, BODY, changed(change), outputs)


def tampered(path: Path, change: Callable[[np.ndarray, np.ndarray], None]) -> None:
    """Change header and table of sections, and make the table's checksum right."""
    data = bytearray(path.read_bytes())
    header = np.frombuffer(data, HEADER, 1)
    table = np.frombuffer(data, SECTION, int(header["section_count"][0]), HEADER.itemsize)
    change(header, table)
    header["table_crc32"] = zlib.crc32(table.tobytes())
    path.write_bytes(data)


def table(rng: Rng) -> Case:
    """An entry of the table of sections that lies about type, rank, shape, place, size or name."""
    field = texts.pick(
        rng, ["type", "rank", "shape", "offset", "size", "name", "reserved", "section_count", "file_size"]
    )
    draw, power = int(rng.integers(2**31)), int(rng.integers(0, 64))

    def change(header: np.ndarray, entries: np.ndarray) -> None:
        entry = entries[draw % len(entries) : draw % len(entries) + 1]
        if field in ("section_count", "file_size"):
            header[field] = (int(header[field][0]) + 2 ** (power % 32 if field == "section_count" else power)) % (
                2**32 if field == "section_count" else 2**64
            )
        elif field == "name":
            entry[field] = np.void(
                texts.pick(np.random.default_rng(draw), [b"", b"x" * 64, b"level0/tets\xff", b"a b"])
            )
        elif field == "reserved":
            entry[field] = np.void(b"\1" * 12)
        elif field == "shape":
            entry[field][0, draw % 3] = (int(entry[field][0, draw % 3]) + 2**power) % 2**64
        else:
            entry[field] = (int(entry[field][0]) + 2 ** (power % 32 if field in ("type", "rank") else power)) % (
                2**32 if field in ("type", "rank") else 2**64
            )

    def prepare(place: Place) -> None:
        tampered(place.bodies.put(place.folder), change)

    command, outputs = commands(rng)
    name = f"{command[0]} {command[1]}, {field} of entry {draw} by 2^{power}"
    return Case(name, command, BODY, prepare, outputs, expect="refused")


def cut_or_flipped(rng: Rng) -> Case:
    """A file cut off, lengthened, or with a bit flipped anywhere: the checksums are left wrong."""
    kind, share = texts.pick(rng, ["cut", "longer", "flipped"]), rng.random()

    def prepare(place: Place) -> None:
        path = place.bodies.put(place.folder)
        data = bytearray(path.read_bytes())
        spot = int(share * len(data))
        if kind == "flipped":
            data[spot] ^= 1 << int(share * 1e6) % 8
        path.write_bytes({"cut": data[:spot], "longer": data + bytes(spot), "flipped": data}[kind])

    command, outputs = commands(rng)
    return Case(f"{command[0]} {command[1]}, {kind} at {share:.6f}", command, BODY, prepare, outputs, expect="refused")


def untouched(rng: Rng) -> Case:
    """A body sealed again without any change: the same answer."""
    if rng.integers(2):
        command = ("quadgraph", "render", "body.qgraph", "-o", "out.png", *PICTURED)
        return Case(
            "render, untouched",
            command,
            BODY,
            changed(lambda m, s: None),
            ("out.png",),
            judge=pictured_as("ring", allowed=1e-6),
            expect="fine",
        )
    judge = solved_as("ring", allowed=1e-6)
    return Case(
        "solve, untouched", solve(), BODY, changed(lambda m, s: None), SOLVE_OUTPUTS, judge=judge, expect="fine"
    )


RECIPES = (
    deep_metadata,
    wrong_types,
    missing_keys,
    escapes,
    lying_counts,
    broken_json,
    table,
    cut_or_flipped,
    untouched,
)
