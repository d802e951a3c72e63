"""The `.qgraph` container, version 1 (docs/qgraph-format.md): header, section table, sections, metadata.

    byte 0        64               64 + 128 n        a multiple of 64
    | header 64  | n entries x 128 | 0-pad  | data 0 | 0-pad to 64 | data 1 | 0-pad to 64 | ... | end

What the sections mean, and the rules between them, is in docs/qgraph-format.md; the compiled engine holds files to
them, those that are read here too.
"""

from __future__ import annotations

import json
import math
import mmap
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph import core
from quadgraph.base import json_text, regular_file
from quadgraph.base.atomic_file import replacing
from quadgraph.base.errors import FormatError, InputError

MAGIC = b"\x89QGRAPH\n"
VERSION = 1
BYTE_ORDER = 0x01020304
ALIGNMENT = 64

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
        return sum(name.startswith("level") and name.endswith("/vertices") for name in self.sections)


def write(path: Path, metadata: dict[str, Any], sections: dict[str, np.ndarray]) -> int:
    """Write a file atomically and return its size; the same arguments give the same bytes.

    Arrays are uint32 or float32, C-contiguous, named and ordered as in the document, `metadata` excluded. All rules of
    the document are checked before the file takes the place of what was there: FormatError means a mistake of the
    caller. InputError if `path` cannot be written. Whatever interrupts the call, `path` is either untouched or
    complete.
    """
    return _write(path, metadata, sections, core.check_qgraph)


def write_sections(path: Path, metadata: dict[str, Any], sections: dict[str, np.ndarray]) -> int:
    """Do the same with sections of any meaning: header, table, padding and checksums of a .qgraph alone."""
    return _write(path, metadata, sections, None)


def _write(
    path: Path,
    metadata: dict[str, Any],
    sections: dict[str, np.ndarray],
    check: Callable[[mmap.mmap, str], None] | None,
) -> int:
    for name, array in sections.items():
        allowed = " and ".join(map(str, _CODES))
        _require(array.dtype in _CODES, f"{path}: {name}", f"type {array.dtype} found, allowed are {allowed}")
    everything = _with_metadata(metadata, sections)
    header, table = _head(everything)
    with replacing(path) as stream:
        pieces = (np.ascontiguousarray(array).data for array in everything.values())
        for piece in (memoryview(header.tobytes() + table.tobytes()), *pieces):
            size = stream.write(piece)
            stream.write(b"\0" * (_aligned(size) - size))
        if check is not None:
            stream.flush()
            with mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as written:
                check(written, str(path))
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
    core.check_qgraph(data, name)
    sections = dict(_sections(data))
    return QGraphFile(json_text.loads(sections["metadata"].tobytes()), sections, len(data))


def _sections(data: bytes) -> Iterator[tuple[str, np.ndarray]]:
    """Views of the sections of a file that breaks no rule."""
    count = int(np.frombuffer(data, HEADER, 1)["section_count"][0])
    for entry in np.frombuffer(data, SECTION, count, HEADER.itemsize):
        shape = tuple(int(n) for n in entry["shape"][: int(entry["rank"])])
        array = np.frombuffer(data, TYPES[int(entry["type"])], math.prod(shape), int(entry["offset"]))
        yield entry["name"].tobytes().rstrip(b"\0").decode("ascii"), array.reshape(shape)


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
