"""A projector found as a camera that works the other way, what it is written as, and the light that it becomes."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

import board_photographs
import board_session
from projected_boards import SIZE, STRIPE, ProjectorScene
from quadgraph import core
from quadgraph.acquisition.board import corners
from quadgraph.acquisition.cameras.lens import Lens, Pose, project
from quadgraph.acquisition.lighting import projected_picture, projector, projector_file, stripes
from quadgraph.base import image_file
from quadgraph.base.errors import InputError
from quadgraph.cli import main

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
pytest.importorskip("cv2", reason="OpenCV is not installed: pip install 'quadgraph[capture]'")

NOISE = board_session.NOISE
OPTIONS = ["--size", f"{SIZE[0]}x{SIZE[1]}", "--stripe", str(STRIPE)]


def turned(found: Pose, true: Pose) -> float:
    """Degrees between two poses."""
    cosine = (np.trace(found.rotation @ true.rotation.T) - 1) / 2
    return float(np.degrees(np.arccos(np.clip(cosine, -1, 1))))


@pytest.fixture(scope="module")
def scene() -> ProjectorScene:
    return ProjectorScene(1)


@pytest.fixture(scope="module")
def folder(tmp_path_factory, scene) -> Path:
    """Folders a, b and c of photographs of all patterns, the board in three places, and what was found."""
    folder = tmp_path_factory.mktemp("projector")
    for number, name in enumerate("abc"):
        (folder / name).mkdir()
        for step, grey in enumerate(scene.frames(number, NOISE, 1)):
            picture = np.round(np.clip(grey[..., 0], 0, 1) * 65535).astype(np.uint16)
            board_photographs.write_png(folder / name / f"{step:02d}.png", picture)
    places = [str(folder / name) for name in "abc"]
    assert main(["capture", "projector", *places, "-o", str(folder / "projector.yml"), *OPTIONS]) == 0
    return folder


@pytest.mark.parametrize(("size", "stripe"), [((640, 360), 4), ((100, 70), 3), ((128, 64), 1)])
def test_stripes_say_which_pixel_it_is(size, stripe):
    patterns = list(stripes.patterns(size, stripe))
    assert len(patterns) == stripes.count(size, stripe)
    told = stripes.decode((each.astype(np.float32) for each in patterns), size, stripe)
    x, y = np.meshgrid(np.arange(size[0]) + 0.5, np.arange(size[1]) + 0.5)
    assert np.abs(told - np.stack([x, y], axis=-1)).max() <= (stripe - 1) / 2


def test_opencv_reads_the_stripes_alike():
    import cv2

    pattern = cv2.structured_light.GrayCodePattern.create(*stripes.cells(SIZE, STRIPE))
    shown = list(stripes.patterns(SIZE, STRIPE))[2:]
    told = stripes.decode((each.astype(np.float32) for each in stripes.patterns(SIZE, STRIPE)), SIZE, STRIPE)
    for x, y in [(3, 5), (320, 240), (639, 479), (101, 402)]:
        wrong, cell = pattern.getProjPixel(shown, x, y)
        assert not wrong
        np.testing.assert_allclose(told[y, x], (np.array(cell) + 0.5) * STRIPE)


def test_lens_and_place_are_found(folder, scene):
    lens, pose = projector_file.read(folder / "projector.yml")
    assert np.linalg.norm(pose.eye - scene.pose.eye) < 4.0
    assert turned(pose, scene.pose) < 0.5
    places = np.random.default_rng(0).uniform([20, 20, 0], [150, 200, 60], (200, 3))  # where a body would stand
    off = np.linalg.norm(project(lens, pose, places) - project(scene.lens, scene.pose, places), axis=1)
    assert off.max() < 1.0


@pytest.mark.long
def test_numbers_of_projectors(capsys):
    rows = []
    for seed in range(20):
        scene = ProjectorScene(seed)
        lit = {}
        for number in range(len(scene.moves)):
            frames = [frame[..., 0].astype(np.float32) for frame in scene.frames(number, NOISE, 1)]
            seen = corners.find(scene.board, frames[0] - frames[1])
            told = stripes.decode(iter(frames), SIZE, STRIPE)
            lit[str(number)] = projector.lit_corners("board", seen, told, STRIPE)
        found = projector.calibrate(scene.board, lit, SIZE)
        pose = found.places["0"].pose
        places = np.random.default_rng(0).uniform([20, 20, 0], [150, 200, 60], (200, 3))
        off = project(found.lens, pose, places) - project(scene.lens, scene.pose, places)
        mm = float(np.linalg.norm(pose.eye - scene.pose.eye))
        rows.append([found.rms, mm, turned(pose, scene.pose), float(np.linalg.norm(off, axis=1).max())])
    middle, most = np.median(rows, axis=0), np.quantile(rows, 0.9, axis=0)
    with capsys.disabled():
        print("\npixels RMS, mm, degrees, pixels over the board:", middle.round(3), most.round(3))
    assert (most < [0.5, 5.0, 0.6, 1.5]).all()


def test_board_places_that_are_alike_or_too_few_are_named():
    lens, board = Lens(*SIZE, 800.0, 800.0, 320.0, 300.0), ProjectorScene(1).board
    numbers = np.arange(len(board.corners()))

    def lit(eye: list[float]) -> corners.Corners:
        pose = board_photographs.pose_from(eye, [87, 112, 0])
        return corners.Corners(numbers, project(lens, pose, board.corners()))

    same = {name: lit([87.0, -200.0 - 9 * step, 400.0 + 19 * step]) for step, name in enumerate("abc")}
    with pytest.raises(InputError, match=r"tilted alike before the projector, .* prop the board up"):
        projector.calibrate(board, same, SIZE)
    with pytest.raises(InputError, match="found 2 places of the board, allowed are 3 or more"):
        projector.calibrate(board, {"a": same["a"], "b": same["b"]}, SIZE)


def test_what_cannot_tell_a_projector_is_named(folder, tmp_path, capsys):
    def said(*places: Path, more: tuple[str, ...] = ()) -> str:
        command = ["capture", "projector", *map(str, places), "-o", str(tmp_path / "p.yml"), *OPTIONS, *more]
        assert main(command) == 1
        assert not (tmp_path / "p.yml").exists()
        return capsys.readouterr().err

    a, b, c = (folder / name for name in "abc")
    assert "found 2 different folders, allowed are 3 or more" in said(a, b)
    assert "found 2 different folders" in said(a, b, a)
    assert f"{tmp_path / 'none'}: found no folder of this name" in said(a, b, tmp_path / "none")
    (tmp_path / "few").mkdir()
    shutil.copy(a / "00.png", tmp_path / "few")
    assert "few: found 1 photographs" in said(a, b, tmp_path / "few")
    shutil.copytree(c, tmp_path / "unlit")
    for step in range(2, stripes.count(SIZE, STRIPE)):  # the projector stood still
        shutil.copy(c / "02.png", tmp_path / "unlit" / f"{step:02d}.png")
    assert "unlit: the projector's stripes tell 0 of" in said(tmp_path / "unlit", b, a)
    shutil.copytree(c, tmp_path / "bare")
    shutil.copy(c / "01.png", tmp_path / "bare" / "00.png")
    assert "00.png: found 0 corners of the board" in said(tmp_path / "bare", b, a)
    assert "--stripe: found 0, allowed are 1 to 64" in said(a, b, c, more=("--stripe", "0"))


def test_patterns_are_written_as_they_are_decoded(tmp_path, capsys):
    assert main(["capture", "patterns", "-o", str(tmp_path / "shown"), "--size", "128x72"]) == 0
    count = stripes.count((128, 72), 4)
    names = sorted(path.name for path in (tmp_path / "shown").iterdir())
    assert len(names) == count
    read = (np.asarray(core.read_image(tmp_path / "shown" / name))[..., 0] for name in names)
    assert np.isfinite(stripes.decode(read, (128, 72), 4)).all()
    assert main(["capture", "patterns", "-o", str(tmp_path / "shown"), "--size", "128x72"]) == 1
    assert "is there already" in capsys.readouterr().err


def test_the_picture_shows_each_place_what_the_projector_does(scene):
    """Through the engine's projector (docs/lights.md) a place gets what the real one, shifted and distorted, sends."""
    x, y = np.meshgrid(np.arange(SIZE[0]) + 0.5, np.arange(SIZE[1]) + 0.5)
    shown = np.stack([x / SIZE[0], y / SIZE[1], np.ones_like(x)], axis=-1).astype(np.float32)
    picture, light = projected_picture.light(scene.lens, scene.pose, shown, (2.0, 2.0, 2.0))
    places = np.random.default_rng(0).uniform([40, 40, 0], [130, 180, 30], (300, 3))
    away = places - np.array(light["position"])
    axis, up = np.array(light["direction"]), np.array(light["up"])
    right = np.cross(axis, up)
    high = np.tan(np.radians(light["angle"] / 2))
    slopes = np.stack([away @ right, away @ up], axis=1) / (away @ axis)[:, None]
    height, width, _ = picture.shape
    column = np.floor((0.5 + 0.5 * slopes[:, 0] / (high * width / height)) * width).astype(int)
    row = np.floor((0.5 - 0.5 * slopes[:, 1] / high) * height).astype(int)
    true = project(scene.lens, scene.pose, places)
    np.testing.assert_allclose(picture[row, column, :2] * SIZE, true, atol=1.5)
    # The light within the frame is what was stated: irradiance on a plane at 1 mm is power over the picture's area.
    area = 4 * high**2 * width / height
    assert light["power"][0] * picture[..., 2].mean() == pytest.approx(2.0, rel=0.03)
    assert light["power"][0] / area == pytest.approx(2.0 / (SIZE[0] * SIZE[1] / (scene.lens.fx * scene.lens.fy)))


def test_a_session_takes_the_projector(folder, tmp_path, capsys):
    board_session.write(tmp_path, board_session.cameras()[:8:2], exposures=[1.0])
    shutil.copy(folder / "projector.yml", tmp_path)
    picture = np.zeros((SIZE[1], SIZE[0], 3), np.uint8)
    picture[:, ::2] = 255
    image_file.write(tmp_path / "shown.png", picture)
    document = json.loads((tmp_path / "session.json").read_text())
    light = {"type": "projector", "calibrated": "projector.yml", "shown": "shown.png", "power": [3, 2, 1]}
    document["lights"]["lamp"] = light
    (tmp_path / "session.json").write_text(json.dumps(document | board_session.KNOWN_NOISE))
    assert main(["capture", "import", str(tmp_path), "-o", str(tmp_path / "capture.json")]) == 0
    found = json.loads((tmp_path / "capture.json").read_text())["lights"]["lamp"]
    assert found["file"] == "capture-projector-1.exr"
    _, pose = projector_file.read(folder / "projector.yml")
    np.testing.assert_allclose(found["position"], pose.eye)
    assert found["power"][0] == pytest.approx(3 * found["power"][2])
    assert np.asarray(core.read_image(tmp_path / "capture-projector-1.exr")).max() <= 1.001
    image_file.write(tmp_path / "shown.png", picture[:90])
    assert main(["capture", "import", str(tmp_path), "-o", str(tmp_path / "again.json")]) == 1
    assert "lights.lamp.shown: shown.png has 640 x 90 pixels, allowed are the projector's, 640 x 480" in (
        capsys.readouterr().err
    )
    (tmp_path / "projector.yml").write_text((folder / "projector.yml").read_text().replace("translation", "moved"))
    assert main(["capture", "import", str(tmp_path), "-o", str(tmp_path / "again.json")]) == 1
    assert "projector.yml: translation: found 0 numbers, allowed are 3" in capsys.readouterr().err


def test_a_disc_about_the_axis_is_a_spot():
    lens, pose = Lens(640, 480, 800.0, 800.0, 320.0, 400.0), board_photographs.pose_from([0, -300, 400], [0, 0, 0])
    light, radius = projected_picture.spot(lens, pose)
    assert radius == 80
    assert light["angle"] == pytest.approx(np.degrees(np.arctan(0.1)), abs=0.01)
    np.testing.assert_allclose(light["direction"], [0, 0.6, -0.8], atol=1e-4)
    assert projected_picture.spot(Lens(640, 480, 800.0, 800.0, 320.0, 500.0), pose) == ({}, 0.0)
