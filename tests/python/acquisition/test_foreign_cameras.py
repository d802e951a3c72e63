"""Cameras of COLMAP, NeRF and OpenCV come back as they were, and files that lie about their sizes are refused."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np
import pytest

import board_photographs
import foreign_files
from quadgraph.acquisition.cameras import colmap, nerf_transforms, opencv_yaml
from quadgraph.acquisition.cameras.foreign import ForeignCameras
from quadgraph.acquisition.cameras.lens import Lens
from quadgraph.acquisition.session.locating import read_cameras
from quadgraph.base.errors import InputError

PLAIN = Lens(960, 720, 1012.0, 1008.0, 487.0, 353.0, (-0.12, 0.05, 0.0, 0.0, 0.0, 0.0), (0.0011, -0.0008))
RATIONAL = Lens(640, 480, 601.5, 598.25, 322.0, 236.5, (0.3, -0.1, 0.02, 0.4, -0.05, 0.01), (0.0011, -0.0008))


def known() -> dict:
    """Cameras by the names of their photographs, one with a blank."""
    poses = board_photographs.around([80, 90, 10], 300.0, 4, 40)
    names = ("a.png", "b 2.png", "sub/c.png", "d.png")
    return {name: (RATIONAL if n % 2 else PLAIN, pose) for n, (name, pose) in enumerate(zip(names, poses, strict=True))}


def check(found: ForeignCameras, cameras: dict) -> None:
    """Lenses and poses agree to 1e-6."""
    assert list(found.poses) == list(cameras)
    for name, (lens, pose) in cameras.items():
        np.testing.assert_allclose(found.poses[name].rotation, pose.rotation, atol=1e-6)
        np.testing.assert_allclose(found.poses[name].eye, pose.eye, atol=1e-6)
        np.testing.assert_allclose(
            foreign_files.parameters(found.lenses[name]), foreign_files.parameters(lens), atol=1e-6
        )
        assert (found.lenses[name].width, found.lenses[name].height) == (lens.width, lens.height)


@pytest.mark.parametrize("kind", ["binary", "text"])
def test_colmap_comes_back(tmp_path, kind):
    {"binary": foreign_files.colmap_binary, "text": foreign_files.colmap_text}[kind](tmp_path, known())
    check(read_cameras(tmp_path), known())


def test_a_model_of_fewer_parameters_leaves_the_others_zero(tmp_path):
    plain = {name: (PLAIN, pose) for name, (_, pose) in known().items()}
    foreign_files.colmap_binary(tmp_path, plain, foreign_files.OPENCV)
    check(colmap.read(tmp_path), plain)
    foreign_files.colmap_text(tmp_path, plain)
    (tmp_path / "cameras.bin").unlink()
    (tmp_path / "cameras.txt").write_text(
        "".join(f"{n} SIMPLE_RADIAL 960 720 1000 480 360 -0.1\n" for n in (1, 2, 3, 4))
    )
    assert colmap.read(tmp_path).lenses["a.png"] == Lens(960, 720, 1000, 1000, 480, 360, (-0.1, 0, 0, 0, 0, 0))


@pytest.mark.parametrize("own", [True, False])
def test_nerf_comes_back(tmp_path, own):
    cameras = known() if own else {name: (PLAIN, pose) for name, (_, pose) in known().items()}
    foreign_files.nerf(tmp_path / "transforms.json", cameras, own)
    check(read_cameras(tmp_path), cameras)


def test_an_angle_stands_for_a_focal_length(tmp_path):
    path = tmp_path / "transforms.json"
    frame = {"file_path": "./train/r_0", "transform_matrix": np.eye(4).tolist()}
    path.write_text(json.dumps({"camera_angle_x": 2 * np.arctan(0.5), "w": 800, "h": 600, "frames": [frame]}))
    found = read_cameras(path)
    lens = found.lenses["./train/r_0"]
    np.testing.assert_allclose([lens.fx, lens.fy, lens.cx, lens.cy], [800, 800, 400, 300], rtol=1e-12)
    # OpenGL's camera without a turn looks along -z, with y up: down is -y.
    np.testing.assert_allclose(found.poses["./train/r_0"].rotation, np.diag([1, -1, -1]), atol=1e-12)


@pytest.mark.parametrize("lens", [PLAIN, RATIONAL])
def test_opencv_comes_back(tmp_path, lens):
    pytest.importorskip("cv2", reason="OpenCV is not installed: pip install 'quadgraph[capture]'")
    foreign_files.opencv(tmp_path / "lens.yml", lens)
    found = read_cameras(tmp_path / "lens.yml").lens
    assert found is not None
    np.testing.assert_allclose(foreign_files.parameters(found), foreign_files.parameters(lens), atol=1e-6)
    assert not read_cameras(tmp_path / "lens.yml").poses


def spoil(folder: Path, name: str, at: int, form: str, value: float) -> None:
    """Write a value into a file, somewhere."""
    data = bytearray((folder / name).read_bytes())
    struct.pack_into(f"<{form}", data, at, value)
    (folder / name).write_bytes(bytes(data))


SPOILT = [
    ("cameras.bin", 0, "Q", 1 << 60, r"number of cameras: 1152921504606846976 found, allowed are 100000, and the file"),
    ("cameras.bin", 12, "i", 5, r"camera 0 of the file: model 5 found, allowed are SIMPLE_PINHOLE, .*OPENCV"),
    ("cameras.bin", 16, "Q", 1 << 50, r"camera 0 of the file: size 1\.1259e\+15 x 720 found, allowed are 1 to 65535"),
    ("cameras.bin", 32, "d", float("nan"), r"a number that is not finite"),
    ("cameras.bin", 32, "d", -5.0, r"focal lengths -5, 1008 found, allowed are numbers above 0"),
    ("images.bin", 0, "Q", 1 << 40, r"number of images: 1099511627776 found"),
    ("images.bin", 12, "d", 900.0, r"image 0 of the file: rotation of length 900"),
    ("images.bin", 68, "I", 77, r"camera 77 found, .*cameras\.bin has no such camera"),
    ("images.bin", 78, "Q", 1 << 60, r"image 0 of the file, points: 27670116110564327424 bytes are stated at byte 86"),
]


@pytest.mark.parametrize(("name", "at", "form", "value", "said"), SPOILT)
def test_binary_files_that_lie_are_refused(tmp_path, name, at, form, value, said):
    foreign_files.colmap_binary(tmp_path, known())
    spoil(tmp_path, name, at, form, value)
    with pytest.raises(InputError, match=said) as caught:
        colmap.read(tmp_path)
    assert name in str(caught.value)


@pytest.mark.parametrize("name", ["cameras.bin", "images.bin"])
def test_every_end_before_the_end_is_refused(tmp_path, name):
    foreign_files.colmap_binary(tmp_path, known())
    data = (tmp_path / name).read_bytes()
    for size in [*range(0, len(data), 7), len(data) - 1]:
        (tmp_path / name).write_bytes(data[:size])
        with pytest.raises(InputError, match=name):
            colmap.read(tmp_path)
    (tmp_path / name).write_bytes(data + b"x")
    with pytest.raises(InputError, match="1 bytes found behind the last record"):
        colmap.read(tmp_path)


WRONG_TEXT = [
    ("cameras.txt", "1 THIN_PRISM_FISHEYE 9 9 1", r"cameras\.txt: line 1: model THIN_PRISM_FISHEYE found"),
    ("cameras.txt", "1 PINHOLE 9 9 1 2 3", r"line 1: 7 words found, allowed are 8"),
    ("cameras.txt", "1 PINHOLE 9 9 1 2 3 x", r"line 1: .*'x', allowed are numbers"),
    ("images.txt", "1 1 0 0 0 0 0 0 1", r"images\.txt: line 1: 9 words found, allowed are 10"),
    ("images.txt", "# nothing", r"images\.txt: found no image with a pose"),
]


@pytest.mark.parametrize(("name", "text", "said"), WRONG_TEXT)
def test_text_that_is_wrong_is_named_by_its_line(tmp_path, name, text, said):
    foreign_files.colmap_text(tmp_path, known())
    (tmp_path / name).write_text(text + "\n")
    with pytest.raises(InputError, match=said):
        colmap.read(tmp_path)


FRAME = {"file_path": "a", "transform_matrix": np.eye(4).tolist()}
WHOLE = {"w": 8, "h": 8, "fl_x": 9.0}
MIRRORED = np.diag([1.0, 1, -1, 1]).tolist()
WRONG_NERF = [
    ({}, "frames: is missing"),
    (WHOLE | {"frames": []}, r"frames: found 0 items, allowed is a list of 1 to 100000"),
    (WHOLE | {"frames": [{"file_path": "a"}]}, r"frames\[0\]\.transform_matrix: is missing"),
    (
        WHOLE | {"frames": [FRAME | {"transform_matrix": [[1, 2], [3, 4]]}]},
        r"frames\[0\]\.transform_matrix: found .*4 x 4",
    ),
    (WHOLE | {"frames": [FRAME | {"transform_matrix": MIRRORED}]}, r"found no right-handed rotation"),
    ({"frames": [FRAME], "fl_x": 9.0}, r"w and h: are missing"),
    ({"frames": [FRAME], "w": 8, "h": 8}, r"fl_x: is missing, and no camera_angle_x"),
    (WHOLE | {"camera_model": "OPENCV_FISHEYE", "frames": [FRAME]}, r"camera_model OPENCV_FISHEYE found"),
    (WHOLE | {"w": 8.5, "frames": [FRAME]}, r"size 8\.5 x 8 found"),
]


@pytest.mark.parametrize(("document", "said"), WRONG_NERF)
def test_transforms_that_are_wrong_are_named_by_their_path(tmp_path, document, said):
    (tmp_path / "transforms.json").write_text(json.dumps(document))
    with pytest.raises(InputError, match=said):
        nerf_transforms.read(tmp_path / "transforms.json")


MATRIX = "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
MATRIX += "   data: [ 9., 0., 4., 0., 9., 4., 0., 0., 1. ]\n"
SIZE = "image_width: 8\nimage_height: 8\n"
WRONG_YAML = [
    ("", "camera_matrix: found 0 numbers, allowed are 9"),
    (MATRIX.replace("rows: 3", "rows: 99999999"), r"camera_matrix: found 9 numbers, 99999999 rows of 3 are stated"),
    (MATRIX.replace("9., 0., 4.", "9., 1., 4.") + SIZE, "skew of 1 found"),
    (MATRIX, "image_width: is missing"),
    (
        MATRIX + SIZE + MATRIX.replace("camera_matrix", "distortion_coefficients"),
        "found 9 numbers, allowed are 4, 5 or 8",
    ),
]


@pytest.mark.parametrize(("text", "said"), WRONG_YAML)
def test_yaml_that_is_wrong_is_named_by_its_field(tmp_path, text, said):
    (tmp_path / "lens.yml").write_text(text)
    with pytest.raises(InputError, match=said):
        opencv_yaml.read(tmp_path / "lens.yml")


def test_other_files_are_refused(tmp_path):
    (tmp_path / "a.xml").write_text("<a/>")
    (tmp_path / "a.txt").write_text("")
    with pytest.raises(InputError, match="XML found, allowed is YAML"):
        read_cameras(tmp_path / "a.xml")
    with pytest.raises(InputError, match=r"found \.txt, allowed are"):
        read_cameras(tmp_path / "a.txt")
    with pytest.raises(InputError, match="found no cameras"):
        read_cameras(tmp_path)
