"""Raw files as a camera writes them: the least of a DNG."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

BLACK, WHITE = 512, 15000  # levels of a pixel of the sensor


def write_dng(path: Path, mosaic: np.ndarray, shutter: tuple[int, int] = (1, 50)) -> None:
    """A raw file of (h, w) uint16, red in its upper left corner, shutter s, f/4, ISO 200, without compression."""
    high, wide = mosaic.shape
    short, long, byte, text, rational, signed = 3, 4, 1, 2, 5, 10
    matrix = struct.pack("<18i", *(value for cell in np.eye(3, dtype=int).ravel().tolist() for value in (cell, 1)))
    entries = [
        (254, long, struct.pack("<I", 0)),
        (256, long, struct.pack("<I", wide)),
        (257, long, struct.pack("<I", high)),
        (258, short, struct.pack("<H", 16)),
        (259, short, struct.pack("<H", 1)),
        (262, short, struct.pack("<H", 32803)),  # a colour filter array
        (271, text, b"Test\0"),
        (272, text, b"Camera\0"),
        (273, long, b""),  # where the pixels are
        (277, short, struct.pack("<H", 1)),
        (278, long, struct.pack("<I", high)),
        (279, long, struct.pack("<I", 2 * wide * high)),
        (33421, short, struct.pack("<HH", 2, 2)),
        (33422, byte, bytes([0, 1, 1, 2])),
        (34665, long, b""),  # where shutter, f-number and speed are
        (50706, byte, bytes([1, 4, 0, 0])),
        (50708, text, b"Test Camera\0"),
        (50714, long, struct.pack("<I", BLACK)),
        (50717, long, struct.pack("<I", WHITE)),
        (50721, signed, matrix),
    ]
    exif = [
        (33434, rational, struct.pack("<II", *shutter)),
        (33437, rational, struct.pack("<II", 4, 1)),
        (34855, short, struct.pack("<H", 200)),
    ]
    blank = [(tag, kind, data or bytes(4)) for tag, kind, data in entries]
    first = 8 + len(_table(blank, 8))
    places = {34665: struct.pack("<I", first), 273: struct.pack("<I", first + len(_table(exif, first)))}
    entries = [(tag, kind, places.get(tag, data)) for tag, kind, data in entries]
    tables = _table(entries, 8) + _table(exif, first)
    path.write_bytes(b"II*\0" + struct.pack("<I", 8) + tables + mosaic.astype("<u2").tobytes())


def _table(entries: list[tuple[int, int, bytes]], at: int) -> bytes:
    """A TIFF's table that begins at a byte, and behind it what has no room there."""
    byte, text, short, long, rational, signed = 1, 2, 3, 4, 5, 10
    sizes = {byte: 1, text: 1, short: 2, long: 4, rational: 8, signed: 8}
    place = at + 2 + 12 * len(entries) + 4
    table, more = struct.pack("<H", len(entries)), b""
    for tag, kind, data in entries:
        table += struct.pack("<HHI", tag, kind, len(data) // sizes[kind])
        if len(data) > 4:
            table += struct.pack("<I", place + len(more))
            more += data + b"\0" * (len(data) % 2)
        else:
            table += data.ljust(4, b"\0")
    return table + b"\0\0\0\0" + more
