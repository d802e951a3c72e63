"""Linear pictures as OpenEXR files: scan lines of red, green and blue floats, each compressed by zlib (ZIPS)."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np

from quadgraph.base.atomic_file import replacing

_MAGIC, _VERSION = 20000630, 2
_FLOAT, _ZIPS = 2, 2
_CHANNELS = "BGR"  # in the order of the alphabet, as the format wants them


def write(path: Path, picture: np.ndarray) -> None:
    """Write (h, w, 3) red, green, blue. Raises InputError if it cannot be written."""
    height, width, _ = picture.shape
    head = _header(width, height)
    lines = []
    for row in np.asarray(picture, "<f4"):
        plain = b"".join(row[:, "RGB".index(channel)].tobytes() for channel in _CHANNELS)
        packed = zlib.compress(_predicted(plain), 4)
        lines.append(packed if len(packed) < len(plain) else plain)
    start = len(head) + 8 * height
    with replacing(path) as stream:
        stream.write(head)
        for line in lines:
            stream.write(struct.pack("<Q", start))
            start += 8 + len(line)
        for number, line in enumerate(lines):
            stream.write(struct.pack("<ii", number, len(line)) + line)


def _predicted(plain: bytes) -> bytes:
    """Every other byte first, then differences, as the format has its bytes before they are compressed."""
    data = np.frombuffer(plain, np.uint8)
    split = np.concatenate([data[::2], data[1::2]]).astype(np.int16)
    split[1:] = np.diff(split) + 128
    return split.astype(np.uint8).tobytes()


def _header(width: int, height: int) -> bytes:
    channels = b"".join(name.encode() + b"\0" + struct.pack("<iiii", _FLOAT, 0, 1, 1) for name in _CHANNELS) + b"\0"
    box = struct.pack("<iiii", 0, 0, width - 1, height - 1)
    attributes = [
        (b"channels", b"chlist", channels),
        (b"compression", b"compression", bytes([_ZIPS])),
        (b"dataWindow", b"box2i", box),
        (b"displayWindow", b"box2i", box),
        (b"lineOrder", b"lineOrder", b"\0"),
        (b"pixelAspectRatio", b"float", struct.pack("<f", 1)),
        (b"screenWindowCenter", b"v2f", struct.pack("<ff", 0, 0)),
        (b"screenWindowWidth", b"float", struct.pack("<f", 1)),
    ]
    parts = [struct.pack("<ii", _MAGIC, _VERSION)]
    for name, kind, data in attributes:
        parts.append(name + b"\0" + kind + b"\0" + struct.pack("<i", len(data)) + data)
    return b"".join(parts) + b"\0"
