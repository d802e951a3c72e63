"""From photographs on a board to a capture: lens, poses and radiance as they were, whichever program tells them."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import board_photographs
import board_session
import foreign_files
from dng_file import BLACK, WHITE, write_dng
from quadgraph import core
from quadgraph.acquisition.board.board import Board
from quadgraph.acquisition.cameras.lens import PinholeView, Pose, view_towards
from quadgraph.acquisition.capture import capture, photographs
from quadgraph.acquisition.capture.radiance import Radiance
from quadgraph.acquisition.session import exposures, locating, resampling, session_file
from quadgraph.cli import main

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
pytest.importorskip("cv2", reason="OpenCV is not installed: pip install 'quadgraph[capture]'")

LENS, POSES = board_photographs.LENS, board_session.cameras()[::2]
# Of poses about 330 mm away, by a lens that is stated and one that is found from these six (of twelve:
# test_calibration.py), and of the board's corners.
DEGREES, MM, PIXELS = 0.05, {"stated": 0.1, "found": 0.3}, 0.05


@pytest.fixture(scope="module")
def session(tmp_path_factory) -> Path:
    """The folder of six photographs of a ball on the board, two exposures each, and of their capture."""
    folder = tmp_path_factory.mktemp("session")
    board_session.write(folder, POSES)
    assert main(["capture", "import", str(folder), "-o", str(folder / "capture.json")]) == 0
    return folder


def record(folder: Path, name: str = "capture") -> dict[str, Any]:
    """What the import says of a capture."""
    return json.loads((folder / f"{name}-import.json").read_text())


def errors(found: Pose, pose: Pose) -> tuple[float, float]:
    """Degrees and mm."""
    turn = found.rotation @ pose.rotation.T
    degrees = np.degrees(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1)))
    return float(degrees), float(np.linalg.norm(found.eye - pose.eye))


@pytest.fixture(scope="module")
def contents(session) -> dict[str, exposures.ShotContent]:
    """What the photographs show."""
    stated = session_file.read(session)
    read = exposures.Exposures(stated)
    return {shot.path: read.content(shot) for shot in stated.shots}


def located(session: session_file.Session, contents: dict[str, exposures.ShotContent]) -> list[Any]:
    """The cameras of a session, in the order of its photographs."""
    sizes = {path: each.size for path, each in contents.items()}
    cameras = locating.locate(session, sizes, {path: each.corners for path, each in contents.items()})
    return [cameras[shot.path] for shot in session.shots]


@pytest.mark.parametrize("lens", ["found", "stated"])
def test_lens_and_poses_come_from_the_board(session, contents, lens):
    more = {}
    if lens == "stated":
        foreign_files.opencv(session / "lens.yml", LENS)
        more = {"cameras": "lens.yml"}
    document = json.loads((session / "session.json").read_text()) | more
    (session / f"{lens}.json").write_text(json.dumps(document))
    cameras = located(session_file.read(session / f"{lens}.json"), contents)
    for camera, pose in zip(cameras, POSES, strict=True):
        degrees, mm = errors(camera.pose, pose)
        assert degrees < DEGREES
        assert mm < MM[lens]
        assert camera.board.rms < PIXELS
        assert len(camera.board.corners.numbers) > 25
    found = cameras[0].lens
    np.testing.assert_allclose([found.fx, found.fy, found.cx, found.cy], [LENS.fx, LENS.fy, LENS.cx, LENS.cy], atol=1)
    # The distortion as it moves places, for its terms stand in for each other.
    edge = np.random.default_rng(0).uniform([-0.35, -0.25], [0.35, 0.25], (100, 2))
    assert np.abs(found.places(edge) - LENS.places(edge)).max() < 1.0


def kinds(folder: Path) -> dict[str, dict[str, Any]]:
    """The cameras by other programs, in worlds that are twice as small, turned and moved."""
    placed = {f"{number}-1.png": (LENS, pose) for number, pose in enumerate(POSES)}
    turn = board_photographs.pose_from([1, 2, 3], [0, 0, 0], 40).rotation
    elsewhere = {name: (lens, pose.moved(0.5, turn, np.array([3.0, 4, 5]))) for name, (lens, pose) in placed.items()}
    foreign_files.colmap_binary(folder, elsewhere)
    foreign_files.nerf(folder / "transforms.json", placed)
    return {
        "aligned": {"cameras": "."},
        "world": {"cameras": "transforms.json", "world": {"scale": 1.0}},
    }


@pytest.mark.parametrize("kind", ["aligned", "world"])
def test_cameras_of_other_programs_are_laid_on_the_board(session, contents, kind):
    document = json.loads((session / "session.json").read_text()) | kinds(session)[kind]
    if kind == "world":
        del document["board"]
    (session / f"{kind}.json").write_text(json.dumps(document))
    found = located(session_file.read(session / f"{kind}.json"), contents)
    for camera, pose in zip(found, POSES, strict=True):
        degrees, mm = errors(camera.pose, pose)
        assert degrees < (1e-4 if kind == "world" else DEGREES)
        assert mm < (1e-6 if kind == "world" else MM["stated"])
        assert (camera.board is None) == (kind == "world")


def test_the_noise_is_found_and_the_exposures_are_as_stated(session):
    said = record(session)
    noise = said["noise"]
    assert noise["read_out"] == pytest.approx(board_session.NOISE[0], rel=0.1)
    assert noise["shot"] == pytest.approx(board_session.NOISE[1], rel=0.05)
    for each in said["photographs"]:
        np.testing.assert_allclose(each["exposure_ratios"], 1, atol=0.005)
        assert each["moved"] < 0.1


def test_the_capture_shows_the_body_as_its_cameras_would(session):
    """Of every picture: the true radiance along each ray of the capture's camera, within the stated variances."""
    stated = capture.read(session / "capture.json")
    ball = board_photographs.ball(board_session.MIDDLE, board_session.RADIUS)
    squares = []
    for measured in photographs.read_all(stated):
        camera = stated.cameras[measured.stated.camera]
        view = PinholeView(np.array(camera["eye"]), np.array(camera["look_at"]), camera["fov"], camera["up"], 128, 128)
        middles = np.stack(np.meshgrid(np.arange(128) + 0.5, np.arange(128) + 0.5), axis=-1).reshape(-1, 2)
        slopes = view.lens.slopes(middles)
        ways = np.concatenate([slopes, np.ones((len(slopes), 1))], axis=1) @ view.axes()
        ways /= np.linalg.norm(ways, axis=1, keepdims=True)
        met, radiance = ball(np.broadcast_to(view.eye, ways.shape), ways)
        inside = met.reshape(128, 128)
        for step in (-3, 3):  # pixels from the outline are part of the board
            inside = inside & np.roll(met.reshape(128, 128), step, 0) & np.roll(met.reshape(128, 128), step, 1)
        fine = inside[..., None] & measured.usable
        assert fine.sum() > 10_000
        off = (measured.values - radiance.reshape(128, 128, 3)) / np.sqrt(measured.variances)
        squares.append((off[fine] ** 2).mean())
        assert np.median(measured.values[fine] / radiance.reshape(128, 128, 3)[fine]) == pytest.approx(1, abs=2e-3)
        assert not measured.usable[:4].any()  # nothing far beside the body counts
    assert 0.9 < np.mean(squares) < 1.1


def test_the_same_session_makes_the_same_capture(session, tmp_path):
    shutil.copytree(session, tmp_path / "again")
    again = tmp_path / "again" / "capture.json"
    before = {path.name: path.read_bytes() for path in (tmp_path / "again").glob("capture*")}
    for name in before:
        (tmp_path / "again" / name).unlink()
    assert main(["capture", "import", str(tmp_path / "again" / "session.json"), "-o", str(again)]) == 0
    assert {path.name: path.read_bytes() for path in (tmp_path / "again").glob("capture*")} == before


def test_a_view_beyond_the_photograph_s_edge_is_left_out_there():
    pose = board_photographs.pose_from([250, 20, 260], board_session.MIDDLE, 12)
    whole = np.ones((LENS.height, LENS.width, 3), np.float32)
    flat = Radiance(whole, whole, np.ones(whole.shape, bool))
    for aside, least, most in ((0.0, 1.0, 1.0), (105.0, 0.05, 0.95), (900.0, 0.0, 0.0)):
        view = view_towards(pose.eye, board_session.MIDDLE + aside * np.array([1.0, 1, 0]), 30.0, 40)
        shown = resampling.resampled(flat, None, LENS, pose, view)
        assert least <= shown.usable.mean() <= most
        np.testing.assert_allclose(shown.values[shown.usable], 1, rtol=1e-5)  # weights are shares
        assert (shown.values[~shown.usable] == 0).all()


def test_variances_of_the_resampled_are_those_of_its_noise():
    """Noise alone, of which each resampled pixel has the variance that it states."""
    generator = np.random.default_rng(5)
    pose = board_photographs.pose_from([250, 20, 260], board_session.MIDDLE, 12)
    view = view_towards(pose.eye, board_session.MIDDLE, 30.0, 60)
    variances = np.full((LENS.height, LENS.width, 3), 4e-4, np.float32)
    squares = []
    for _ in range(6):
        values = generator.normal(size=variances.shape).astype(np.float32) * 0.02
        shown = resampling.resampled(Radiance(values, variances, np.ones(values.shape, bool)), None, LENS, pose, view)
        assert shown.usable.all()
        squares.append((shown.values**2 / shown.variances).mean())
    # 6 x 60 x 60 x 3 values, of neighbours that share pixels, so that fewer are independent: a quarter.
    assert np.mean(squares) == pytest.approx(1, abs=4.5 * np.sqrt(2 / (6 * 60 * 60 * 3 / 4)))


def spoilt(folder: Path, tmp_path: Path, change: Any) -> tuple[int, Path]:
    """Import a session with a change; exit code, and where it lies."""
    copied = tmp_path / "spoilt"
    shutil.copytree(folder, copied, ignore=shutil.ignore_patterns("capture*", "*.bin"))
    document = json.loads((copied / "session.json").read_text())
    document["photographs"] = document["photographs"][:4]
    change(document, copied)
    (copied / "session.json").write_text(json.dumps(document))
    return main(["capture", "import", str(copied), "-o", str(copied / "capture.json")]), copied


def no_board(document: dict[str, Any], folder: Path) -> None:
    dark = np.zeros((LENS.height, LENS.width, 3), np.uint16) + 900
    board_photographs.write_png(folder / "2-1.png", dark)
    document["photographs"] = [document["photographs"][2] | {"frames": [{"file": "2-1.png", "exposure": 1}]}]
    document["noise"] = {"read_out": 0.001, "shot": 1e-4}


def another_board(document: dict[str, Any], folder: Path) -> None:
    document["board"] = {"dictionary": "6x6_250"}
    document["photographs"] = document["photographs"][:1]


def few(document: dict[str, Any], folder: Path) -> None:
    document["photographs"] = document["photographs"][:3]


def no_exposure(document: dict[str, Any], folder: Path) -> None:
    document["photographs"][1]["frames"][0] = "1-0.png"


def another_size(document: dict[str, Any], folder: Path) -> None:
    board_photographs.write_png(folder / "1-0.png", np.zeros((9, 9, 3), np.uint16))


def metres(document: dict[str, Any], folder: Path) -> None:
    document["unit"] = "m"


def no_noise(document: dict[str, Any], folder: Path) -> None:
    for shot in document["photographs"]:
        shot["frames"] = shot["frames"][:1]


def jpeg(document: dict[str, Any], folder: Path) -> None:
    Image.fromarray(np.full((9, 9, 3), 99, np.uint8)).save(folder / "a.jpg")
    document["photographs"][0]["frames"] = ["a.jpg"]


def wrong_mask(document: dict[str, Any], folder: Path) -> None:
    board_photographs.write_png(folder / "mask.png", np.full((9, 9, 3), 65535, np.uint16))
    document["photographs"][0]["mask"] = "mask.png"


SPOILT = [
    (no_board, "photographs[0]: 2-1.png: found 0 corners of the board, allowed are 6 or more"),
    (another_board, "photographs[0]: 0-0.png: found 0 corners of the board"),
    (few, "3 photographs show the board, allowed are 4 or more to find the lens by"),
    (no_exposure, "photographs[1].frames[0]: exposure: is missing, 1-0.png does not say it"),
    (another_size, "photographs[1].frames[0]: 1-0.png has 9 x 9 pixels, allowed are 960 x 720, as the black ones"),
    (metres, "whose radius is 2.5e+04 mm: within it; check unit, pose and world"),
    (no_noise, "noise: is missing, and no photograph has two exposures that tell it; state it"),
    (jpeg, "photographs[0].frames[0]: found a.jpg, jpg of 8 bits with a tone curve for displays"),
    (wrong_mask, "photographs[0].mask: mask.png has 9 x 9 pixels, allowed are 960 x 720"),
]


@pytest.mark.parametrize(("change", "said"), SPOILT, ids=[change.__name__ for change, _ in SPOILT])
def test_what_cannot_be_used_is_named(session, tmp_path, capsys, change, said):
    status, folder = spoilt(session, tmp_path, change)
    assert status == 1
    assert said in capsys.readouterr().err
    assert not (folder / "capture.json").exists()


def test_raw_files_say_their_exposures_themselves(tmp_path):
    """Two photographs of two exposures each as a sensor's mosaic, one twice as wide as what comes of it."""
    pytest.importorskip("rawpy", reason="rawpy is not installed: pip install 'quadgraph[capture]'")
    generator = np.random.default_rng(9)
    board_session.write(tmp_path, [])
    foreign_files.opencv(tmp_path / "lens.yml", LENS)
    shots = []
    for number, pose in enumerate(POSES[:2]):
        ball = board_photographs.ball(board_session.MIDDLE, board_session.RADIUS)
        radiance = board_photographs.photograph(Board(), LENS, pose, ball)
        frames = []
        for shutter in (1, 4):  # fiftieths of a second, of which two make white
            value = np.repeat(np.repeat(radiance * shutter / 2, 2, axis=0), 2, axis=1)
            mosaic = value[..., 1].copy()
            mosaic[::2, ::2], mosaic[1::2, 1::2] = value[::2, ::2, 0], value[1::2, 1::2, 2]
            mosaic += generator.normal(size=mosaic.shape) * np.sqrt(1e-6 + 1.5e-4 * mosaic)
            levels = np.clip(BLACK + mosaic * (WHITE - BLACK), 0, WHITE).astype(np.uint16)
            write_dng(tmp_path / f"{number}-{shutter}.dng", levels, (shutter, 50))
            frames.append(f"{number}-{shutter}.dng")
        shots.append({"frames": frames, "lights": ["lamp"]})
    document = json.loads((tmp_path / "session.json").read_text())
    del document["black"]
    (tmp_path / "session.json").write_text(json.dumps(document | {"cameras": "lens.yml", "photographs": shots}))
    assert main(["capture", "import", str(tmp_path), "-o", str(tmp_path / "capture.json")]) == 0
    said = record(tmp_path)
    assert said["noise"]["shot"] == pytest.approx(1.5e-4, rel=0.05)
    for each, pose in zip(said["photographs"], POSES, strict=False):
        np.testing.assert_allclose(each["exposures"], [2 / 16 / 50, 8 / 16 / 50])
        np.testing.assert_allclose(each["exposure_ratios"], 1, atol=0.005)
        assert np.linalg.norm(np.array(each["eye"]) - pose.eye) < MM["stated"]
    assert main(["capture", "check", str(tmp_path / "capture.json")]) == 0


def test_masks_and_the_body_s_pose_are_carried_over(session, tmp_path):
    def change(document: dict[str, Any], folder: Path) -> None:
        document["photographs"] = document["photographs"][:4]
        mask = np.zeros((LENS.height, LENS.width, 3), np.uint16)
        mask[:, : LENS.width // 2] = 65535
        board_photographs.write_png(folder / "mask.png", mask)
        document["photographs"][0]["mask"] = "mask.png"
        document["noise"] = {"read_out": 0.0012, "shot": 1.5e-4}

    status, folder = spoilt(session, tmp_path, change)
    assert status == 0
    stated = capture.read(folder / "capture.json")
    assert stated.deformation[0]["translate"] == [87.5, 112.5, 0]
    assert stated.photographs[0].gain == "lamp"
    kept = core.read_image(folder / "capture-photograph-1-mask.png") > 0.5
    assert 0.2 < kept.mean() < 0.8
    assert record(folder)["noise"]["stated"]
