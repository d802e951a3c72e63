"""Where the values of an element of a PLY file lie, held against the bytes that are there."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph.mesh.ply_header import Element


@dataclass(frozen=True)
class Rows:
    """places: (n, k) first byte of the k properties that were asked for, of a list that of its items; counts: (n,)
    lengths of the last of them, 1 if it is no list; end: the byte behind the element.
    """

    places: np.ndarray
    counts: np.ndarray
    end: int

    def chunks(self, most: int) -> Iterator[tuple[int, int]]:
        """First and last row, exclusive, of parts with about `most` values each."""
        ends, first = np.cumsum(self.counts), 0
        while first < len(ends):
            done = int(ends[first - 1]) if first else 0
            last = max(int(np.searchsorted(ends, done + most, side="right")), first + 1)
            yield first, last
            first = last


def find_rows(element: Element, data: np.ndarray, at: int, wanted: list[int], unit_bytes: int, unit: str) -> Rows:
    """Find the properties with indices `wanted` in data (n,) uint8 from byte `at` on.

    unit, unit_bytes: what messages count in. Raises InputError where the element does not fit.
    """
    room = Room(element.name, len(data), unit_bytes, unit)
    room.require(element, at)
    if not element.count or not element.properties:
        return Rows(np.empty((0, len(wanted)), np.int64), np.empty(0, np.int64), at)
    places, lengths, end = _walk(element, data, at, 1, wanted, room)
    stride = end - at
    if stride * element.count <= len(data) - at and _all_alike(element, data, at, stride):
        rows = np.arange(element.count if wanted else 0)[:, None] * stride + places
        return Rows(rows, np.repeat(lengths, len(rows)), at + stride * element.count)
    return Rows(*_walk(element, data, at, element.count, wanted, room))


@dataclass(frozen=True)
class Room:
    """What messages say of an element that does not fit into `size` bytes."""

    name: str
    size: int
    unit_bytes: int
    unit: str

    def require(self, element: Element, at: int) -> None:
        """Raise InputError unless all rows fit in behind `at` with empty lists."""
        least = element.count * element.least_bytes
        if least > self.size - at:
            raise InputError(
                f"element {self.name}: {element.count} found in the header, which take at least "
                f"{least // self.unit_bytes} {self.unit}; {self.left(at)}"
            )

    def left(self, at: int) -> str:
        """How much there is behind `at`."""
        return f"{max(self.size - at, 0) // self.unit_bytes} {self.unit} are left in the file"


def _walk(
    element: Element, data: np.ndarray, at: int, count: int, wanted: list[int], room: Room
) -> tuple[np.ndarray, np.ndarray, int]:
    """Places and counts of the first `count` rows, one after the other, and the byte behind them."""
    places = np.empty((count, len(wanted)), np.int64)
    lengths = np.ones(count, np.int64)
    column = {index: k for k, index in enumerate(wanted)}
    readers = [
        (index, struct.Struct(_format(item.count)) if item.count is not None else None, item.item.itemsize)
        for index, item in enumerate(element.properties)
    ]
    view = memoryview(data)  # type: ignore[arg-type]
    for row in range(count):
        for index, reader, size in readers:
            length = 1
            if reader is not None:
                if at + reader.size > len(view):
                    raise InputError(f"element {element.name}, row {row}: cut off, {room.left(at)}")
                found = reader.unpack_from(view, at)[0]
                at += reader.size
                if not 0 <= found <= (len(view) - at) // size or found != int(found):
                    name = element.properties[index].name
                    where = f"element {element.name}, row {row}, property {name}"
                    raise InputError(f"{where}: a list of {found:.17g} found, {room.left(at)}")
                length = int(found)
            if index in column:
                places[row, column[index]] = at
                lengths[row] = length
            at += length * size
        if at > len(view):
            raise InputError(f"element {element.name}, row {row}: cut off, {room.left(len(view))}")
    return places, lengths, at


def _format(count: np.dtype) -> str:
    order = {"<": "<", ">": ">"}.get(count.byteorder, "=")
    return order + count.char.translate(str.maketrans("lL", "iI"))


def _all_alike(element: Element, data: np.ndarray, at: int, stride: int) -> bool:
    """Whether the lists of all rows are as long as those of the first, whose bytes are `stride`."""
    rows = data[at : at + stride * element.count].reshape(element.count, stride)
    column = 0
    for item in element.properties:
        if item.count is None:
            column += item.item.itemsize
            continue
        counts = rows[:, column : column + item.count.itemsize]
        if (counts != counts[0]).any():
            return False
        column += item.count.itemsize + int(counts[0].copy().view(item.count)[0]) * item.item.itemsize
    return True
