"""The lens that OpenCV's calibration writes as YAML (cv::FileStorage): camera_matrix, distortion_coefficients, size.

OpenCV counts places from the middle of the first pixel, so that half a pixel is added here.
"""

from __future__ import annotations

import re
from pathlib import Path

from quadgraph.acquisition.cameras.foreign import ForeignCameras, checked_lens, content
from quadgraph.base.errors import InputError

_MOST_BYTES = 8 << 20
_NUMBER = r"[-+0-9.eE]+"
_MATRIX = r"^{name}:\s*!!opencv-matrix\s+rows:\s*(\d+)\s+cols:\s*(\d+)\s+dt:\s*\"?[df]\"?\s+data:\s*\[([^\]]*)\]"
_NAMES = {
    "camera_matrix": ("camera_matrix", "cameraMatrix", "K", "M1"),
    "distortion_coefficients": ("distortion_coefficients", "distCoeffs", "dist_coeffs", "D", "D1"),
}
_SIZES = {"image_width": ("image_width", "imageWidth"), "image_height": ("image_height", "imageHeight")}
_COUNTS = (0, 4, 5, 8)  # of coefficients: k1, k2, p1, p2, k3, k4, k5, k6


def read(path: Path) -> ForeignCameras:
    """Read a lens; the poses come from elsewhere. Raises InputError naming field, found and allowed."""
    if path.suffix.lower() == ".xml":
        raise InputError(f"{path}: XML found, allowed is YAML; write it by cv::FileStorage as .yml")
    text = content(path)
    if len(text) > _MOST_BYTES:
        raise InputError(f"{path}: {len(text)} bytes found, allowed are {_MOST_BYTES}")
    said = text.decode("utf-8", "replace")
    matrix = _matrix(path, said, "camera_matrix")
    if matrix is None or len(matrix) != 9:
        raise InputError(f"{path}: camera_matrix: found {len(matrix or ())} numbers, allowed are 9: rows 3, cols 3")
    fx, skew, cx, _, fy, cy = matrix[:6]
    if skew:
        raise InputError(f"{path}: camera_matrix: skew of {skew:g} found, allowed is 0; calibrate without it")
    distortion = _matrix(path, said, "distortion_coefficients") or []
    while len(distortion) > 8 and distortion[-1] == 0:  # those of thin prisms and tilts, which OpenCV appends
        distortion.pop()
    if len(distortion) not in _COUNTS:
        raise InputError(
            f"{path}: distortion_coefficients: found {len(distortion)} numbers, allowed are 4, 5 or 8; calibrate "
            "without thin prism, tilt and fisheye"
        )
    size = (_size(path, said, "image_width"), _size(path, said, "image_height"))
    lens = checked_lens(str(path), size, [fx, fy, cx + 0.5, cy + 0.5, *distortion])
    return ForeignCameras(path, {}, {}, lens)


def numbers(path: Path, field: str) -> list[float]:
    """Those of a matrix of this name row by row, none where it is not there. Raises InputError."""
    return _matrix(path, content(path).decode("utf-8", "replace"), field) or []


def _matrix(path: Path, text: str, field: str) -> list[float] | None:
    """The numbers of a matrix row by row, None where there is none of its names."""
    for name in _NAMES.get(field, (field,)):
        if found := re.search(_MATRIX.format(name=name), text, re.MULTILINE):
            words = [word.strip() for word in found[3].replace("\n", " ").split(",") if word.strip()]
            if int(found[1]) * int(found[2]) != len(words):
                raise InputError(
                    f"{path}: {name}: found {len(words)} numbers, {found[1]} rows of {found[2]} are stated"
                )
            try:
                return [float(word) for word in words]
            except ValueError as error:
                raise InputError(f"{path}: {name}: {error}, allowed are numbers") from None
    return None


def _size(path: Path, text: str, field: str) -> float:
    for name in _SIZES[field]:
        if found := re.search(rf"^{name}:\s*({_NUMBER})\s*$", text, re.MULTILINE):
            try:
                return float(found[1])
            except ValueError:
                break
    raise InputError(f"{path}: {field}: is missing, it has to be there: add `{field}: PIXELS`")
