"""A lamp from photographs of the board alone: where it is, how strong, how sure, and what cannot tell it."""

from __future__ import annotations

import contextlib
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import board_photographs
import board_session
import foreign_files
import lit_boards
from quadgraph.acquisition.board.board import Board
from quadgraph.acquisition.lighting import board_whites, near_lamp
from quadgraph.acquisition.session import session_file
from quadgraph.base.errors import InputError
from quadgraph.cli import main

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
pytest.importorskip("cv2", reason="OpenCV is not installed: pip install 'quadgraph[capture]'")

LENS, NOISE = board_photographs.LENS, board_session.NOISE


def found(scene: lit_boards.LampScene, **more: Any) -> tuple[near_lamp.NearLamp, float]:
    """The lamp of a scene from photographs with noise, poses known, and the gain."""
    pictures, gain = scene.photographed(NOISE)
    whites = [
        board_whites.sample("board", scene.board, picture, LENS, pose)
        for picture, pose in zip(pictures, scene.poses, strict=True)
    ]
    return near_lamp.fit("lights.lamp", whites, lit_boards.PAPER, 0.0, **more), gain


def off(scene: lit_boards.LampScene, lamp: near_lamp.NearLamp, gain: float) -> tuple[float, float, float]:
    """Millimetres, the largest relative error of a channel's power, and millimetres over their deviation."""
    mm = float(np.linalg.norm(lamp.position - scene.position))
    return mm, float(np.abs(lamp.power / (scene.power * gain) - 1).max()), mm / np.linalg.norm(lamp.position_deviation)


def measured(seeds: range, **more: Any) -> np.ndarray:
    """(n, 3) what `off` says of each seed."""
    scenes = [lit_boards.LampScene(seed, **more) for seed in seeds]
    return np.array([off(scene, *found(scene, forwards=scene.forwards)) for scene in scenes])


@pytest.mark.parametrize(
    ("kind", "more"),
    [
        ("three photographs", {}),
        ("a lens that darkens", {"falls": 2.0}),
        ("paper that shines", {"gloss": 0.5}),
        ("light of the room", {"ambient": 2e-7}),
    ],
)
def test_the_lamp_is_found_where_it_is(kind, more):
    rows = measured(range(100, 101), **more)
    assert rows[:, 0].max() < 4.0
    assert rows[:, 1].max() < 0.025
    assert rows[:, 2].max() < 2.0


@pytest.mark.long
@pytest.mark.parametrize(
    ("kind", "more"),
    [
        ("200 to 450 mm away", {}),
        ("450 to 900 mm away", {"far": (450.0, 900.0)}),
        ("a lens that darkens", {"falls": 2.0}),
        ("paper that shines", {"gloss": 0.5}),
        ("light of the room", {"ambient": 2e-7}),
        ("one photograph", {"photographs": 1}),
        ("an LED", {"forwards": True}),
    ],
)
def test_numbers_of_the_page(kind, more, capsys):
    rows = measured(range(20), **more)
    middle, most = np.median(rows, axis=0), np.quantile(rows, 0.9, axis=0)
    with capsys.disabled():
        print(f"\n{kind}: {middle[0]:.2f} mm, 90% {most[0]:.2f}; {middle[1]:.2%}, 90% {most[1]:.2%}; {most[2]:.2f}")
    assert most[0] < (15 if "900" in kind else 8 if "LED" in kind else 4)
    assert most[1] < (0.025 if kind not in ("450 to 900 mm away", "an LED") else 0.06)
    assert most[2] < 2


@pytest.mark.parametrize("seed", [20, pytest.param(21, marks=pytest.mark.long)])
def test_a_lamp_that_shines_forwards_is_found_as_one_and_told_from_the_other_kind(seed):
    """A small Lambertian surface that looks at the middle of the board: power / pi along its axis."""
    scene = lit_boards.LampScene(seed, forwards=True)
    lamp, gain = found(scene, forwards=True)
    mm, power, deviations = off(scene, lamp, gain)
    assert mm < 8
    assert power < 0.03
    assert deviations < 2
    assert not lamp.unlike
    assert np.linalg.norm(lamp.aim - scene.middle[:2]) < 20
    wrong, _ = found(lit_boards.LampScene(seed, forwards=True))
    assert wrong.unlike


def test_a_lamp_that_shines_all_around_is_told_from_the_other_kind():
    assert not found(lit_boards.LampScene(22))[0].unlike
    assert found(lit_boards.LampScene(22), forwards=True)[0].unlike


def test_a_lens_that_darkens_is_told_from_the_lamp():
    lamp, _ = found(lit_boards.LampScene(7, falls=2.0))
    assert lamp.falloff == pytest.approx(2.0, abs=0.05)


def test_light_of_the_room_is_told_from_the_lamp():
    scene = lit_boards.LampScene(8, ambient=2e-7)
    lamp, gain = found(scene)
    np.testing.assert_allclose(lamp.ambient, 2e-7 * scene.power * gain, rtol=0.1)


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.long) for seed in (1, 2))])
def test_a_lamp_that_is_too_far_is_not_placed(seed):
    with pytest.raises(InputError, match=r"^lights\.lamp: found a lamp .*, give or take .* Bring the lamp nearer"):
        found(lit_boards.LampScene(seed, far=(4000.0, 6000.0)))


def test_of_lamps_between_near_and_far_what_is_told_is_as_sure_as_it_says():
    told = []
    for seed in range(2):
        scene = lit_boards.LampScene(seed, far=(900.0, 1500.0))
        with contextlib.suppress(InputError):
            told.append(off(scene, *found(scene))[2])
    assert len(told) >= 1
    assert max(told) < 2


def spoilt_whites(picture: np.ndarray) -> board_whites.Whites:
    pose = lit_boards.LampScene(1).poses[0]
    radiance = lit_boards.radiance_of(picture, NOISE, np.random.default_rng(1))
    return board_whites.sample("session.json: lights.lamp.calibrate[0]", Board(), radiance, LENS, pose)


def test_saturated_and_dark_boards_are_named():
    scene = lit_boards.LampScene(1)
    shown = scene.shown(scene.poses[0])
    with pytest.raises(InputError, match=r"calibrate\[0\]: \d+% of the white paper is saturated, allowed is half"):
        spoilt_whites(shown / np.median(shown) * 2)
    scene.position[2] *= -1
    behind = scene.shown(scene.poses[0])
    assert behind.max() == 0
    with pytest.raises(InputError, match=r"calibrate\[0\]: the board is dark, .* before the board rather than behind"):
        spoilt_whites(behind)


def test_a_board_that_is_too_small_in_the_picture_is_named():
    pose = board_photographs.pose_from([87, -1500, 1500], [87, 112, 0])
    flat = lit_boards.radiance_of(np.full((LENS.height, LENS.width, 3), 0.5), NOISE, np.random.default_rng(1))
    with pytest.raises(InputError, match=r"pieces of white paper .* photograph the whole board from nearer"):
        board_whites.sample("board", Board(), flat, LENS, pose)


@pytest.fixture(scope="module")
def session(tmp_path_factory) -> tuple[Path, lit_boards.LampScene, float]:
    """A session of four photographs of a ball, and three of the board under a lamp that is to be found."""
    folder = tmp_path_factory.mktemp("lamp")
    path = board_session.write(folder, board_session.cameras()[:8:2], exposures=[1.0])
    scene = lit_boards.LampScene(3)
    shown = [scene.shown(pose) for pose in scene.poses]
    gain = lit_boards.FULL / max(float(each.max()) for each in shown)
    boards = []
    for number, each in enumerate(shown):
        frames = []
        for step, exposure in enumerate((0.25, 1.0)):
            name = f"lamp-{number}-{step}.png"
            picture = board_photographs.exposed(each * gain, exposure, NOISE, scene.generator, board_session.BLACK)
            board_photographs.write_png(folder / name, picture)
            frames.append({"file": name, "exposure": exposure})
        boards.append({"frames": frames})
    document = json.loads(path.read_text())
    document["lights"]["lamp"] = {"type": "point", "calibrate": boards, "reflectance": lit_boards.PAPER}
    path.write_text(json.dumps(document | board_session.KNOWN_NOISE))
    assert main(["capture", "import", str(folder), "-o", str(folder / "capture.json")]) == 0
    return folder, scene, gain


def test_the_session_s_lamp_is_written_into_the_capture(session, capsys):
    folder, scene, gain = session
    light = json.loads((folder / "capture.json").read_text())["lights"]["lamp"]
    assert light["type"] == "point"
    assert np.linalg.norm(np.array(light["position"]) - scene.position) < 5
    np.testing.assert_allclose(light["power"], scene.power * gain, rtol=0.03)
    said = json.loads((folder / "capture-import.json").read_text())["lamps"]["lamp"]
    assert said["reflectance_deviation"] == 0.05
    assert 0.06 < said["power_deviation"][0] / said["power"][0] < 0.08  # that of the paper, for the most part
    assert main(["capture", "check", str(folder / "capture.json"), "--page", str(folder / "check.html")]) in (0, 3)
    assert "lamp lamp: " in capsys.readouterr().out
    assert "W times gain, to" in (folder / "check.html").read_text()


def test_a_lamp_that_shines_forwards_becomes_a_square_that_looks_along_its_axis(session, tmp_path):
    folder = session[0]
    lamp = json.loads((folder / "session.json").read_text())["lights"]["lamp"] | {"type": "rectangle", "side": 10}
    path = with_lamp(session, tmp_path, lamp)
    assert main(["capture", "import", str(path), "-o", str(folder / "square.json")]) == 0
    light = json.loads((folder / "square.json").read_text())["lights"]["lamp"]
    said = json.loads((folder / "square-import.json").read_text())["lamps"]["lamp"]
    u, v, centre = (np.array(light[name]) for name in ("u", "v", "centre"))
    axis = np.array([*said["aim"], 0]) - centre
    np.testing.assert_allclose([np.linalg.norm(u), np.linalg.norm(v)], 10, rtol=1e-4)
    np.testing.assert_allclose(np.cross(u, v) / 100, axis / np.linalg.norm(axis), atol=1e-3)
    assert said["unlike"]  # the session's lamp shines all around


def test_cameras_of_another_program_need_not_know_the_board_s_photographs(session, tmp_path):
    folder, scene, gain = session
    poses = {f"{number}-0.png": (LENS, pose) for number, pose in enumerate(board_session.cameras()[:8:2])}
    foreign_files.nerf(folder / "transforms.json", poses)
    lamp = json.loads((folder / "session.json").read_text())["lights"]["lamp"]
    path = with_lamp(session, tmp_path, lamp, cameras="transforms.json", world={"scale": 1.0})
    assert main(["capture", "import", str(path), "-o", str(folder / "foreign.json")]) == 0
    light = json.loads((folder / "foreign.json").read_text())["lights"]["lamp"]
    assert np.linalg.norm(np.array(light["position"]) - scene.position) < 5
    np.testing.assert_allclose(light["power"], scene.power * gain, rtol=0.03)


def with_lamp(session: tuple[Path, Any, float], tmp_path: Path, lamp: Any, **more: Any) -> Path:
    folder = session[0]
    document = json.loads((folder / "session.json").read_text()) | more
    document["lights"]["lamp"] = lamp
    path = folder / f"{tmp_path.name}.json"
    path.write_text(json.dumps(document))
    return path


WRONG: list[tuple[Any, str]] = [
    ({"type": "point", "calibrate": []}, "lights.lamp.calibrate: found 0 items"),
    ({"type": "spot", "calibrate": [{"frames": ["0-0.png"]}]}, 'lights.lamp.type: found "spot", allowed are point'),
    ({"type": "rectangle", "calibrate": [{"frames": ["0-0.png"]}]}, "lights.lamp.side: has to be there with type"),
    ({"type": "point", "side": 9, "calibrate": [{"frames": ["0-0.png"]}]}, "lights.lamp.side: is for type rectangle"),
    ({"type": "point", "calibrate": [{"frames": ["x.png"]}]}, 'lights.lamp.calibrate[0].frames[0]: found "x.png"'),
    (
        {"type": "point", "calibrate": [{"frames": ["0-0.png"]}], "reflectance": 1.5},
        "lights.lamp.reflectance: found 1.5, allowed is a number from 0.05 to 1 (of the white paper)",
    ),
    (
        {"type": "point", "calibrate": [{"frames": ["0-0.png"]}], "position": [1, 2, 3]},
        "lights.lamp.position: found [1, 2, 3], allowed is nothing of this name",
    ),
]


@pytest.mark.parametrize(("lamp", "said"), WRONG)
def test_a_lamp_that_is_stated_wrong_is_named(session, tmp_path, lamp, said):
    with pytest.raises(InputError) as error:
        session_file.read(with_lamp(session, tmp_path, lamp))
    assert said in str(error.value)


def test_a_photograph_without_board_is_named(session, tmp_path, capsys):
    lamp = {"type": "point", "calibrate": [{"frames": ["black-0.png"]}]}
    path = with_lamp(session, tmp_path, lamp)
    assert main(["capture", "import", str(path), "-o", str(tmp_path / "capture.json")]) == 1
    assert "lights.lamp.calibrate[0]: black-0.png: found 0 corners of the board" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
