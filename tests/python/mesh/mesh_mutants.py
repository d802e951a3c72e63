"""Small mesh files of every format, files that are made of them by damage, and what readers may do with such files."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import trimesh
from ply_files import ply_bytes

from gltf_files import Builder
from quadgraph.base.errors import InputError
from quadgraph.mesh.mesh_io import read_surface
from shapes import cube, write_obj

LONGEST_MESSAGE = 480
_WORDS = (
    b"-1",
    b"0",
    b"255",
    b"65536",
    b"2147483647",
    b"4294967295",
    b"9" * 30,
    b"1e999",
    b"nan",
    b"",
    b"[",
    b"{}",
    b"null",
)
_BYTES = np.array([0, 1, 3, 4, 127, 128, 254, 255], np.uint8)


def seeds(suffix: str) -> list[bytes]:
    """Whole files of a format."""
    body = cube(2.0)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"seed{suffix}"
        if suffix == ".ply":
            return [_ply(form) for form in ("ascii", "binary_little_endian", "binary_big_endian")]
        if suffix in (".glb", ".gltf"):
            builder = Builder()
            builder.mesh(body)
            builder.document = {"nodes": [{"mesh": 0, "translation": [1, 2, 3]}], "scene": 0}
            builder.write(path)
        elif suffix == ".obj":
            write_obj(body, path)
        else:
            trimesh.Trimesh(body.vertices, body.triangles, process=False).export(path)
        return [path.read_bytes()]


def _ply(form: str) -> bytes:
    body = cube(2.0)
    corners = [(index % 256, *vertex) for index, vertex in enumerate(body.vertices.tolist())]
    faces = [(0.5, tuple(triangle)) for triangle in body.triangles.tolist()]
    strips = [((0, 1, 2, 3, -1, 4, 5, 6),)]
    return ply_bytes(
        form,
        [
            ("vertex", [("uchar", "red"), ("float", "x"), ("double", "y"), ("float", "z")], corners),
            ("face", [("float", "quality"), ("uchar", "int", "vertex_indices")], [*faces, (0.5, (0, 1, 2, 3))]),
            ("tristrips", [("int", "int", "vertex_indices")], strips),
        ],
    )


def mutants(whole: bytes, count: int, seed: int) -> Iterator[bytes]:
    """Files with bytes changed, numbers of texts replaced, parts cut out or repeated; the same for the same seed."""
    random = np.random.default_rng(seed)
    for _ in range(count):
        data = bytearray(whole)
        for _ in range(random.integers(1, 4)):
            at = int(random.integers(len(data) + 1))
            kind = random.integers(6)
            if kind == 0:
                data[at : at + 1] = random.bytes(1)
            elif kind == 1:
                data[at : at + 4] = random.choice(_BYTES, 4).tobytes()
            elif kind == 2:
                del data[at : at + int(random.integers(1, 40))]
            elif kind == 3:
                data[at:at] = data[at : at + int(random.integers(1, 40))]
            elif kind == 4 and len(data) > 1:
                del data[at:]
            else:
                numbers = list(re.finditer(rb"\d+", bytes(data)))
                if numbers:
                    found = numbers[int(random.integers(len(numbers)))]
                    data[found.start() : found.end()] = _WORDS[int(random.integers(len(_WORDS)))]
        yield bytes(data)


def read(path: Path) -> bool:
    """Read a file that may be damaged: either a mesh, True, or an InputError that names it, False.

    Raises AssertionError for anything else, memory that runs out included.
    """
    try:
        source = read_surface(path, unit="mm")
    except InputError as error:
        refusal = error
    else:
        triangles = source.surface.triangles
        assert np.isfinite(source.surface.vertices).all()
        assert ((triangles >= 0) & (triangles < len(source.surface.vertices))).all()
        return True
    assert str(path) in str(refusal), refusal
    assert len(str(refusal)) < LONGEST_MESSAGE, refusal
    assert not isinstance(refusal.__cause__, MemoryError | RecursionError), refusal
    return False
