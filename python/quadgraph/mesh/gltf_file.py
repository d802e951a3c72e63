"""What is in a glTF 2.0 file: nodes, and accessors as arrays."""

from __future__ import annotations

import base64
import struct
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from quadgraph.base import json_text, regular_file
from quadgraph.base.errors import InputError

T = TypeVar("T")

_GLB, _JSON_CHUNK, _BINARY_CHUNK = 0x46546C67, 0x4E4F534A, 0x004E4942
_TYPES: dict[int, type[np.number]] = {
    5120: np.int8,
    5121: np.uint8,
    5122: np.int16,
    5123: np.uint16,
    5125: np.uint32,
    5126: np.float32,
}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
LARGEST = 1e12  # of the numbers of a transform
_PACKED = ("KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression")


def read(path: Path, wanted: Callable[[GltfFile], T]) -> T:
    """`wanted` of the file. Raises InputError naming what is missing or not supported."""
    try:
        return wanted(GltfFile(path))
    except InputError:
        raise
    except (OSError, LookupError, ValueError, TypeError, AttributeError, struct.error) as error:
        raise InputError(f"{path}: cannot be read as glTF: {type(error).__name__} {error}") from error


def check_plain(file: GltfFile) -> None:
    """Raise InputError for what the reader of meshes ignores or trusts: what is in no buffer, huge transforms."""
    for number, accessor in enumerate(file.document.get("accessors", [])):
        if "sparse" in accessor:
            raise InputError(f"{file.path}, accessor {number}: sparse found, which is not read; write it without")
        if "bufferView" not in accessor:  # all zeros, as many as it says
            raise InputError(f"{file.path}, accessor {number}: no bufferView found, one is wanted")
    for number, buffer in enumerate(file.document.get("buffers", [])):
        name = buffer.get("uri", "data:")
        if not name.startswith("data:") and not (file.path.parent / name).is_file():
            raise InputError(f"{file.path}, buffer {number}: {name} found, which is no file beside it")
    for number, node in enumerate(file.document.get("nodes", [])):
        values = [float(x) for name in ("matrix", "translation", "rotation", "scale") for x in node.get(name, [])]
        if not all(abs(value) <= LARGEST for value in values):
            raise InputError(f"{file.path}, node {number}: a transform with numbers above {LARGEST:g} or none found")


class GltfFile:
    """A .gltf, or a .glb, with its buffers read when they are wanted."""

    def __init__(self, path: Path):
        self.path = path
        data = path.read_bytes()
        self.binary = b""
        if data[:4] == _GLB.to_bytes(4, "little"):
            data, self.binary = _chunks(path, data)
        self.document: dict[str, Any] = _document(path, data)
        for name in self.document.get("extensionsRequired", []):
            if name in _PACKED:
                raise InputError(f"{path}: extension {name} found, which is not supported: write it without")

    def mesh(self, node: dict) -> dict:
        """The mesh of a node; empty if it has none."""
        return self.document["meshes"][node["mesh"]] if "mesh" in node else {}

    def transforms(self, posed: Mapping[int, dict] | None = None) -> dict[int, np.ndarray]:
        """Transform to the world of every node of the scene by its number, (4, 4).

        `posed`: by number of a node, what its translation, rotation or scale are instead.
        """
        scene = self.document["scenes"][self.document.get("scene", 0)]
        waiting = [(index, np.eye(4)) for index in scene["nodes"]]
        found: dict[int, np.ndarray] = {}
        while waiting:
            index, above = waiting.pop()
            if index in found:
                raise InputError(f"{self.path}: node {index} is reached twice, nodes must form trees")
            node = self.document["nodes"][index]
            found[index] = above @ _local({**node, **(posed or {}).get(index, {})})
            waiting += [(child, found[index]) for child in node.get("children", [])]
        return found

    def positions(self, parts: list[dict]) -> tuple[np.ndarray, np.ndarray]:
        """Vertices (n, 3) and triangles (m, 3) of all primitives together."""
        if any(part.get("mode", 4) != 4 for part in parts):
            raise InputError(f"{self.path}: only primitives of triangles are supported")
        vertices = [self.accessor(part["attributes"]["POSITION"]) for part in parts]
        offsets = np.cumsum([0] + [len(some) for some in vertices])
        triangles = [self._triangles(part, len(some)) for part, some in zip(parts, vertices, strict=True)]
        return np.concatenate(vertices), np.concatenate(
            [some + offset for some, offset in zip(triangles, offsets, strict=False)]
        )

    def _triangles(self, part: dict, count: int) -> np.ndarray:
        indices = self.accessor(part["indices"])[:, 0] if "indices" in part else np.arange(count)
        if len(indices) and not 0 <= indices.min() <= indices.max() < count:
            raise InputError(f"{self.path}: a triangle has vertex {indices.max():.0f}, there are {count}")
        return indices.astype(np.int64).reshape(-1, 3)

    def accessor(self, index: int) -> np.ndarray:
        """(count, width) of it; whole numbers as int64, or float64 where they are normalised."""
        accessor = self.document["accessors"][index]
        width, kind, count = _WIDTHS[accessor["type"]], _TYPES[accessor["componentType"]], accessor["count"]
        found = self._view(accessor, kind, count, width) if "bufferView" in accessor else None
        if found is None and not 0 <= count * width <= self._bytes():
            raise InputError(f"{self.path}, accessor {index}: count {count} found, more than the buffers can need")
        values = np.zeros((count, width), np.float64 if kind is np.float32 else np.int64)
        if found is not None:
            with np.errstate(invalid="ignore"):  # a signalling NaN is one for who uses it
                values[:] = found
        if "sparse" in accessor:
            sparse = accessor["sparse"]
            where = self._view(sparse["indices"], _TYPES[sparse["indices"]["componentType"]], sparse["count"], 1)[:, 0]
            values[where] = self._view(sparse["values"], kind, sparse["count"], width)
        if accessor.get("normalized", False) and kind is not np.float32:
            return np.maximum(values / np.iinfo(np.dtype(kind)).max, -1)
        return values

    def _view(self, holder: dict, kind: type, count: int, width: int) -> np.ndarray:
        view = self.document["bufferViews"][holder["bufferView"]]
        data = self._buffer(view["buffer"])
        size = np.dtype(kind).itemsize
        first = view.get("byteOffset", 0) + holder.get("byteOffset", 0)
        stride = view.get("byteStride", size * width)
        if first < 0 or count < 0 or stride < size or first + stride * (count - 1) + size * width > len(data):
            raise InputError(f"{self.path}: an accessor reaches beyond its buffer")
        return np.ndarray((count, width), kind, data, first, (stride, size))

    def view_bytes(self, index: int) -> bytes:
        """Bytes of a buffer view."""
        view = self.document["bufferViews"][index]
        data, first, count = self._buffer(view["buffer"]), view.get("byteOffset", 0), view["byteLength"]
        if first < 0 or count < 0 or first + count > len(data):
            raise InputError(f"{self.path}, buffer view {index}: reaches beyond its buffer")
        return data[first : first + count]

    def _bytes(self) -> int:
        """Of all buffers together."""
        return sum(len(self._buffer(index)) for index in range(len(self.document.get("buffers", []))))

    def _buffer(self, index: int) -> bytes:
        uri = self.document["buffers"][index].get("uri")
        if uri is None:
            return self.binary
        if uri.startswith("data:"):
            return base64.b64decode(uri.split(",", 1)[1])
        return regular_file.read_bytes(self.path.parent / uri)


def _document(path: Path, text: bytes) -> dict[str, Any]:
    try:
        document = json_text.loads(text)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    if not isinstance(document, dict):
        raise InputError(f"{path}: cannot be read as glTF: {type(document).__name__} found, an object is wanted")
    return document


def _chunks(path: Path, data: bytes) -> tuple[bytes, bytes]:
    parts, at = {}, 12
    while at + 8 <= len(data):
        size, kind = struct.unpack_from("<II", data, at)
        if size > len(data) - at - 8:
            raise InputError(f"{path}: a chunk of {size} bytes found, {len(data) - at - 8} are left in the file")
        parts[kind] = data[at + 8 : at + 8 + size]
        at += 8 + size
    if _JSON_CHUNK not in parts:
        raise InputError(f"{path}: cannot be read as GLB: no chunk of JSON found")
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
