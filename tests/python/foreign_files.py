"""Cameras written as other programs write them, from the formats' own descriptions."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from quadgraph.acquisition.cameras.lens import Lens, Pose

OPENCV, FULL_OPENCV = 4, 6


def quaternion(pose: Pose) -> list[float]:
    """w, x, y, z."""
    x, y, z, w = Rotation.from_matrix(pose.rotation).as_quat()
    return [w, x, y, z]


def parameters(lens: Lens) -> list[float]:
    """Those of FULL_OPENCV; the first eight those of OPENCV."""
    k1, k2, k3, k4, k5, k6 = lens.radial
    return [lens.fx, lens.fy, lens.cx, lens.cy, k1, k2, *lens.tangential, k3, k4, k5, k6]


def colmap_binary(folder: Path, cameras: Mapping[str, tuple[Lens, Pose]], model: int = FULL_OPENCV) -> None:
    """cameras.bin and images.bin, each image with a lens and two points of its own."""
    lenses = struct.pack("<Q", len(cameras))
    images = struct.pack("<Q", len(cameras))
    for number, (name, (lens, pose)) in enumerate(cameras.items(), 1):
        numbers = parameters(lens)[: 8 if model == OPENCV else 12]
        lenses += struct.pack("<IiQQ", number, model, lens.width, lens.height) + struct.pack(
            f"<{len(numbers)}d", *numbers
        )
        images += struct.pack("<I7dI", number, *quaternion(pose), *pose.translation, number)
        images += name.encode() + b"\0" + struct.pack("<Q", 2) + struct.pack("<ddqddq", 1, 2, -1, 3, 4, 7)
    (folder / "cameras.bin").write_bytes(lenses)
    (folder / "images.bin").write_bytes(images)


def colmap_text(folder: Path, cameras: Mapping[str, tuple[Lens, Pose]]) -> None:
    """cameras.txt and images.txt; the last image has no points, and its line is empty."""
    lenses, images = ["# Camera list"], ["# Image list with two lines of data per image:"]
    for number, (name, (lens, pose)) in enumerate(cameras.items(), 1):
        numbers = " ".join(map(repr, parameters(lens)))
        lenses.append(f"{number} FULL_OPENCV {lens.width} {lens.height} {numbers}")
        placed = " ".join(repr(float(each)) for each in [*quaternion(pose), *pose.translation])
        images += [f"{number} {placed} {number} {name}", "" if number == len(cameras) else "1.5 2.5 -1"]
    (folder / "cameras.txt").write_text("\n".join(lenses) + "\n")
    (folder / "images.txt").write_text("\n".join(images) + "\n")


def nerf(path: Path, cameras: Mapping[str, tuple[Lens, Pose]], own: bool = True) -> None:
    """transforms.json: camera to world, axes right, up, backwards; a lens in each frame, or that of the first once."""
    frames = []
    whole: dict[str, object] = {}
    for name, (lens, pose) in cameras.items():
        world = np.eye(4)
        right, down, forwards = pose.rotation
        world[:3, 0], world[:3, 1], world[:3, 2], world[:3, 3] = right, -down, -forwards, pose.eye
        names = ("fl_x", "fl_y", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")
        said = dict(zip(names, parameters(lens), strict=True)) | {"w": lens.width, "h": lens.height}
        frames.append({"file_path": name, "transform_matrix": world.tolist()} | (said if own else {}))
        whole = whole or ({} if own else said)
    path.write_text(json.dumps(whole | {"frames": frames}))


def opencv(path: Path, lens: Lens) -> None:
    """What cv2.FileStorage writes of a calibration."""
    import cv2

    fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, k5, k6 = parameters(lens)
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    storage.write("image_width", lens.width)
    storage.write("image_height", lens.height)
    storage.write("camera_matrix", np.array([[fx, 0, cx - 0.5], [0, fy, cy - 0.5], [0, 0, 1.0]]))
    storage.write("distortion_coefficients", np.array([[k1, k2, p1, p2, k3, k4, k5, k6]]))
    storage.release()
