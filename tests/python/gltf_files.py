"""glTF files for tests."""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph.mesh.surface import Surface

_KINDS = {"uint8": 5121, "uint16": 5123, "uint32": 5125, "float32": 5126}
_TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


class Builder:
    """Collects arrays in one buffer; `document` is what else is in the file, whose scene is node 0 and its children."""

    def __init__(self):
        self.binary = b""
        self.accessors: list[dict[str, Any]] = []
        self.views: list[dict[str, Any]] = []
        self.meshes: list[dict[str, Any]] = []
        self.document: dict[str, Any] = {}

    def add(self, values: np.ndarray, **more: Any) -> int:
        """Number of an accessor of the rows of `values`."""
        values = np.ascontiguousarray(values, np.float32 if values.dtype == np.float64 else values.dtype)
        kind, shape = _KINDS[values.dtype.name], _TYPES[values.shape[1]]
        view = {"bufferView": self.add_bytes(values.tobytes()), "componentType": kind, "type": shape}
        view["count"] = len(values)
        self.accessors.append(view | more)
        return len(self.accessors) - 1

    def add_bytes(self, data: bytes) -> int:
        """Number of a buffer view of bytes."""
        self.binary += b"\0" * (-len(self.binary) % 4)
        self.views.append({"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data)})
        self.binary += data
        return len(self.views) - 1

    def mesh(self, surface: Surface, **attributes: int) -> int:
        """Number of a mesh with these attributes besides its places."""
        places = {"POSITION": self.add(surface.vertices.astype(np.float32))}
        indices = self.add(surface.triangles.reshape(-1, 1).astype(np.uint32))
        self.meshes.append({"primitives": [{"attributes": places | attributes, "indices": indices}]})
        return len(self.meshes) - 1

    def write(self, path: Path) -> Path:
        """Write a .glb, or a .gltf that holds its buffer."""
        whole = {"asset": {"version": "2.0"}, "scenes": [{"nodes": self._roots()}], "meshes": self.meshes}
        whole |= {"accessors": self.accessors, "bufferViews": self.views, "buffers": [{"byteLength": len(self.binary)}]}
        whole |= self.document
        if path.suffix == ".gltf":
            data = base64.b64encode(self.binary).decode()
            whole["buffers"][0]["uri"] = f"data:application/octet-stream;base64,{data}"
            path.write_text(json.dumps(whole))
            return path
        text = json.dumps(whole).encode()
        text += b" " * (-len(text) % 4)
        binary = self.binary + b"\0" * (-len(self.binary) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
        chunks += struct.pack("<II", len(binary), 0x004E4942) + binary
        path.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)
        return path

    def _roots(self) -> list[int]:
        nodes = self.document.get("nodes", [])
        below = {child for number, node in enumerate(nodes) for child in node.get("children", []) if child != number}
        return [number for number in range(len(nodes)) if number not in below]
