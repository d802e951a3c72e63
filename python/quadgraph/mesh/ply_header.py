"""The header of a PLY file: its elements, their properties, and where their values begin."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal, TypeAlias

import numpy as np

from quadgraph.base.errors import InputError

HEADER_BYTES = 1 << 16
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
_SHOWN = 80  # characters of a foreign line or name that an error repeats
ByteOrder: TypeAlias = Literal["=", "<", ">"]  # "=": text


@dataclass(frozen=True)
class Property:
    """A value of each row of an element, or a list of them; count: type of the list's length, None for one value."""

    name: str
    item: np.dtype
    count: np.dtype | None = None

    @property
    def least_bytes(self) -> int:
        """Bytes in a row, a list being empty."""
        return (self.count or self.item).itemsize


@dataclass
class Element:
    """A table of `count` rows."""

    name: str
    count: int
    properties: list[Property] = field(default_factory=list)

    @property
    def least_bytes(self) -> int:
        """Bytes of a row whose lists are empty."""
        return sum(item.least_bytes for item in self.properties)


@dataclass(frozen=True)
class Header:
    """What a header says; end: the byte at which values begin."""

    order: ByteOrder
    elements: list[Element]
    end: int


def read_header(path: Path, data: bytes) -> Header:
    """Read the header of a file's bytes. Raises InputError naming the line or element that is wrong."""
    found = re.search(rb"\nend_header[ \t]*\r?\n", data[:HEADER_BYTES])
    if not data.startswith(b"ply") or not found:
        raise InputError(f"{path}: cannot be read as PLY: no 'ply' to 'end_header' within {HEADER_BYTES} bytes")
    order: ByteOrder | None = None
    elements: list[Element] = []
    for line in data[: found.start()].decode("ascii", "replace").splitlines()[1:]:
        try:
            order = _read_line(line.split(), elements) or order
        except (KeyError, IndexError, ValueError):
            raise InputError(f"{path}, header: cannot read {line[:_SHOWN]!r}") from None
    if order is None:
        raise InputError(f"{path}, header: no format found, allowed are ascii and binary_{{little,big}}_endian")
    for element in elements:
        if element.count < 0:
            raise InputError(f"{path}, element {element.name}: {element.count} found, allowed are 0 and more")
    return Header(order, elements, found.end())


def _read_line(words: list[str], elements: list[Element]) -> ByteOrder | None:
    """Add what a line says to `elements`; return the byte order if it says that."""
    orders: dict[str, ByteOrder] = {"ascii": "=", "binary_little_endian": "<", "binary_big_endian": ">"}
    if words[:1] == ["format"]:
        return orders[words[1]]
    if words[:1] == ["element"]:
        elements.append(Element(words[1][:_SHOWN], int(words[2])))
    elif words[:2] == ["property", "list"]:
        count, item = np.dtype(_TYPES[words[2]]), np.dtype(_TYPES[words[3]])
        if count.kind == "f":
            raise ValueError
        elements[-1].properties.append(Property(words[4][:_SHOWN], item, count))
    elif words[:1] == ["property"]:
        elements[-1].properties.append(Property(words[2][:_SHOWN], np.dtype(_TYPES[words[1]])))
    return None
