"""Single exposures as linear values: 16-bit PNG, EXR and raw files. What is encoded for displays is refused."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph import core
from quadgraph.acquisition.board.board import EXTRA
from quadgraph.base.errors import InputError
from quadgraph.base.optional_package import optional_package

_ENCODED = (".jpg", ".jpeg", ".heic", ".heif", ".webp", ".gif", ".bmp")
RAW = (".dng", ".cr2", ".cr3", ".nef", ".nrw", ".arw", ".raf", ".rw2", ".orf", ".pef", ".srw", ".3fr", ".iiq")
_ALLOWED = ".png of 16 bits, .exr, and raw files (.dng, .cr2, .nef, .arw and others)"
_WHITE_SHARE = 0.98  # of full scale: values from there on are saturated
_PNG_HEAD = 26  # bytes, up to the bits of a sample
MOST_PIXELS = 160_000_000  # of a raw file, before four of its pixels become one
MOST_PIXELS_READ = 60_000_000


@dataclass(frozen=True, eq=False)
class Frame:
    """values: (h, w, 3) float32, black at 0 and full scale at 1 where the kind of file has one; saturated: (h, w, 3);
    shares: (3,) of the noise's variance that each channel has, for means of two pixels half; exposure: as the file says
    it, shutter time times sensitivity over the square of the f-number, or None.
    """

    values: np.ndarray
    saturated: np.ndarray
    shares: np.ndarray
    exposure: float | None


def read(where: str, path: Path, saturation: float | None) -> Frame:
    """Read one exposure; `where` begins every error. saturation: a value, None: as the kind of file has it.

    Raises InputError saying what was found, what is allowed and what to do.
    """
    suffix = path.suffix.lower()
    if suffix in _ENCODED:
        raise InputError(
            f"{where}: found {path.name}, {suffix.removeprefix('.')} of 8 bits with a tone curve for displays, from "
            f"which radiance cannot be had; allowed are {_ALLOWED}: let the camera keep raw files (on phones: Expert "
            "RAW, ProRAW, or an app that writes .dng)"
        )
    if suffix in RAW:
        return _raw(where, path, _WHITE_SHARE if saturation is None else saturation)
    if suffix not in (".png", ".exr"):
        raise InputError(f"{where}: found {path.name}, allowed are {_ALLOWED}")
    if suffix == ".png":
        _check_png(where, path)
        saturation = _WHITE_SHARE if saturation is None else saturation
    try:
        values = np.asarray(core.read_image(path), np.float32)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
    saturated = values >= (np.inf if saturation is None else saturation)
    return Frame(values, saturated, np.ones(3), None)


def _check_png(where: str, path: Path) -> None:
    with path.open("rb") as stream:
        head = stream.read(_PNG_HEAD)
    if len(head) < _PNG_HEAD or head[:4] != b"\x89PNG":
        raise InputError(f"{where}: {path.name} is no PNG, allowed are {_ALLOWED}")
    width, height, bits = int.from_bytes(head[16:20], "big"), int.from_bytes(head[20:24], "big"), head[24]
    if bits < 16:
        raise InputError(
            f"{where}: {path.name} has {bits} bits a channel, which are encoded for displays (sRGB) and not linear; "
            f"allowed are {_ALLOWED}: develop the raw file without tone curve, or give it as it is"
        )
    if width * height > MOST_PIXELS_READ:
        raise InputError(
            f"{where}: {path.name} has {width} x {height} pixels, allowed are {MOST_PIXELS_READ} in all; scale it down"
        )


def _raw(where: str, path: Path, saturation: float) -> Frame:
    """A raw file: four pixels of the sensor, of which two are green, become one; nothing else is done to them.

    Not demosaicing keeps values linear and their noise independent of each other.
    """
    rawpy = optional_package("rawpy", EXTRA)
    try:
        with rawpy.imread(str(path)) as raw:
            return _binned(where, path, raw, saturation)
    except InputError:
        raise
    except (rawpy.LibRawError, OSError, ValueError) as error:
        raise InputError(f"{where}: {path.name} cannot be read as a raw file: {str(error)[:160]}") from error


def _binned(where: str, path: Path, raw: Any, saturation: float) -> Frame:
    sizes = raw.sizes
    if sizes.width * sizes.height > MOST_PIXELS:
        raise InputError(
            f"{where}: {path.name} has {sizes.width} x {sizes.height} pixels, allowed are {MOST_PIXELS} in all"
        )
    pattern = raw.raw_pattern
    names = raw.color_desc.decode("ascii", "replace")
    if pattern is None or pattern.shape != (2, 2) or sorted(names[each] for each in pattern.ravel()) != list("BGGR"):
        raise InputError(
            f"{where}: {path.name} has no Bayer pattern of red, two green and blue; allowed is one: develop it into a "
            "linear .png of 16 bits"
        )
    visible, colours = raw.raw_image_visible, raw.raw_colors_visible
    high, wide = (side // 2 * 2 for side in visible.shape)
    black, white = np.array(raw.black_level_per_channel, np.float64), float(raw.white_level)
    values = np.zeros((high // 2, wide // 2, 3), np.float32)
    saturated = np.zeros(values.shape, bool)
    counts = np.zeros(3)
    for row in (0, 1):
        for column in (0, 1):
            colour = int(colours[row, column])
            channel = "RGB".index(names[colour])
            share = (visible[row:high:2, column:wide:2].astype(np.float32) - black[colour]) / (white - black[colour])
            values[..., channel] += share
            saturated[..., channel] |= share >= saturation
            counts[channel] += 1
    return Frame(values / counts.astype(np.float32), saturated, 1 / counts, _exposure(raw))


def _exposure(raw: Any) -> float | None:
    """Shutter time times sensitivity over the square of the f-number, as the file says them."""
    other = getattr(raw, "other", None)  # not there before rawpy 0.25
    if other is None:
        return None
    shutter, speed, aperture = float(other.shutter_speed), float(other.iso_speed), float(other.aperture)
    if not (np.isfinite([shutter, speed, aperture]).all() and shutter > 0 and speed > 0):
        return None
    return shutter * speed / 100 / (aperture**2 if aperture > 0 else 1.0)
