"""glTF 2.0 files (.glb) of meshes with a material each."""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph.base.atomic_file import replacing
from quadgraph.base.errors import InputError

_VERSION, _FLOAT, _UINT, _VERTICES, _INDICES = 2, 5126, 5125, 34962, 34963


@dataclass(frozen=True, eq=False)
class WrittenPart:
    """A mesh of the file. vertices, normals: (n, 3), y up, m; triangles: (m, 3); material: as the file has it."""

    name: str
    vertices: np.ndarray
    normals: np.ndarray
    triangles: np.ndarray
    material: dict[str, Any]


class _Binary:
    """The buffer, and what stands where in it."""

    def __init__(self) -> None:
        self.bytes = bytearray()
        self.views: list[dict[str, int]] = []
        self.accessors: list[dict[str, Any]] = []

    def add(self, values: np.ndarray, target: int, **more: Any) -> int:
        """Add rows of numbers; return the number of their accessor."""
        data = np.ascontiguousarray(values)
        view = {"buffer": 0, "byteOffset": len(self.bytes), "byteLength": data.nbytes, "target": target}
        self.views.append(view)
        self.bytes += data.tobytes()
        kind = _FLOAT if data.dtype == np.float32 else _UINT
        shape = {"count": len(data), "type": "VEC3" if data.ndim == 2 else "SCALAR"}
        self.accessors.append({"bufferView": len(self.views) - 1, "componentType": kind, **shape, **more})
        return len(self.accessors) - 1


def write(path: Path, parts: Sequence[WrittenPart], generator: str) -> None:
    """Write a .glb, whole or not at all. Raises InputError if it cannot be written."""
    if path.suffix.lower() != ".glb":
        raise InputError(f"{path}: output must end in .glb")
    binary = _Binary()
    document = {
        "asset": {"version": "2.0", "generator": generator},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(parts)))}],
        "nodes": [{"name": part.name, "mesh": number} for number, part in enumerate(parts)],
        "meshes": [_mesh(binary, part, number) for number, part in enumerate(parts)],
        "materials": [part.material for part in parts],
        "accessors": binary.accessors,
        "bufferViews": binary.views,
        "buffers": [{"byteLength": len(binary.bytes)}],
        "extensionsUsed": sorted({name for part in parts for name in part.material.get("extensions", {})}),
    }
    text = json.dumps(document, separators=(",", ":")).encode()
    chunks = b"".join(
        struct.pack("<I4s", len(data), kind) + data
        for data, kind in ((_padded(text, b" "), b"JSON"), (_padded(bytes(binary.bytes), b"\0"), b"BIN\0"))
    )
    with replacing(path) as stream:
        stream.write(struct.pack("<4sII", b"glTF", _VERSION, 12 + len(chunks)) + chunks)


def _mesh(binary: _Binary, part: WrittenPart, number: int) -> dict[str, Any]:
    vertices = part.vertices.astype(np.float32)
    around = {"min": vertices.min(axis=0).tolist(), "max": vertices.max(axis=0).tolist()}
    attributes = {
        "POSITION": binary.add(vertices, _VERTICES, **around),
        "NORMAL": binary.add(part.normals.astype(np.float32), _VERTICES),
    }
    indices = binary.add(part.triangles.astype(np.uint32).ravel(), _INDICES)
    return {"name": part.name, "primitives": [{"attributes": attributes, "indices": indices, "material": number}]}


def _padded(data: bytes, with_: bytes) -> bytes:
    return data + with_ * (-len(data) % 4)
