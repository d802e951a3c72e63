"""Cameras of a transforms.json, as NeRF's data sets, instant-ngp and nerfstudio have it.

A matrix takes places along the camera's axes right, up, backwards (OpenGL's) to the world; the middle of the first
pixel is at (0.5, 0.5).
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from quadgraph.acquisition.cameras import foreign
from quadgraph.acquisition.cameras.foreign import ForeignCameras, checked_lens, checked_pose, content
from quadgraph.acquisition.cameras.lens import Lens
from quadgraph.acquisition.capture.strict_json import Member
from quadgraph.base import json_text
from quadgraph.base.errors import InputError

_LARGEST = 1e9
_DISTORTION = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")
_FLIP = np.diag([1.0, -1.0, -1.0])  # from right, up, backwards to right, down, forwards
_FISHEYE = ("OPENCV_FISHEYE", "EQUIRECTANGULAR")


def read(path: Path) -> ForeignCameras:
    """Read a transforms.json. Raises InputError naming the path into it, what was found and what is allowed."""
    try:
        document = json_text.loads(content(path))
    except InputError as error:
        raise InputError(f"{path}: {error}" if str(path) not in str(error) else str(error)) from None
    if not isinstance(document, dict) or "frames" not in document:
        raise InputError(f"{path}: frames: is missing, it has to be there: a list with a transform_matrix each")
    lenses, poses = {}, {}
    for frame in Member(str(path), "frames", document["frames"]).items(foreign.MOST_IMAGES):
        if not isinstance(frame.value, dict):
            frame.wrong("allowed is an object")
        for name in ("file_path", "transform_matrix"):
            if name not in frame.value:
                raise InputError(f"{path}: {frame.path}.{name}: is missing, it has to be there")
        name = _child(frame, "file_path").text("the photograph")
        lenses[name] = _lens(str(path), frame.path, document | frame.value)
        world = _matrix(_child(frame, "transform_matrix"))
        rotation = _FLIP @ world[:3, :3].T
        poses[name] = checked_pose(f"{path}: {frame.path}.transform_matrix", rotation, -rotation @ world[:3, 3])
    return ForeignCameras(path, lenses, poses)


def _child(member: Member, name: str) -> Member:
    return Member(member.file, f"{member.path}.{name}" if member.path else name, member.value[name])


def _lens(file: str, path: str, said: dict) -> Lens:
    """The lens of a frame, whose members count before those of the whole file."""
    model = said.get("camera_model", "OPENCV")
    if model in _FISHEYE or said.get("is_fisheye"):
        raise InputError(f"{file}: {path}: camera_model {model} found, allowed are OPENCV and PINHOLE; undistort first")
    owner = Member(file, path, said)

    def number(name: str) -> float | None:
        return _child(owner, name).number(-_LARGEST, _LARGEST, "pixels") if said.get(name) is not None else None

    width, height = number("w"), number("h")
    if width is None or height is None:
        raise InputError(f"{file}: w and h: are missing, add the size of the photographs, pixels")
    across = number("fl_x")
    if across is None:
        angle = number("camera_angle_x")
        if angle is None or not 0 < angle < math.pi:
            raise InputError(f"{file}: fl_x: is missing, and no camera_angle_x between 0 and pi; one has to be there")
        across = width / 2 / math.tan(angle / 2)
    downward = number("fl_y") or across
    cx, cy = number("cx"), number("cy")
    middle = [width / 2 if cx is None else cx, height / 2 if cy is None else cy]
    distortion = [number(name) or 0.0 for name in _DISTORTION]
    return checked_lens(f"{file}: {path}", (width, height), [across, downward, *middle, *distortion])


def _matrix(member: Member) -> np.ndarray:
    """(4, 4) or (3, 4) as a list of rows."""
    rows = [row.items(4) for row in member.items(4)]
    if len(rows) < 3 or any(len(row) != 4 for row in rows):
        member.wrong("allowed is a matrix of 4 x 4, or 3 x 4")
    return np.array([[each.number(-_LARGEST, _LARGEST, "matrix") for each in row] for row in rows])
