"""Masks by a photograph without the body: where the body is, its shadow left out, and what does not fit named."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import board_photographs
import board_session
import lit_boards
from quadgraph import core
from quadgraph.acquisition.board.board import Board
from quadgraph.acquisition.cameras.lens import PinholeView, project
from quadgraph.acquisition.cameras.rigid_placement import Placement
from quadgraph.acquisition.capture.radiance import Radiance
from quadgraph.acquisition.session import background_masks, session_file
from quadgraph.base.errors import InputError
from quadgraph.cli import main

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
pytest.importorskip("cv2", reason="OpenCV is not installed: pip install 'quadgraph[capture]'")

NOISE, LENS = board_session.NOISE, board_photographs.LENS


def overlap(scene: lit_boards.BackgroundScene) -> tuple[float, float, float]:
    """Intersection over union; what is kept beside the body, and what is left out of it, of the body."""
    found = background_masks.kept("background", Board(), *scene.pictures(NOISE))
    body = scene.body
    size = body.sum()
    return (found & body).sum() / (found | body).sum(), (found & ~body).sum() / size, (~found & body).sum() / size


@pytest.mark.parametrize("seed", [0, 4, 10])
def test_the_body_is_kept_and_its_shadow_is_not(seed):
    union, beside, missing = overlap(lit_boards.BackgroundScene(seed))
    assert union > 0.9
    assert beside < 0.1
    assert missing < 0.1


@pytest.mark.long
def test_numbers_of_masks(capsys):
    rows = np.array([overlap(lit_boards.BackgroundScene(seed)) for seed in range(20)])
    with capsys.disabled():
        print("\nunion, beside, missing: median", np.median(rows, axis=0).round(3))
        print("worst tenth", np.quantile(rows[:, 0], 0.1).round(3), np.quantile(rows[:, 1:], 0.9, axis=0).round(3))
    assert np.median(rows[:, 0]) > 0.93
    assert np.quantile(rows[:, 0], 0.1) > 0.85


def test_a_body_before_a_dark_cloth_needs_no_board():
    """Nothing but noise in the background; in the photograph a disc, of which a part is saturated."""
    generator = np.random.default_rng(3)
    rows, columns = np.mgrid[:300, :400]
    disc = (rows - 140) ** 2 + (columns - 230) ** 2 < 60**2
    shown = np.where(disc[..., None], [0.5, 0.4, 0.2], 0.002)
    shown[130:150, 200:220] = 1.2
    both = (shown, np.full(shown.shape, 0.002))
    photograph, empty = (lit_boards.radiance_of(each, NOISE, generator) for each in both)
    found = background_masks.kept("background", None, photograph, empty)
    assert (found & disc).sum() / (found | disc).sum() > 0.94


@pytest.fixture(scope="module")
def scene() -> lit_boards.BackgroundScene:
    return lit_boards.BackgroundScene(4)


def refused(scene: lit_boards.BackgroundScene, empty: np.ndarray, shown: np.ndarray | None = None) -> str:
    """What is said of another background, or photograph."""
    generator = np.random.default_rng(1)
    both = (scene.shown if shown is None else shown, empty)
    pictures = [lit_boards.radiance_of(each, NOISE, generator) for each in both]
    with pytest.raises(InputError) as error:
        background_masks.kept("photographs[0].background: b.png", Board(), *pictures)
    assert str(error.value).startswith("photographs[0].background: b.png")
    return str(error.value)


def test_a_background_that_does_not_fit_is_named(scene):
    light = lit_boards.lamp_light(scene.lamp.position, scene.lamp.power)
    pose = scene.pose
    eye = pose.eye + np.array([3.0, 0, 0])
    beside = board_photographs.pose_from(eye, eye + 300 * pose.rotation[2])
    moved = lit_boards.reflected(Board(), LENS, beside, light) * scene.gain
    assert "corners" in (said := refused(scene, moved)) or "the camera moved by" in said
    near = np.roll(scene.empty, 3, axis=1)
    assert "the camera moved by 3.0 pixels, allowed are 0.5" in refused(scene, near)
    assert "the photograph is 2.0" in (said := refused(scene, scene.empty / 2))
    assert "times as bright all over; allowed is the same exposure" in said
    elsewhere = np.array([2 * 87.5, 2 * 112.5, 0]) - scene.lamp.position * [1, 1, -0.3]
    other = lit_boards.reflected(Board(), LENS, pose, lit_boards.lamp_light(elsewhere, 3 * scene.lamp.power))
    other *= lit_boards.FULL / other.max()
    assert "same lights" in (said := refused(scene, other)) or "times as bright" in said
    assert "the body by it is 0.00% of the photograph" in refused(scene, scene.empty, scene.empty)
    assert "has 480 x 720 pixels, allowed are 960 x 720" in refused(scene, scene.empty[:, ::2])


def written(folder: Path) -> Path:
    """A session of four photographs of a ball, each with its background, in folder."""
    path = board_session.write(folder, board_session.cameras()[:8:2], exposures=[1.0])
    generator = np.random.default_rng(2)
    document = json.loads(path.read_text())
    for number, (shot, pose) in enumerate(zip(document["photographs"], board_session.cameras()[:8:2], strict=True)):
        bare = board_photographs.photograph(Board(), LENS, pose)
        picture = board_photographs.exposed(bare, 1.0, NOISE, generator, board_session.BLACK)
        board_photographs.write_png(folder / f"empty-{number}.png", picture)
        shot["background"] = [{"file": f"empty-{number}.png", "exposure": 1.0}]
    path.write_text(json.dumps(document | board_session.KNOWN_NOISE))
    return path


@pytest.fixture(scope="module")
def session(tmp_path_factory) -> Path:
    """The folder of a session with backgrounds, whose body is stated 12 mm beside where it lies."""
    folder = tmp_path_factory.mktemp("background")
    path = written(folder)
    document = json.loads(path.read_text())
    document["pose"]["translate"][0] += 12
    path.write_text(json.dumps(document))
    return folder


@pytest.mark.long
def test_the_mask_shows_where_the_body_is_and_not_where_it_is_stated(session):
    assert main(["capture", "import", str(session), "-o", str(session / "capture.json")]) == 0
    cameras = json.loads((session / "capture.json").read_text())["cameras"]
    stated = board_session.MIDDLE + np.array([12.0, 0, 0])
    for name, camera in cameras.items():
        mask = np.asarray(core.read_image(session / f"capture-{name}-mask.png"))[..., 0] > 0.5
        eye, look_at = (np.array(camera[each]) for each in ("eye", "look_at"))
        view = PinholeView(eye, look_at, camera["fov"], camera["up"], *mask.shape[::-1])
        where = np.argwhere(mask).mean(axis=0)[::-1] + 0.5
        true, wrong = (project(view.lens, view.pose, each[None])[0] for each in (board_session.MIDDLE, stated))
        apart = np.linalg.norm(true - wrong)
        assert np.linalg.norm(where - true) < 0.35 * apart  # the view is about the stated place, and cuts a part off
        assert apart > 8


def test_masks_tell_where_the_body_lies(session, tmp_path, capsys):
    """Stated is a place 12 mm beside."""
    document = json.loads((session / "session.json").read_text())
    made, path = tmp_path / "capture.json", session / "fitted.json"
    path.write_text(json.dumps(document | {"pose": document["pose"] | {"fit": True}}))
    assert main(["capture", "import", str(path), "-o", str(made)]) == 0
    step = json.loads(made.read_text())["deformation"][0]
    turn = Placement(1.0, tuple(step["axis"]), step["degrees"], np.zeros(3)).rotation
    middle = turn @ [0, 0, board_session.RADIUS] + step["translate"]
    np.testing.assert_allclose(middle, board_session.MIDDLE, atol=0.2)
    record = json.loads((tmp_path / "capture-import.json").read_text())["pose"]
    assert record["photographs"] == 4
    assert record["symmetric"]
    assert record["off"] < 1
    assert abs(record["lowest"]) < 0.2
    capsys.readouterr()
    assert main(["capture", "check", str(made), "--page", str(tmp_path / "check.html")]) == 0
    assert "pose: by 4 masks, " in (said := capsys.readouterr().out)
    assert "it looks the same turned otherwise; its lowest place is " in said
    assert "pose</b>: by 4 masks" in (tmp_path / "check.html").read_text()


def test_a_pose_that_masks_cannot_tell_is_named(session, tmp_path):
    document = json.loads((session / "session.json").read_text())
    shots = [{name: each for name, each in shot.items() if name != "background"} for shot in document["photographs"]]
    path = session / f"{tmp_path.name}.json"
    for pose, shown, said in (
        ({"fit": 1}, document["photographs"], "pose.fit: found 1, allowed are true, by masks, and false"),
        ({"fit": True}, shots, "pose.fit: found true, 0 photographs have a mask or a background, allowed are 2"),
    ):
        path.write_text(json.dumps(document | {"pose": pose, "photographs": shown}))
        with pytest.raises(InputError) as error:
            session_file.read(path)
        assert said in str(error.value)


@pytest.mark.long
def test_a_body_in_another_unit_fits_nowhere(session, tmp_path, capsys):
    document = json.loads((session / "session.json").read_text())
    path = session / f"{tmp_path.name}.json"
    path.write_text(json.dumps(document | {"pose": {"fit": True}, "unit": "cm"}))
    assert main(["capture", "import", str(path), "-o", str(tmp_path / "capture.json")]) == 1
    assert "pose.fit: where it fits best the body shares" in (said := capsys.readouterr().err)
    assert "is it the mesh of this body, in this unit" in said
    assert not (tmp_path / "capture.json").exists()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"mask": "0-0.png"}, 'photographs[0].background: found [{"file": "empty-0.png"'),
        ({"background": "empty-0.png"}, 'photographs[0].background: found "empty-0.png", allowed is a list of 1 to 16'),
        ({"background": ["none.png"]}, 'photographs[0].background[0]: found "none.png"'),
    ],
)
def test_a_background_that_is_stated_wrong_is_named(session, tmp_path, change, said):
    document = json.loads((session / "session.json").read_text())
    document["photographs"][0] |= change
    path = session / f"{tmp_path.name}.json"
    path.write_text(json.dumps(document))
    with pytest.raises(InputError) as error:
        session_file.read(path)
    assert said in str(error.value)


def test_the_background_of_another_photograph_is_named(session, tmp_path, capsys):
    document = json.loads((session / "session.json").read_text())
    document["photographs"][0]["background"] = document["photographs"][1]["background"]
    path = session / "other.json"
    path.write_text(json.dumps(document))
    assert main(["capture", "import", str(path), "-o", str(tmp_path / "capture.json")]) == 1
    assert "photographs[0].background: empty-1.png" in capsys.readouterr().err
    assert not (tmp_path / "capture.json").exists()


def test_a_photograph_that_is_saturated_there_counts_as_changed():
    flat = np.full((60, 80, 3), 0.3)
    shown = flat.copy()
    shown[20:40, 30:60] = 2.0
    pictures: list[Radiance] = [lit_boards.radiance_of(each, NOISE, np.random.default_rng(0)) for each in (shown, flat)]
    found = background_masks.kept("background", None, *pictures)
    assert found[24:36, 34:56].all()
    assert found.sum() < 1.3 * 20 * 30
