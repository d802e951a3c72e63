"""Whether a PLY file can hold what its header says: its reader takes memory, and ends the program, by what it says."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal, TypeAlias

import numpy as np

from quadgraph.base.errors import InputError

_TYPES = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
}
_HEADER_BYTES = 1 << 16
ByteOrder: TypeAlias = Literal["=", "<", ">"]


@dataclass
class _Element:
    """Properties in order: (type of the count, type), without a count for a single value."""

    name: str
    count: int
    properties: list[tuple[np.dtype | None, np.dtype]] = field(default_factory=list)

    @property
    def least_bytes(self) -> int:
        """Of one of them, all lists being empty."""
        return sum((of.itemsize if of is not None else item.itemsize) for of, item in self.properties)


def check(path: Path) -> None:
    """Raise InputError, naming element, found and allowed, where the file is too short for its header."""
    data = path.read_bytes()
    found = re.search(rb"end_header\r?\n", data[:_HEADER_BYTES])
    if not data.startswith(b"ply") or not found:
        raise InputError(f"{path}: cannot be read as PLY: no 'ply' to 'end_header' within {_HEADER_BYTES} bytes")
    order, elements = _header(path, data[: found.start()].decode("ascii", "replace"))
    body = memoryview(data)[found.end() :]
    for element in elements:
        if order == "=":
            _require_room(path, element, 2 * element.count, len(body))  # a digit and the end of a line
        else:
            body = body[_size(path, element, body, order) :]


def _header(path: Path, text: str) -> tuple[ByteOrder, list[_Element]]:
    """Byte order, "=" for text, and elements."""
    orders: dict[str, ByteOrder] = {"ascii": "=", "binary_little_endian": "<", "binary_big_endian": ">"}
    order: ByteOrder | None = None
    elements: list[_Element] = []
    for line in text.splitlines()[1:]:
        words = line.split()
        try:
            if words[:1] == ["format"]:
                order = orders[words[1]]
            elif words[:1] == ["element"]:
                elements.append(_Element(words[1], int(words[2])))
            elif words[:2] == ["property", "list"]:
                elements[-1].properties.append((_count_type(words[2]), np.dtype(_TYPES[words[3]])))
            elif words[:1] == ["property"]:
                elements[-1].properties.append((None, np.dtype(_TYPES[words[1]])))
        except (KeyError, IndexError, ValueError):
            raise InputError(f"{path}, header: cannot read '{line[:80]}'") from None
    if order is None or any(element.count < 0 for element in elements):
        raise InputError(f"{path}, header: a format and counts of 0 or more are wanted")
    return order, elements


def _count_type(name: str) -> np.dtype:
    kind = np.dtype(_TYPES[name])
    if kind.kind == "f":
        raise ValueError
    return kind


def _require_room(path: Path, element: _Element, wanted: int, room: int) -> None:
    if wanted > room:
        raise InputError(
            f"{path}, element {element.name}: {element.count} found in the header, which take at least {wanted} bytes; "
            f"{room} are left in the file"
        )


def _size(path: Path, element: _Element, body: memoryview, order: ByteOrder) -> int:
    """Bytes of all of an element."""
    _require_room(path, element, element.count * element.least_bytes, len(body))
    if all(of is None for of, _ in element.properties) or not element.count:
        return element.count * element.least_bytes
    first = _row_end(path, element, body, 0, order)
    if first * element.count <= len(body) and _all_alike(element, body, first, order):
        return first * element.count
    end = 0
    for _ in range(element.count):
        end = _row_end(path, element, body, end, order)
    return end


def _row_end(path: Path, element: _Element, body: memoryview, at: int, order: ByteOrder) -> int:
    for of, item in element.properties:
        if of is None:
            at += item.itemsize
            continue
        if at + of.itemsize > len(body):
            at = len(body) + 1
            break
        count = int(np.frombuffer(body, of.newbyteorder(order), 1, at)[0])
        at += of.itemsize + count * item.itemsize
        if count < 0 or at > len(body):
            raise InputError(
                f"{path}, element {element.name}: a list of {count} found, {len(body)} bytes are left in the file"
            )
    if at > len(body):
        raise InputError(f"{path}, element {element.name}: cut off, {len(body)} bytes are left in the file")
    return at


def _all_alike(element: _Element, body: memoryview, row: int, order: ByteOrder) -> bool:
    """Whether the lists of all rows are as long as those of the first."""
    rows = np.frombuffer(body, np.uint8, row * element.count).reshape(element.count, row)
    at = 0
    for of, item in element.properties:
        if of is None:
            at += item.itemsize
            continue
        counts = rows[:, at : at + of.itemsize]
        if (counts != counts[0]).any():
            return False
        at += of.itemsize + int(np.frombuffer(counts[0].tobytes(), of.newbyteorder(order))[0]) * item.itemsize
    return True
