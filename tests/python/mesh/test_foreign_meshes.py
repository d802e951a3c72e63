"""Mesh files whose headers promise what the file does not hold: refused before memory is taken, and nothing ends."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np
import pytest

from quadgraph.base.errors import InputError
from quadgraph.mesh import gltf_file
from quadgraph.mesh.mesh_io import read_surface
from shapes import cube


def ply(vertices: int = 3, faces: int = 1, of: bytes = b"uchar", count: bytes = b"\3", body: bytes = b"") -> bytes:
    """A binary PLY of a triangle; `of`, `count`: type and bytes of the length of its list."""
    xyz = b"".join(b"property float %c\n" % axis for axis in b"xyz")
    head = b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % vertices
    face = b"element face %d\nproperty list %s int vertex_indices\nend_header\n" % (faces, of)
    return head + xyz + face + np.eye(3, dtype="<f4").tobytes() + count + struct.pack("<3i", 0, 1, 2) + body


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (ply(vertices=2_000_000_000), "element vertex: 2000000000 found"),
        (ply(faces=2_000_000_000), "element face: 2000000000 found"),
        (
            ply(of=b"uint", count=struct.pack("<I", 2**31 - 1)),
            "element face, row 0, .*: a list of 2147483647 found",
        ),
        (
            ply(of=b"int", count=struct.pack("<i", -1)),
            "element face, row 0, .*: a list of -1 found",
        ),
        (ply(of=b"float", count=struct.pack("<f", 1e30)), "cannot read 'property list float int"),
        (ply(faces=2), "element face, row 1: cut off, 0 bytes are left"),
        (
            ply(of=b"uint", count=b"").replace(b"binary_little_endian", b"ascii"),
            "element vertex: 3 found .* is no number",
        ),
        (b"ply\nformat ascii 1.0\nelement vertex x\nend_header\n", "cannot read 'element vertex x'"),
        (b"no mesh at all", "no 'ply' to 'end_header'"),
    ],
)
def test_a_ply_that_cannot_hold_its_header_is_refused(tmp_path, data, message):
    path = tmp_path / "bad.ply"
    path.write_bytes(data)
    with pytest.raises(InputError, match=message) as error:
        read_surface(path, unit="mm")
    assert len(str(error.value)) < 500


@pytest.mark.parametrize("mixed", [False, True])
def test_good_plys_are_read_as_before(tmp_path, mixed):
    path = tmp_path / "good.ply"
    quad = b"\4" + struct.pack("<4i", 0, 1, 2, 0)
    path.write_bytes(ply(faces=3, body=(quad if mixed else b"\3" + struct.pack("<3i", 0, 2, 1)) * 2))
    assert read_surface(path, unit="mm").vertices == 3


def test_a_binary_stl_that_is_cut_off_is_refused(tmp_path):
    path = tmp_path / "cut.stl"
    path.write_bytes(bytes(80) + struct.pack("<I", 100) + bytes(50 * 99))
    with pytest.raises(InputError, match="100 triangles are stated, which take 5084"):
        read_surface(path, unit="mm")


def gltf(path: Path, change) -> Path:
    surface = cube(2.0)
    vertices, triangles = surface.vertices.astype("<f4"), surface.triangles.astype("<u4")
    path.with_suffix(".bin").write_bytes(vertices.tobytes() + triangles.tobytes())
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"uri": path.with_suffix(".bin").name, "byteLength": vertices.nbytes + triangles.nbytes}],
        "bufferViews": [
            {"buffer": 0, "byteLength": vertices.nbytes},
            {"buffer": 0, "byteOffset": vertices.nbytes, "byteLength": triangles.nbytes},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(vertices), "type": "VEC3",
             "min": vertices.min(axis=0).tolist(), "max": vertices.max(axis=0).tolist()},
            {"bufferView": 1, "componentType": 5125, "count": triangles.size, "type": "SCALAR"},
        ],
    }  # fmt: skip
    change(document)
    path.write_text(json.dumps(document))
    return path


def _unstored(document):
    del document["accessors"][0]["bufferView"]


def test_memory_is_not_taken_for_numbers_that_a_gltf_does_not_store(tmp_path):
    path = gltf(tmp_path / "zeros.gltf", lambda d: d["accessors"][0].update(count=1 << 40) or _unstored(d))
    with pytest.raises(InputError, match="accessor 0: count 1099511627776 found"):
        gltf_file.read(path, lambda file: file.accessor(0))
    path = gltf(path, lambda d: d["accessors"][0].update(count=1 << 40))
    with pytest.raises(InputError, match="reaches beyond its buffer"):
        gltf_file.read(path, lambda file: file.accessor(0))
    path = gltf(path, lambda d: d["bufferViews"][0].update(byteStride=0))
    with pytest.raises(InputError, match="reaches beyond its buffer"):
        gltf_file.read(path, lambda file: file.accessor(0))
    assert gltf_file.read(gltf(path, _unstored), lambda file: file.accessor(0)).tolist() == [[0, 0, 0]] * 8


def test_what_is_not_read_of_a_gltf_is_refused(tmp_path):
    assert read_surface(gltf(tmp_path / "good.gltf", lambda document: None), unit="mm").vertices == 8
    sparse = gltf(tmp_path / "sparse.gltf", lambda d: d["accessors"][0].update(sparse={"count": 1}))
    with pytest.raises(InputError, match="accessor 0: sparse found"):
        read_surface(sparse, unit="mm")
    zeros = gltf(tmp_path / "zeros.gltf", lambda d: d["accessors"][0].update(count=1 << 32) or _unstored(d))
    with pytest.raises(InputError, match="accessor 0: no bufferView found"):
        read_surface(zeros, unit="mm")
    device = gltf(tmp_path / "device.gltf", lambda d: d["buffers"][0].update(uri="/dev/zero"))
    with pytest.raises(InputError, match="buffer 0: /dev/zero found, which is no file"):
        read_surface(device, unit="mm")
    far = gltf(tmp_path / "far.gltf", lambda d: d["nodes"][0].update(matrix=[1e300] * 16))
    with pytest.raises(InputError, match="node 0: a transform with numbers above 1e"):
        read_surface(far, unit="mm")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"glTF\2\0\0\0\x1c\0\0\0\xff\xff\xff\x7fJSON{}  ", "a chunk of 2147483647 bytes found, 4 are left"),
        (b"glTF\2\0\0\0\x18\0\0\0\4\0\0\0BIN\0{}  ", "no chunk of JSON found"),
        (b'{"asset": ]', "no JSON at line 1, column 11"),
        (b"[1, 2]", "list found, an object is wanted"),
    ],
)
def test_what_is_no_gltf_is_refused_by_name(tmp_path, content, message):
    path = tmp_path / ("bad.glb" if content.startswith(b"glTF") else "bad.gltf")
    path.write_bytes(content)
    with pytest.raises(InputError, match=message) as error:
        read_surface(path, unit="mm")
    assert str(path) in str(error.value)


@pytest.mark.parametrize("scale", [1e-30, 1e-12, 1e12, 1e300])
def test_bodies_beyond_single_precision_are_refused(tmp_path, scale):
    path = tmp_path / "body.obj"
    surface = cube(2.0)
    lines = ["v " + " ".join(f"{x * scale!r}" for x in vertex) for vertex in surface.vertices.tolist()]
    lines += ["f " + " ".join(str(k + 1) for k in triangle) for triangle in surface.triangles.tolist()]
    path.write_text("\n".join(lines))
    with pytest.raises(InputError, match=r"longest side of .* mm found"):
        read_surface(path, unit="mm")
