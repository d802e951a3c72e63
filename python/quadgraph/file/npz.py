"""Arrays of a foreign .npz, by the rules of engine/scene/npz.cpp: nothing is taken that the file cannot hold."""

from __future__ import annotations

import io
import math
import zipfile
from collections.abc import Collection
from pathlib import Path

import numpy as np
from numpy.lib import format as npy

from quadgraph.base.errors import InputError

FREE_BYTES, MOST_PACKED = 128 << 20, 20  # that a member may take beyond its packed bytes, and how often those
MOST_AXES = 8


def read(path: Path, known: Collection[str]) -> dict[str, np.ndarray]:
    """Return those arrays of `known` names that are there; others are left unread.

    Raises InputError naming the file, the member, what was found and what is allowed.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            members = {member.filename.removesuffix(".npy"): member for member in archive.infolist()}
            return {name: _array(path, archive, name, members[name]) for name in known if name in members}
    except InputError:
        raise
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from error
    except Exception as error:  # zipfile, zlib and NumPy raise whatever they meet
        raise InputError(f"{path}: cannot be read as .npz: {str(error)[:200] or type(error).__name__}") from error


def _array(path: Path, archive: zipfile.ZipFile, name: str, member: zipfile.ZipInfo) -> np.ndarray:
    packed = min(member.compress_size, path.stat().st_size)
    if member.file_size > packed * MOST_PACKED + FREE_BYTES:
        raise InputError(
            f"{path}: {name} has {member.file_size} bytes, packed in {packed}; more than {FREE_BYTES >> 20} MiB are "
            f"allowed up to {MOST_PACKED} times the packed ones"
        )
    data = io.BytesIO(archive.read(member))
    shape, kind = _header(data)
    left = data.getbuffer().nbytes - data.tell()
    if len(shape) > MOST_AXES or math.prod(shape) * kind.itemsize != left:
        raise InputError(f"{path}: {name}: shape {str(shape)[:80]} of {kind} found, with {left} bytes of values")
    data.seek(0)
    return npy.read_array(data, allow_pickle=False)


def _header(data: io.BytesIO) -> tuple[tuple[int, ...], np.dtype]:
    """Shape and type of the array that follows."""
    version = npy.read_magic(data)
    shape, _, kind = (npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0)(data)
    return shape, kind
