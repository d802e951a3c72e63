"""The `.qgraph` container, version 1 (docs/qgraph-format.md): header, section table, sections, metadata.

    byte 0        64               64 + 128 n        a multiple of 64
    | header 64  | n entries x 128 | 0-pad  | data 0 | 0-pad to 64 | data 1 | 0-pad to 64 | ... | end

What the sections mean, and the rules between them, is in qgraph_rules.py.
"""

from __future__ import annotations

import json
import math
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph.base import json_text, regular_file
from quadgraph.base.atomic_file import replacing
from quadgraph.base.errors import FormatError, InputError
from quadgraph.file import qgraph_rules

MAGIC = b"\x89QGRAPH\n"
VERSION = 1
BYTE_ORDER = 0x01020304
ALIGNMENT = 64
MAX_SECTIONS = 4096

HEADER = np.dtype(
    [
        ("magic", "V8"),
        ("version", "<u4"),
        ("byte_order", "<u4"),
        ("section_count", "<u4"),
        ("table_crc32", "<u4"),
        ("file_size", "<u8"),
        ("reserved", "V32"),
    ]
)
SECTION = np.dtype(
    [
        ("name", "V64"),
        ("type", "<u4"),
        ("rank", "<u4"),
        ("shape", "<u8", 3),
        ("offset", "<u8"),
        ("size", "<u8"),
        ("crc32", "<u4"),
        ("reserved", "V12"),
    ]
)
TYPES: dict[int, np.dtype[Any]] = {1: np.dtype("u1"), 2: np.dtype("<u4"), 3: np.dtype("<f4")}
_CODES = {dtype: code for code, dtype in TYPES.items()}


@dataclass(frozen=True)
class QGraphFile:
    """A validated file: metadata as in the document, read-only arrays by section name in file order, size in bytes."""

    metadata: dict[str, Any]
    sections: dict[str, np.ndarray]
    byte_size: int

    @property
    def level_count(self) -> int:
        """Number of levels of detail."""
        return qgraph_rules.level_count(self.sections)


def write(path: Path, metadata: dict[str, Any], sections: dict[str, np.ndarray]) -> int:
    """Write a file atomically and return its size; the same arguments give the same bytes.

    Arrays are uint32 or float32, C-contiguous, named and ordered as in the document, `metadata` excluded. Everything
    is validated first: FormatError means a mistake of the caller. InputError if `path` cannot be written. Whatever
    interrupts the call, `path` is either untouched or complete.
    """
    qgraph_rules.check(_with_metadata(metadata, sections), metadata, str(path))
    return write_sections(path, metadata, sections)


def write_sections(path: Path, metadata: dict[str, Any], sections: dict[str, np.ndarray]) -> int:
    """Do the same with sections of any meaning: header, table, padding and checksums of a .qgraph alone."""
    everything = _with_metadata(metadata, sections)
    header, table = _head(everything)
    with replacing(path) as stream:
        pieces = (np.ascontiguousarray(array).data for array in everything.values())
        for piece in (memoryview(header.tobytes() + table.tobytes()), *pieces):
            size = stream.write(piece)
            stream.write(b"\0" * (_aligned(size) - size))
    return int(header["file_size"])


def _with_metadata(metadata: dict[str, Any], sections: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    blob = np.frombuffer(json.dumps(metadata, sort_keys=True, allow_nan=False).encode(), np.uint8)
    return {"metadata": blob, **sections}


def read(path: Path) -> QGraphFile:
    """Read and validate a whole file.

    Raises FormatError that names the file, the section and the broken rule; InputError if it cannot be read.
    """
    try:
        data = regular_file.read_bytes(Path(path))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error
    return parse(data, str(path))


def parse(data: bytes, name: str) -> QGraphFile:
    """Do the same as `read` with bytes in memory; `name` stands for the file in messages."""
    table = _read_table(data, name)
    sections = dict(_read_sections(data, table, name))
    metadata = _read_metadata(sections, name)
    qgraph_rules.check(sections, metadata, name)
    return QGraphFile(metadata, sections, len(data))


def _aligned(size: int) -> int:
    return -(-size // ALIGNMENT) * ALIGNMENT


def _head(sections: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    table = np.zeros(len(sections), SECTION)
    end = HEADER.itemsize + table.nbytes
    for entry, (name, array) in zip(table, sections.items(), strict=True):
        entry["name"] = np.void(name.encode("ascii").ljust(64, b"\0"))
        entry["type"] = _CODES[array.dtype]
        entry["rank"] = array.ndim
        entry["shape"][: array.ndim] = array.shape
        entry["offset"] = _aligned(end)
        entry["size"] = array.nbytes
        entry["crc32"] = zlib.crc32(np.ascontiguousarray(array).data)
        end = int(entry["offset"]) + array.nbytes
    header = np.zeros((), HEADER)
    header["magic"] = np.void(MAGIC)
    header["version"] = VERSION
    header["byte_order"] = BYTE_ORDER
    header["section_count"] = len(table)
    header["table_crc32"] = zlib.crc32(table.tobytes())
    header["file_size"] = _aligned(end)
    return header, table


def _require(condition: bool, name: str, what: str) -> None:
    if not condition:
        raise FormatError(f"{name}: {what}")


def _read_table(data: bytes, name: str) -> np.ndarray:
    size = len(data)
    _require(size >= HEADER.itemsize, name, f"header: {size} bytes found, at least {HEADER.itemsize} needed")
    header = np.frombuffer(data, HEADER, 1)[0]
    _require(header["magic"].tobytes() == MAGIC, name, "header: magic is not that of a .qgraph file")
    version, order, count = (int(header[k]) for k in ("version", "byte_order", "section_count"))
    _require(version == VERSION, name, f"header: version {version} found, {VERSION} allowed")
    _require(order == BYTE_ORDER, name, f"header: byte_order {order:#010x} found, {BYTE_ORDER:#010x} allowed")
    _require(1 <= count <= MAX_SECTIONS, name, f"header: section_count {count} found, 1 to {MAX_SECTIONS} allowed")
    stated = int(header["file_size"])
    _require(stated == size, name, f"header: file_size {stated} found, the file has {size} bytes")
    _require(not any(header["reserved"].tobytes()), name, "header: reserved bytes are not zero")
    table_size = count * SECTION.itemsize
    _require(HEADER.itemsize + table_size <= size, name, f"section table: {count} entries exceed the file")
    table = np.frombuffer(data, SECTION, count, HEADER.itemsize)
    _require(zlib.crc32(table.tobytes()) == int(header["table_crc32"]), name, "section table: checksum differs")
    return table


def _read_sections(data: bytes, table: np.ndarray, name: str) -> Iterator[tuple[str, np.ndarray]]:
    end = HEADER.itemsize + table.nbytes
    seen: set[str] = set()
    for number, entry in enumerate(table):
        section = _section_name(entry, f"{name}: section {number}")
        where = f"{name}: {section}"
        _require(section not in seen, where, "the name occurs twice")
        seen.add(section)
        shape = _section_shape(entry, where)
        offset, size = int(entry["offset"]), int(entry["size"])
        _require(offset == _aligned(end), where, f"offset {offset} found, {_aligned(end)} allowed")
        expected = math.prod(shape) * TYPES[int(entry["type"])].itemsize
        _require(size == expected, where, f"size {size} found, type and shape give {expected}")
        _require(offset + size <= len(data), where, f"ends at byte {offset + size}, the file has {len(data)}")
        _require(not any(data[end:offset]), where, "the gap before the section is not zero")
        end = offset + size
        _require(zlib.crc32(memoryview(data)[offset:end]) == int(entry["crc32"]), where, "checksum differs")
        yield section, np.frombuffer(data, TYPES[int(entry["type"])], math.prod(shape), offset).reshape(shape)
    _require(len(data) == _aligned(end), name, f"{len(data)} bytes found, the sections end at {_aligned(end)}")
    _require(not any(data[end:]), name, "the bytes after the last section are not zero")


def _section_name(entry: np.void, where: str) -> str:
    raw = entry["name"].tobytes()
    text = raw.rstrip(b"\0")
    _require(0 < len(text) < len(raw), where, "the name is empty or fills all 64 bytes")
    _require(all(0x20 <= byte < 0x7F for byte in text), where, f"the name {text!r} is not printable ASCII")
    return text.decode("ascii")


def _section_shape(entry: np.void, where: str) -> tuple[int, ...]:
    code, rank = int(entry["type"]), int(entry["rank"])
    _require(code in TYPES, where, f"type {code} found, {', '.join(map(str, TYPES))} allowed")
    _require(rank in (1, 2), where, f"rank {rank} found, 1 or 2 allowed")
    shape = tuple(int(n) for n in entry["shape"])
    used, unused = shape[:rank], shape[rank:]
    _require(all(used) and not any(unused), where, f"shape {shape} does not fit rank {rank}")
    _require(not any(entry["reserved"].tobytes()), where, "reserved bytes are not zero")
    return used


def _read_metadata(sections: dict[str, np.ndarray], name: str) -> dict[str, Any]:
    first = next(iter(sections))
    _require(first == "metadata", name, f"the first section is {first!r}, it must be 'metadata'")
    _require(sections[first].dtype == np.uint8 and sections[first].ndim == 1, name, "metadata: not u8 of rank 1")
    try:
        metadata = json_text.loads(sections[first].tobytes())
    except InputError as error:
        raise FormatError(f"{name}: metadata: {error}") from None
    _require(isinstance(metadata, dict), name, "metadata: not a JSON object")
    return metadata
