"""Photographs of a capture as arrays: values, variances, and which pixels count before anything is predicted."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from quadgraph import core
from quadgraph.acquisition.capture.capture import Capture, NoiseModel, Photograph
from quadgraph.base.errors import InputError
from quadgraph.file import npz

_SUFFIXES = (".exr", ".hdr", ".npz", ".png")
_PNG_BITS = 24  # the byte of a PNG that says its bits per sample
_MASK_LIMIT = 0.5
_CLIPPED, _CLIPPED_SHARE = 1e-6, 0.005  # how near the largest value, and of how many lit pixels, is clipping
_SPIKE, _STEPS = 5.0, 8  # how many times as many pixels as steps below it the largest value has, and how many steps


@dataclass(frozen=True, eq=False)
class Measured:
    """One photograph. values, variances: (h, w, 3) float64, variances without a noise model's part of the value; usable
    (h, w, 3): neither masked nor saturated; kept: (h, w), what a mask keeps in all channels, if there is one.
    """

    stated: Photograph
    values: np.ndarray
    variances: np.ndarray
    usable: np.ndarray
    kept: np.ndarray | None = None

    def variance_of(self, value: np.ndarray) -> np.ndarray:
        """Variance of pixels whose true value is `value`, (h, w, 3)."""
        noise = self.stated.noise
        return self.variances + noise.shot * np.maximum(value, 0) if isinstance(noise, NoiseModel) else self.variances


def read_all(capture: Capture) -> list[Measured]:
    """Read all photographs of a capture. Raises InputError naming the path into it, found and allowed."""
    return [_measured(capture, each) for each in capture.photographs]


def _measured(capture: Capture, stated: Photograph) -> Measured:
    size = capture.sizes[stated.camera]
    where = f"{capture.path}: {stated.path}"
    values = _image(f"{where}.file", stated.file, "photograph", size)
    if not (values > 0).any():
        raise InputError(f"{where}.file: {stated.file}: found no value above 0, allowed is a photograph that is lit")
    if isinstance(stated.noise, NoiseModel):
        variances = np.full(values.shape, stated.noise.read_out**2)
    else:
        variances = _image(f"{where}.variance", stated.noise, "variance", size)
        if not (variances > 0).all():
            raise InputError(f"{where}.variance: {stated.noise}: found a variance of 0 or less, allowed are above 0")
    usable = np.ones(values.shape, bool)
    if stated.saturation is not None:
        usable &= values < stated.saturation
    _check_clipped(where, stated, values)
    kept = None
    if stated.mask is not None:
        mask = _image(f"{where}.mask", stated.mask, "mask", size) > _MASK_LIMIT
        usable &= mask
        kept = np.asarray(mask.all(axis=2))
    if not usable.any():
        raise InputError(f"{where}: found no pixel that is neither saturated nor masked, allowed is at least one")
    return Measured(stated, values, variances, usable, kept)


def _check_clipped(where: str, stated: Photograph, values: np.ndarray) -> None:
    """Raise InputError where many pixels have the largest value of all and no saturation is stated, or a higher one."""
    for channel, name in enumerate(("red", "green", "blue")):
        value = values[..., channel]
        most = value.max()
        if most <= 0 or (stated.saturation is not None and most >= stated.saturation):
            continue
        clipped = int((value >= most * (1 - _CLIPPED)).sum())
        if clipped <= max(3, _CLIPPED_SHARE * (value > 0.05 * most).sum()):
            continue
        if stated.saturation is None:
            raise InputError(
                f"{where}.saturation: not stated, and {clipped} pixels of {stated.file.name} have the same largest "
                f"value {most:.6g} in {name}; state the value from which on pixels are saturated, or expose for less"
            )
        # Steps of few bits have many pixels, too: those below have as many.
        _, below = np.unique(value[value < most * (1 - _CLIPPED)], return_counts=True)
        if clipped > _SPIKE * below[-_STEPS:].mean():
            raise InputError(
                f"{where}.saturation: found {stated.saturation:g}, but {clipped} pixels of {stated.file.name} have "
                f"the same largest value {most:.6g} in {name}; state the value from which on pixels are saturated"
            )


def _image(where: str, path: Path, name: str, size: tuple[int, int]) -> np.ndarray:
    """(h, w, 3) float64 of a linear image. Raises InputError."""
    suffix = path.suffix.lower()
    if suffix not in _SUFFIXES:
        raise InputError(f"{where}: found {path.name}, allowed are linear images: .exr, .hdr, .npz and 16-bit .png")
    if suffix == ".png" and name != "mask":
        _check_png(where, path)
    try:
        found = _npz(path, name) if suffix == ".npz" else np.asarray(core.read_image(path), np.float64)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
    if found.ndim == 2:
        found = np.repeat(found[..., None], 3, axis=2)
    if found.shape != (size[1], size[0], 3):
        shape = " x ".join(map(str, found.shape[1::-1])) if found.ndim == 3 else str(found.shape)
        raise InputError(
            f"{where}: {path.name} has {shape} pixels, allowed are those of its camera, {size[0]} x {size[1]} in three "
            "channels or one; state the camera's width and height as the file has them"
        )
    return found


def _npz(path: Path, name: str) -> np.ndarray:
    arrays = npz.read(path, (name,))
    if name not in arrays:
        raise InputError(f"{path}: found no array {name}, it has to be there: (h, w, 3) or (h, w)")
    found = arrays[name]
    if found.dtype.kind not in "fiub" or not np.isfinite(found).all():
        raise InputError(f"{path}: {name}: {found.dtype} or not finite somewhere, allowed are finite numbers")
    return np.asarray(found, np.float64)


def _check_png(where: str, path: Path) -> None:
    """Raise InputError for a PNG of 8 bits, whose values are encoded for a display."""
    with path.open("rb") as stream:
        head = stream.read(_PNG_BITS + 1)
    if len(head) > _PNG_BITS and head[_PNG_BITS] < 16:
        raise InputError(
            f"{where}: {path.name} has {head[_PNG_BITS]} bits a channel, which are encoded for displays (sRGB) and not "
            "linear; allowed are linear .exr, .hdr, .npz and 16-bit .png: develop the raw file without tone curve"
        )
