"""A projector's calibration as OpenCV's YAML: the lens as of a camera, and where it stands over the board."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from quadgraph.acquisition.board.board import opencv
from quadgraph.acquisition.cameras import opencv_yaml
from quadgraph.acquisition.cameras.lens import Lens, Pose
from quadgraph.base.atomic_file import replacing
from quadgraph.base.errors import InputError

_TURNED = 1e-3  # by how much a rotation's rows may be no unit vectors across each other


def write(path: Path, lens: Lens, pose: Pose, rms: float) -> None:
    """Write lens and pose; rms: reprojection error, pixels. Raises InputError if it cannot be written."""
    cv2 = opencv()
    file = cv2.FileStorage(".yml", cv2.FileStorage_WRITE | cv2.FileStorage_MEMORY)
    file.write("image_width", lens.width)
    file.write("image_height", lens.height)
    file.write("camera_matrix", np.array([[lens.fx, 0, lens.cx - 0.5], [0, lens.fy, lens.cy - 0.5], [0, 0, 1.0]]))
    k1, k2, k3, *_ = lens.radial
    file.write("distortion_coefficients", np.array([[k1, k2, *lens.tangential, k3]]))
    file.write("rotation", np.asarray(pose.rotation, float))
    file.write("translation", np.asarray(pose.translation, float).reshape(3, 1))
    file.write("reprojection_error", float(rms))
    with replacing(path) as stream:
        stream.write(file.releaseAndGetString().encode())


def read(path: Path) -> tuple[Lens, Pose]:
    """Lens, and pose in the board's coordinates, mm. Raises InputError naming field, found and allowed."""
    lens = opencv_yaml.read(path).lens
    assert lens is not None
    rotation, translation = (opencv_yaml.numbers(path, name) for name in ("rotation", "translation"))
    for name, found, most in (("rotation", rotation, 9), ("translation", translation, 3)):
        if len(found) != most or not np.isfinite(found).all():
            raise InputError(
                f"{path}: {name}: found {len(found)} numbers, allowed are {most} finite ones, as quadgraph capture "
                "projector writes them"
            )
    turned = np.array(rotation).reshape(3, 3)
    if np.abs(turned @ turned.T - np.eye(3)).max() > _TURNED or np.linalg.det(turned) < 0:
        raise InputError(f"{path}: rotation: found no rotation, allowed is one; calibrate again")
    return lens, Pose(turned, np.array(translation))
