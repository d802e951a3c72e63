"""Cameras of COLMAP: cameras.bin and images.bin of a sparse model, or the same as .txt.

A pose takes places of the world to camera axes right, down, forwards; the middle of the first pixel is at (0.5, 0.5).
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from quadgraph.acquisition.cameras import foreign
from quadgraph.acquisition.cameras.foreign import ForeignCameras, checked_lens, checked_pose, content
from quadgraph.acquisition.cameras.lens import Lens, Pose
from quadgraph.base.errors import InputError

# Number and name of each model, and which of fx, fy, cx, cy, k1, k2, p1, p2, k3 ... k6 each of its parameters is; "f"
# is both focal lengths.
_MODELS = {
    0: ("SIMPLE_PINHOLE", ("f", "cx", "cy")),
    1: ("PINHOLE", ("fx", "fy", "cx", "cy")),
    2: ("SIMPLE_RADIAL", ("f", "cx", "cy", "k1")),
    3: ("RADIAL", ("f", "cx", "cy", "k1", "k2")),
    4: ("OPENCV", ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2")),
    6: ("FULL_OPENCV", ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")),
}
_ORDER = _MODELS[6][1]
_NUMBERS = {name: number for number, (name, _) in _MODELS.items()}
_POINT_BYTES = 24  # x, y, and the number of the point in space
_MOST_NAME = 4096  # bytes


def is_model(folder: Path) -> bool:
    """Whether a folder holds a sparse model."""
    return any((folder / f"cameras{suffix}").is_file() for suffix in (".bin", ".txt"))


def read(folder: Path) -> ForeignCameras:
    """Read a sparse model. Raises InputError naming file, place, what was found and what is allowed."""
    binary = (folder / "cameras.bin").is_file()
    suffix = ".bin" if binary else ".txt"
    lenses = (_binary_lenses if binary else _text_lenses)(folder / f"cameras{suffix}")
    lens_of: dict[str, Lens] = {}
    poses: dict[str, Pose] = {}
    path = folder / f"images{suffix}"
    for where, number, quaternion, translation, name in (_binary_images if binary else _text_images)(path):
        if number not in lenses:
            raise InputError(f"{where}: camera {number} found, {folder / f'cameras{suffix}'} has no such camera")
        lens_of[name] = lenses[number]
        poses[name] = checked_pose(where, _rotation(where, quaternion), np.array(translation))
    if not poses:
        raise InputError(f"{path}: found no image with a pose, allowed is one or more; run COLMAP's mapper first")
    return ForeignCameras(folder, lens_of, poses)


def _lens(where: str, model: int, size: tuple[float, float], parameters: list[float]) -> Lens:
    names = _MODELS[model][1]
    values = dict(zip(names, parameters, strict=True))
    if "f" in values:
        values |= {"fx": values["f"], "fy": values["f"]}
    return checked_lens(where, size, [values.get(name, 0.0) for name in _ORDER])


def _unknown(where: str, found: object) -> InputError:
    return InputError(
        f"{where}: model {found} found, allowed are {', '.join(_NUMBERS)}; undistort the photographs by "
        "`colmap image_undistorter`, or reconstruct with OPENCV"
    )


def _rotation(where: str, quaternion: tuple[float, ...]) -> np.ndarray:
    """(3, 3) of w, x, y, z."""
    length = float(np.linalg.norm(quaternion))
    if not 0.5 < length < 2:
        raise InputError(f"{where}: rotation of length {length:g} found, allowed is a unit quaternion")
    w, x, y, z = np.array(quaternion) / length
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


class _Bytes:
    """The bytes of a file, taken from the front; little-endian."""

    def __init__(self, path: Path) -> None:
        self.path, self._data, self._at = path, content(path), 0

    def take(self, form: str, what: str) -> tuple:
        """The next values. Raises InputError where the file ends before."""
        size = struct.calcsize(f"<{form}")
        if size > len(self._data) - self._at:
            raise InputError(f"{self.path}: {what}: byte {self._at}: found the end, {size} bytes are stated")
        self._at += size
        return struct.unpack_from(f"<{form}", self._data, self._at - size)

    def skip(self, size: int, what: str) -> None:
        """Leave bytes out."""
        if size > len(self._data) - self._at:
            left = len(self._data) - self._at
            raise InputError(f"{self.path}: {what}: {size} bytes are stated at byte {self._at}, found are {left}")
        self._at += size

    def text(self, what: str) -> str:
        """A text that a zero ends."""
        end = self._data.find(b"\0", self._at, self._at + _MOST_NAME)
        if end < 0:
            raise InputError(f"{self.path}: {what}: byte {self._at}: found no end of a name within {_MOST_NAME} bytes")
        found = self._data[self._at : end].decode("utf-8", "replace")
        self._at = end + 1
        return found

    def count(self, least_bytes: int, most: int, what: str) -> int:
        """A number of records of at least so many bytes, which the file has to hold."""
        (found,) = self.take("Q", what)
        room = (len(self._data) - self._at) // least_bytes
        if found > min(room, most):
            raise InputError(
                f"{self.path}: {what}: {found} found, allowed are {most}, and the file has room for {room}; export it "
                "again"
            )
        return int(found)

    def finish(self) -> None:
        """Raise InputError where bytes are left."""
        if self._at != len(self._data):
            raise InputError(f"{self.path}: {len(self._data) - self._at} bytes found behind the last record")


def _binary_lenses(path: Path) -> dict[int, Lens]:
    data = _Bytes(path)
    found = {}
    for index in range(data.count(24, foreign.MOST_LENSES, "number of cameras")):
        what = f"camera {index} of the file"
        number, model, width, height = data.take("IiQQ", what)
        if model not in _MODELS:
            raise _unknown(f"{path}: {what}", model)
        parameters = list(data.take(f"{len(_MODELS[model][1])}d", what))
        found[number] = _lens(f"{path}: {what}", model, (width, height), parameters)
    data.finish()
    return found


def _binary_images(path: Path) -> Iterator[tuple[str, int, tuple, tuple, str]]:
    data = _Bytes(path)
    for index in range(data.count(4 + 56 + 4 + 1 + 8, foreign.MOST_IMAGES, "number of images")):
        what = f"image {index} of the file"
        data.take("I", what)
        quaternion, translation = data.take("4d", what), data.take("3d", what)
        (number,) = data.take("I", what)
        name = data.text(what)
        (points,) = data.take("Q", what)
        data.skip(points * _POINT_BYTES, f"{what}, points")
        yield f"{path}: {what}", number, quaternion, translation, name
    data.finish()


def _lines(path: Path) -> Iterator[tuple[str, str]]:
    """Place and text of each line that is no comment; empty ones too, as images without points have them."""
    for number, line in enumerate(content(path).decode("utf-8", "replace").split("\n"), 1):
        if not line.startswith("#"):
            yield f"{path}: line {number}", line.strip()


def _numbers(where: str, words: list[str]) -> list[float]:
    try:
        return [float(word) for word in words]
    except ValueError as error:
        raise InputError(f"{where}: {error}, allowed are numbers") from None


def _text_lenses(path: Path) -> dict[int, Lens]:
    found = {}
    for where, line in _lines(path):
        words = line.split()
        if not words:
            continue
        model = _NUMBERS.get(words[1] if len(words) > 1 else "")
        if model is None:
            raise _unknown(where, words[1] if len(words) > 1 else "nothing")
        wanted = 4 + len(_MODELS[model][1])
        if len(words) != wanted or not words[0].isdigit():
            raise InputError(f"{where}: {len(words)} words found, allowed are {wanted}: ID MODEL WIDTH HEIGHT PARAMS[]")
        width, height, *parameters = _numbers(where, words[2:])
        found[int(words[0])] = _lens(where, model, (width, height), parameters)
    return found


def _text_images(path: Path) -> Iterator[tuple[str, int, tuple, tuple, str]]:
    """Every other line is an image, and the ones between are its points."""
    lines = list(_lines(path))
    while lines and not lines[-1][1]:
        lines.pop()
    for where, line in lines[::2]:
        words = line.split(maxsplit=9)
        if len(words) != 10 or not words[8].isdigit():
            raise InputError(
                f"{where}: {len(words)} words found, allowed are 10: IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME"
            )
        numbers = _numbers(where, words[1:8])
        yield where, int(words[8]), tuple(numbers[:4]), tuple(numbers[4:]), words[9]
