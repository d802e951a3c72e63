"""Foreign .npz files in Python: good ones as NumPy reads them, others refused by name before memory is taken."""

from __future__ import annotations

import io
import struct
import zipfile
from pathlib import Path

import numpy as np
import pytest

from quadgraph.base.errors import InputError
from quadgraph.file import npz

KNOWN = ("a", "b")


def written(path: Path, name: str, content: bytes) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(f"{name}.npy", content)
    return path


def array(values: np.ndarray, shape: str | None = None) -> bytes:
    stream = io.BytesIO()
    np.lib.format.write_array(stream, values)
    data = stream.getvalue()
    if shape is None:
        return data
    header = f"{{'descr': '{values.dtype.str}', 'fortran_order': False, 'shape': {shape}, }}".encode()
    return b"\x93NUMPY\x01\0" + struct.pack("<H", len(header)) + header + values.tobytes()


@pytest.mark.parametrize("save", [np.savez, np.savez_compressed])
def test_arrays_are_those_of_numpy(tmp_path, save):
    others = {"c": np.array(["unread"])}
    arrays = {"a": np.arange(24.0).reshape(2, 3, 4), "b": np.asfortranarray(np.ones((3, 2), "f4"))}
    save(tmp_path / "v.npz", **arrays, **others)
    found = npz.read(tmp_path / "v.npz", KNOWN)
    assert set(found) == set(KNOWN)
    assert all(np.array_equal(found[name], arrays[name]) for name in KNOWN)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a", array(np.ones(3), "(1000000000000,)"), "of float64 found, with 24 bytes of values"),
        ("a", array(np.ones(1), "(" + "1, " * 9 + ")"), "of float64 found, with 8 bytes"),
        ("a", array(np.array([None])), "of object found|pickle|Object arrays"),
        ("a", array(np.ones(3), "(1, 'x')"), "cannot be read as .npz"),
        ("a", b"nothing", "cannot be read as .npz"),
        ("a", bytes(300 << 20), "a has 314572800 bytes, packed in"),
    ],
)
def test_what_cannot_be_is_refused_by_name(tmp_path, name, content, message):
    path = written(tmp_path / "v.npz", name, content)
    with pytest.raises(InputError, match=message) as error:
        npz.read(path, KNOWN)
    assert str(path) in str(error.value)


def test_damage_is_refused_by_name_or_does_no_harm(tmp_path):
    path = tmp_path / "v.npz"
    np.savez(path, a=np.arange(24.0), b=np.ones(3))
    whole, random, refused = path.read_bytes(), np.random.default_rng(1), 0
    for k in range(500):
        damaged = bytearray(whole)
        for at in random.integers(0, len(whole), 3):
            damaged[at] = random.integers(256)
        path.write_bytes(damaged if k % 2 else whole[: random.integers(len(whole))])
        try:
            npz.read(path, KNOWN)
        except InputError as error:
            refused += str(path) in str(error)
    assert refused > 250
