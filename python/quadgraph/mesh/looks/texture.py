"""Textures: pictures in or beside a mesh file, held against limits before they are decoded, and their colours."""

from __future__ import annotations

import io
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Literal

import numpy as np

from quadgraph.base import regular_file
from quadgraph.base.errors import InputError

FORMATS = ("PNG", "JPEG", "WEBP", "BMP", "TGA", "TIFF")
MOST_PIXELS = 50_000_000  # of a picture, as of all images (docs/limits.md): 0.15 GB decoded
MOST_TOGETHER = 200_000_000  # pixels of all pictures of a mesh: 0.6 GB
MOST_BYTES = 1 << 28  # of a picture's file
MOST_UV = 1e5  # a larger coordinate has lost the place within the texture to rounding
Wrap = Literal["repeat", "clamp", "mirror"]


def linear(srgb: np.ndarray) -> np.ndarray:
    """Linear light of sRGB values, 0 to 1 (IEC 61966-2-1)."""
    with np.errstate(over="ignore"):  # what is no colour stays none
        return np.where(srgb <= 0.04045, srgb / 12.92, ((np.maximum(srgb, 0) + 0.055) / 1.055) ** 2.4)


_LINEAR = linear(np.arange(256) / 255)


@dataclass(frozen=True, eq=False)
class Texture:
    """A picture on a surface. pixels: (h, w, 3) uint8 sRGB, the first row at v = 0; wrap: beyond 0 to 1, along u, v."""

    pixels: np.ndarray
    wrap: tuple[Wrap, Wrap] = ("repeat", "repeat")

    def at(self, uv: np.ndarray) -> np.ndarray:
        """Linear RGB at (n, 2) places, (n, 3): between pixels as their linear light."""
        height, width = self.pixels.shape[:2]
        place = np.asarray(uv, np.float64) * [width, height] - 0.5
        first = np.floor(place)
        share = place - first
        found = np.zeros((len(place), 3))
        for right in (0, 1):
            column = _wrapped(first[:, 0] + right, width, self.wrap[0])
            across = share[:, 0] if right else 1 - share[:, 0]
            for below in (0, 1):
                row = _wrapped(first[:, 1] + below, height, self.wrap[1])
                weight = across * (share[:, 1] if below else 1 - share[:, 1])
                found += weight[:, None] * _LINEAR[self.pixels[row, column]]
        return found


def _wrapped(index: np.ndarray, count: int, wrap: Wrap) -> np.ndarray:
    if wrap == "clamp":
        return np.clip(index, 0, count - 1).astype(np.int64)
    if wrap == "repeat":
        return np.mod(index, count).astype(np.int64)
    twice = np.mod(index, 2 * count)
    return np.minimum(twice, 2 * count - 1 - twice).astype(np.int64)


def decoded(data: bytes, where: str, most: int = MOST_PIXELS) -> np.ndarray:
    """Pixels (h, w, 3) uint8 of a picture's bytes; transparency is left out.

    where: file and field, for errors; most: pixels. Raises InputError for another format, more pixels than that or a
    damaged picture.
    """
    from PIL import Image, UnidentifiedImageError

    if len(data) > MOST_BYTES:
        raise InputError(f"{where}: a picture of {len(data)} bytes found, at most {MOST_BYTES} are allowed")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)  # our limit is lower
            picture = Image.open(io.BytesIO(data), formats=FORMATS)
            if not 0 < picture.width * picture.height <= most:
                raise InputError(
                    f"{where}: a picture of {picture.width} x {picture.height} pixels found, allowed are 1 to "
                    f"{MOST_PIXELS}, and {MOST_TOGETHER} in all pictures of a mesh; write it smaller"
                )
            return _rgb(picture)
    except InputError:
        raise
    except Image.DecompressionBombError as error:  # Pillow's limit, which it holds a header against
        raise InputError(f"{where}: a picture of more than {MOST_PIXELS} pixels found; write it smaller") from error
    except Exception as error:  # Pillow's decoders raise whatever they meet
        foreign = isinstance(error, UnidentifiedImageError)
        words = "another kind of file" if foreign else " ".join(str(error).split())[:200] or type(error).__name__
        raise InputError(f"{where}: cannot be read as a picture ({words}); allowed are {', '.join(FORMATS)}") from error


class Pictures:
    """The pictures of a mesh, each decoded once, and no more pixels of all than MOST_TOGETHER.

    mesh: the file; files: those beside it that were read.
    """

    def __init__(self, mesh: Path) -> None:
        self.mesh = mesh
        self.files: list[Path] = []
        self._known: dict[object, np.ndarray] = {}

    def inside(self, key: object, data: Callable[[], bytes], where: str) -> np.ndarray:
        """Pixels of bytes in the mesh file, or of the same key as before. Raises InputError as `decoded`."""
        if key not in self._known:
            used = sum(pixels.shape[0] * pixels.shape[1] for pixels in self._known.values())
            self._known[key] = decoded(data(), where, min(MOST_PIXELS, MOST_TOGETHER - used))
        return self._known[key]

    def beside(self, name: str, where: str) -> np.ndarray:
        """Pixels of a file as `read` finds it. Raises InputError as `read` and `decoded`."""
        return self.inside(name, lambda: self.read(name, where), where)

    def read(self, name: str, where: str) -> bytes:
        """Bytes of a file in the mesh's folder or below it, by the name that the mesh has for it.

        where: the field that names it. Raises InputError where that leads out of the folder, to no file, or to one that
        is too large.
        """
        plain = name.replace("\\", "/")
        path, folder = self.mesh.parent / plain, self.mesh.parent.resolve()
        outside = ":" in plain.split("/")[0] or "\0" in plain or PurePosixPath(plain).is_absolute()
        if outside or not path.resolve().is_relative_to(folder):
            raise InputError(
                f"{where}: {name[:200]!r} found, allowed is a picture in the mesh's folder or below it; copy it there "
                "and name it so"
            )
        try:
            if path.exists() and path.stat().st_size > MOST_BYTES:
                found = f"{name[:200]!r} has {path.stat().st_size} bytes"
                raise InputError(f"{where}: {found}, at most {MOST_BYTES} are allowed")
            data = regular_file.read_bytes(path)
        except OSError as error:
            raise InputError(
                f"{where}: {name[:200]!r} found, which cannot be read beside the mesh ({error.strerror})"
            ) from error
        self.files.append(path)
        return data


def _rgb(picture) -> np.ndarray:
    if picture.mode.startswith("I"):  # 16 bits of grey, which Pillow would cut off
        grey = np.clip(np.asarray(picture, np.int64) // 257, 0, 255).astype(np.uint8)
        return np.repeat(grey[..., None], 3, axis=2)
    return np.asarray(picture.convert("RGB"), np.uint8)
