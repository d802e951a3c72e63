"""PLY files of any types, as bytes."""

from __future__ import annotations

import struct
from collections.abc import Sequence

CODES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d"}
ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">"}
# (name, columns, rows); a column is (type, name) or (type of the length, type, name), whose values are sequences.
Table = tuple[str, Sequence[tuple[str, ...]], Sequence[Sequence[object]]]


def ply_bytes(form: str, tables: Sequence[Table]) -> bytes:
    """A file of format "ascii", "binary_little_endian" or "binary_big_endian"."""
    lines = ["ply", f"format {form} 1.0", "comment of a test"]
    body = b""
    for name, columns, rows in tables:
        lines.append(f"element {name} {len(rows)}")
        lines += [f"property {'list ' if len(column) == 3 else ''}{' '.join(column)}" for column in columns]
        body += b"".join(_row(form, columns, row) for row in rows)
    return "\n".join([*lines, "end_header\n"]).encode() + body


def _row(form: str, columns: Sequence[tuple[str, ...]], row: Sequence[object]) -> bytes:
    values: list[tuple[str, object]] = []
    for column, value in zip(columns, row, strict=True):
        if len(column) == 3:
            assert isinstance(value, list | tuple)
            values += [(column[0], len(value)), *((column[1], item) for item in value)]
        else:
            values.append((column[0], value))
    if form == "ascii":
        return (" ".join(str(value) for _, value in values) + "\n").encode()
    return b"".join(struct.pack(ORDERS[form] + CODES[kind], value) for kind, value in values)
