"""The whole way: photographs of a known body on the printed board, to the coefficients that acquire finds by them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.ndimage import map_coordinates

import board_photographs
import board_session
import foreign_files
import lit_boards
import twin_capture
from outlined_bodies import masks_of, roughened
from quadgraph import core
from quadgraph.acquisition.board.board import Board
from quadgraph.acquisition.cameras.lens import Pose, view_towards
from quadgraph.acquisition.cameras.placed_body import PlacedBody
from quadgraph.base import image_file
from quadgraph.cli import main

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
pytest.importorskip("cv2", reason="OpenCV is not installed: pip install 'quadgraph[capture]'")

PLACE = np.array([87.5, 112.5, 20.0])
LAMP: dict[str, Any] = {
    "type": "rectangle",
    "centre": [190, 200, 130],
    "u": [60, -60, 0],
    "v": [-30, -30, 80],
    "power": [1000, 900, 800],
}
POINT: dict[str, Any] = {"type": "point", "position": [210, 210, 200], "power": [2000, 1800, 1600]}
RADIUS, DETAIL = 24.0, 360  # mm around the body, and pixels of the engine's pictures that are photographed
NOISE = (0.003, 1e-3)  # read-out and shot noise of a value: 3% of white, as of a small sensor
WHITE = 0.7  # of full scale, that the brightest of the body has at an exposure of 1


def body_of(folder: Path, gain: list[float], light: dict[str, Any] = LAMP) -> Any:
    """What the engine sees of the finer body from each pose; `gain` gets what makes of its radiance a value."""
    lamp = light | {name: (np.array(light[name]) - PLACE).tolist() for name in ("centre", "position") if name in light}

    def at(pose: Pose) -> board_photographs.Body:
        view = view_towards(pose.eye - PLACE, np.zeros(3), RADIUS, DETAIL)
        [radiance] = twin_capture.photographed(folder / "finer.qgraph", twin_capture.TRUTH, lamp, [view.members()])
        if not gain:
            gain.append(WHITE / float(np.quantile(radiance, 0.999)))
        shown = radiance * gain[0]

        def of(origins: np.ndarray, ways: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            along = ways @ view.axes().T
            places = view.lens.places(along[:, :2] / along[:, 2:])
            inside = (places > 1).all(axis=1) & (places < DETAIL - 1).all(axis=1)
            found = np.zeros((len(ways), 3))
            for channel in range(3):
                rows = [places[inside, 1] - 0.5, places[inside, 0] - 0.5]
                found[inside, channel] = map_coordinates(shown[..., channel], rows, order=1)
            return inside & (found.max(axis=1) > 0.002), found

        return of

    return at


def recovered(folder: Path, name: str) -> np.ndarray:
    """(2, 3) relative errors of sigma_a and sigma_s_prime by a session."""
    made = [str(folder / f"{name}-{end}") for end in ("capture.json", "wax.npz", "wax.json")]
    assert main(["capture", "import", str(folder / f"{name}.json"), "-o", made[0]]) == 0
    assert main(["capture", "check", made[0]]) == 0
    assert main(["acquire", made[0], "-o", made[1], "--json", made[2], "--device", "cpu"]) == 0
    said = json.loads(Path(made[2]).read_text())
    assert not said["findings"]
    return np.array([np.array(said["coefficients"][key]) / twin_capture.TRUTH[key] - 1 for key in twin_capture.TRUTH])


def boards(folder: Path, gain: float) -> list[dict[str, Any]]:
    """Five photographs of the board alone under the point lamp, two exposures each."""
    generator = np.random.default_rng(5)
    light = lit_boards.lamp_light(POINT["position"], POINT["power"])
    shots = []
    for number, pose in enumerate(board_photographs.around([87.5, 112.5, 0.0], 330.0, 5, 50, 40.0)):
        radiance = lit_boards.reflected(Board(), board_photographs.LENS, pose, light) * gain
        frames = []
        for step, exposure in enumerate((0.25 / radiance.max(), 0.9 / radiance.max())):
            name = f"lamp-{number}-{step}.png"
            picture = board_photographs.exposed(radiance, exposure, NOISE, generator, board_session.BLACK)
            board_photographs.write_png(folder / name, picture)
            frames.append({"file": name, "exposure": float(exposure)})
        shots.append({"frames": frames})
    return shots


@pytest.fixture(scope="module")
def photographed(tmp_path_factory) -> tuple[Path, dict[str, Any], float]:
    """A folder with four photographs of the body under the point lamp and with as many of the bare board, the session
    of the former, and the gain.
    """
    folder = tmp_path_factory.mktemp("point")
    twin_capture.bodies(folder)
    gain: list[float] = []
    poses = board_session.cameras()[::3]
    more = {"body": "potato.qgraph", "eta": twin_capture.ETA, "lights": {"lamp": POINT}, "size": 64}
    pose = {"pose": {"translate": PLACE.tolist()}}
    path = board_session.write(folder, poses, shows=body_of(folder, gain, POINT), noise=NOISE, **more, **pose)
    document = json.loads(path.read_text())
    del document["unit"]
    generator = np.random.default_rng(6)
    for number, pose_of in enumerate(poses):
        bare = board_photographs.photograph(Board(), board_photographs.LENS, pose_of)
        picture = board_photographs.exposed(bare, 1.0, NOISE, generator, board_session.BLACK)
        board_photographs.write_png(folder / f"empty-{number}.png", picture)
    return folder, document, gain[0]


@pytest.mark.long
def test_a_lamp_from_the_board_is_as_good_as_the_exact_one(photographed):
    """Place and power of a point lamp by five photographs of the board; the power stands in for the camera's gain."""
    folder, document, gain = photographed
    lamp = {"type": "point", "calibrate": boards(folder, gain), "reflectance": board_photographs.PAPER}
    for name, factor, light in (("exact", gain, POINT), ("found", 1.0, lamp)):
        shots = [shot | {"gain": factor} for shot in document["photographs"]]
        stated = document | {"lights": {"lamp": light}, "photographs": shots}
        (folder / f"{name}.json").write_text(json.dumps(stated))
    by_exact, by_found = (recovered(folder, name) for name in ("exact", "found"))
    assert np.abs(by_exact).max() < 0.05
    assert np.sqrt((by_found**2).mean()) < 1.5 * np.sqrt((by_exact**2).mean())


@pytest.mark.long
@pytest.mark.parametrize("beside", [0.0, 7.0])
def test_masks_from_backgrounds_tell_a_body_that_lies_elsewhere(photographed, beside):
    """beside: mm, by which the body lies elsewhere than the session states."""
    folder, document, gain = photographed
    shots = [
        shot | {"gain": gain, "background": [{"file": f"empty-{number}.png", "exposure": 1.0}]}
        for number, shot in enumerate(document["photographs"])
    ]
    pose = {"translate": (PLACE + np.array([beside, 0, 0])).tolist()}
    (folder / "masked.json").write_text(json.dumps(document | {"photographs": shots, "pose": pose}))
    made = [str(folder / f"masked-{end}") for end in ("capture.json", "wax.npz", "wax.json")]
    assert main(["capture", "import", str(folder / "masked.json"), "-o", made[0]]) == 0
    status = main(["acquire", made[0], "-o", made[1], "--json", made[2], "--device", "cpu"])
    said = json.loads(Path(made[2]).read_text())
    if beside:
        assert status == 3
        assert any(".mask: " in text or text.startswith("probably deformation: ") for text in said["findings"])
        return
    assert not said["findings"]
    for key, true in twin_capture.TRUTH.items():
        np.testing.assert_allclose(said["coefficients"][key], true, rtol=0.06)


@pytest.mark.long
def test_a_body_whose_pose_masks_tell_is_recovered(photographed):
    """Nothing is stated of where it lies; edges of the masks are a pixel off, as by hand."""
    folder, document, gain = photographed
    display = core.load(folder / "potato.qgraph").display
    triangles = np.asarray(display["triangles"]).reshape(-1, 3)
    body = PlacedBody(np.asarray(display["vertices"], float) + PLACE, triangles)
    generator = np.random.default_rng(8)
    shots = []
    for number, mask in enumerate(masks_of(body, board_session.cameras()[::3])):
        drawn = np.where(roughened(mask, 1.0, generator), 255, 0).astype(np.uint8)
        image_file.write(folder / f"hand-{number}.png", drawn)
        shots.append(document["photographs"][number] | {"gain": gain, "mask": f"hand-{number}.png"})
    (folder / "fitted.json").write_text(json.dumps(document | {"photographs": shots, "pose": {"fit": True}}))
    errors = recovered(folder, "fitted")
    step = json.loads((folder / "fitted-capture.json").read_text())["deformation"][0]
    told = json.loads((folder / "fitted-capture-import.json").read_text())["pose"]
    off = np.linalg.norm(np.array(step["translate"]) - PLACE)
    print("\npose:", step, told, "mm off:", off, "coefficients:", errors)
    assert off < 0.5
    assert np.abs(errors).max() < 0.08


@pytest.mark.long
def test_poses_from_the_board_are_as_good_as_exact_ones(tmp_path):
    twin_capture.bodies(tmp_path)
    gain: list[float] = []
    poses = board_session.cameras()[::2]
    more = {"body": "potato.qgraph", "eta": twin_capture.ETA, "lights": {"lamp": LAMP}, "size": 64}
    pose = {"pose": {"translate": PLACE.tolist()}}
    path = board_session.write(tmp_path, poses, shows=body_of(tmp_path, gain), noise=NOISE, **more, **pose)
    document = json.loads(path.read_text())
    del document["unit"]
    for shot in document["photographs"]:
        shot["gain"] = gain[0]
    (tmp_path / "board.json").write_text(json.dumps(document))
    known = {f"{number}-0.png": (board_photographs.LENS, pose) for number, pose in enumerate(poses)}
    foreign_files.nerf(tmp_path / "transforms.json", known)
    exact = document | {"cameras": "transforms.json", "world": {}}
    (tmp_path / "exact.json").write_text(json.dumps(exact))
    by_board, by_exact = (recovered(tmp_path, name) for name in ("board", "exact"))
    assert np.abs(by_exact).max() < 0.05
    assert np.sqrt((by_board**2).mean()) < 1.5 * np.sqrt((by_exact**2).mean())
