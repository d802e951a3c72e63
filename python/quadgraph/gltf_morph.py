"""Morph targets of a glTF 2.0 file: a mesh, and where each of its targets takes the vertices."""

from __future__ import annotations

import base64
import json
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph.errors import InputError

_GLB, _JSON_CHUNK, _BINARY_CHUNK = 0x46546C67, 0x4E4F534A, 0x004E4942
_TYPES = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
_WIDTHS = {"SCALAR": 1, "VEC3": 3}


@dataclass(frozen=True)
class MorphTargets:
    """vertices (n, 3), triangles (m, 3), targets (t, n, 3): displacements; all in the unit of the file's world."""

    vertices: np.ndarray
    triangles: np.ndarray
    targets: np.ndarray


def read_targets(path: Path) -> MorphTargets:
    """Read the triangles of the file's only mesh that has morph targets, under its node's transform.

    Raises InputError naming what is missing or not supported.
    """
    try:
        return _File(path).targets()
    except InputError:
        raise
    except (OSError, KeyError, IndexError, ValueError, TypeError, struct.error) as error:
        raise InputError(f"{path}: cannot be read as glTF: {type(error).__name__} {error}") from error


class _File:
    def __init__(self, path: Path):
        self.path = path
        data = path.read_bytes()
        self.binary = b""
        if data[:4] == _GLB.to_bytes(4, "little"):
            data, self.binary = _chunks(data)
        self.document: dict[str, Any] = json.loads(data)

    def targets(self) -> MorphTargets:
        found = [
            (node, transform)
            for node, transform in self._nodes()
            if any("targets" in part for part in self._mesh(node).get("primitives", []))
        ]
        if len(found) != 1:
            raise InputError(f"{self.path}: {len(found)} meshes with morph targets found, one is wanted")
        node, transform = found[0]
        parts = self._mesh(node)["primitives"]
        counts = {len(part.get("targets", [])) for part in parts}
        if len(counts) != 1 or any(part.get("mode", 4) != 4 for part in parts):
            raise InputError(f"{self.path}: triangles with equally many morph targets in every primitive are wanted")
        vertices = [self._accessor(part["attributes"]["POSITION"]) for part in parts]
        offsets = np.cumsum([0] + [len(some) for some in vertices])
        triangles = [self._triangles(part, len(some)) for part, some in zip(parts, vertices, strict=True)]
        targets = [
            np.concatenate([self._accessor(part["targets"][t]["POSITION"]) for part in parts])
            for t in range(counts.pop())
        ]
        linear, shift = transform[:3, :3], transform[:3, 3]
        return MorphTargets(
            np.concatenate(vertices) @ linear.T + shift,
            np.concatenate([some + offset for some, offset in zip(triangles, offsets, strict=False)]),
            np.array(targets) @ linear.T,
        )

    def _mesh(self, node: dict) -> dict:
        return self.document["meshes"][node["mesh"]] if "mesh" in node else {}

    def _nodes(self) -> list[tuple[dict, np.ndarray]]:
        """Every node of the scene with its transform to the world."""
        scene = self.document["scenes"][self.document.get("scene", 0)]
        waiting = [(index, np.eye(4)) for index in scene["nodes"]]
        found = []
        while waiting:
            index, above = waiting.pop()
            node = self.document["nodes"][index]
            transform = above @ _local(node)
            found.append((node, transform))
            waiting += [(child, transform) for child in node.get("children", [])]
        return found

    def _triangles(self, part: dict, count: int) -> np.ndarray:
        indices = self._accessor(part["indices"])[:, 0] if "indices" in part else np.arange(count)
        return indices.astype(np.int64).reshape(-1, 3)

    def _accessor(self, index: int) -> np.ndarray:
        accessor = self.document["accessors"][index]
        width, kind = _WIDTHS[accessor["type"]], _TYPES[accessor["componentType"]]
        values = np.zeros((accessor["count"], width), np.float64 if kind is np.float32 else np.int64)
        if "bufferView" in accessor:
            values[:] = self._view(accessor, kind, accessor["count"], width)
        if "sparse" in accessor:
            sparse = accessor["sparse"]
            where = self._view(sparse["indices"], _TYPES[sparse["indices"]["componentType"]], sparse["count"], 1)[:, 0]
            values[where] = self._view(sparse["values"], kind, sparse["count"], width)
        return values

    def _view(self, holder: dict, kind: type, count: int, width: int) -> np.ndarray:
        view = self.document["bufferViews"][holder["bufferView"]]
        data = self._buffer(view["buffer"])
        size = np.dtype(kind).itemsize
        first = view.get("byteOffset", 0) + holder.get("byteOffset", 0)
        stride = view.get("byteStride", size * width)
        if first + stride * (count - 1) + size * width > len(data):
            raise InputError(f"{self.path}: an accessor reaches beyond its buffer")
        return np.ndarray((count, width), kind, data, first, (stride, size))

    def _buffer(self, index: int) -> bytes:
        uri = self.document["buffers"][index].get("uri")
        if uri is None:
            return self.binary
        if uri.startswith("data:"):
            return base64.b64decode(uri.split(",", 1)[1])
        return (self.path.parent / uri).read_bytes()


def _chunks(data: bytes) -> tuple[bytes, bytes]:
    parts, at = {}, 12
    while at + 8 <= len(data):
        size, kind = struct.unpack_from("<II", data, at)
        parts[kind] = data[at + 8 : at + 8 + size]
        at += 8 + size
    return parts[_JSON_CHUNK], parts.get(_BINARY_CHUNK, b"")


def _local(node: dict) -> np.ndarray:
    if "matrix" in node:
        return np.array(node["matrix"], np.float64).reshape(4, 4).T
    x, y, z, w = node.get("rotation", [0, 0, 0, 1])
    transform = np.eye(4)
    transform[:3, :3] = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    ) * node.get("scale", [1, 1, 1])
    transform[:3, 3] = node.get("translation", [0, 0, 0])
    return transform
