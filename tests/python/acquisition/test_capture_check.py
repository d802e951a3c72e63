"""`quadgraph capture check` passes a capture that is fine, and names what is spoilt in others, with exit code 3."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import board_photographs
from quadgraph.acquisition.cameras.lens import project, view_towards
from quadgraph.acquisition.cameras.placed_body import FLAT, PlacedBody, of_capture
from quadgraph.acquisition.capture import capture
from quadgraph.acquisition.checking import capture_check
from quadgraph.cli import main
from shapes import icosphere, join, moved, write_obj

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

RADIUS, SIZE, PLACE = 25.0, 96, np.array([60.0, 80.0, 25.0])
LAMPS = {
    "lamp": {"type": "point", "position": [260, 40, 260], "power": 1},
    "other": {"type": "point", "position": [-160, 140, 200], "power": 1},
}


@pytest.fixture(scope="module")
def fine(tmp_path_factory) -> Path:
    """The folder of a capture of a ball, seen by six cameras under two lamps, with the record of an import."""
    folder = tmp_path_factory.mktemp("fine")
    write_obj(icosphere(4, RADIUS), folder / "ball.obj")
    ball = board_photographs.ball(PLACE, RADIUS)
    generator = np.random.default_rng(1)
    cameras, shots, told = {}, [], []
    for number, pose in enumerate(board_photographs.around(PLACE, 300.0, 6, 40)):
        view = view_towards(pose.eye, PLACE, 1.1 * RADIUS, SIZE)
        middles = np.stack(np.meshgrid(np.arange(SIZE) + 0.5, np.arange(SIZE) + 0.5), axis=-1).reshape(-1, 2)
        slopes = view.lens.slopes(middles)
        ways = np.concatenate([slopes, np.ones((len(slopes), 1))], axis=1) @ view.axes()
        ways /= np.linalg.norm(ways, axis=1, keepdims=True)
        met, radiance = ball(np.broadcast_to(view.eye, ways.shape), ways)
        values = np.where(met[:, None], radiance, 0.6) + generator.normal(size=(SIZE**2, 3)) * 0.005
        for lamp in LAMPS:
            name = f"{lamp}-{number}"
            np.savez(folder / f"{name}.npz", photograph=values.reshape(SIZE, SIZE, 3))
            noise = {"read_out": 0.005, "shot": 0}
            shots.append({"file": f"{name}.npz", "camera": name, "lights": [lamp], "gain": "g", "noise": noise})
            cameras[name] = view.members()
            corners = generator.uniform(50, 700, (30, 2))
            off = generator.normal(size=(30, 2)) * 0.05
            told.append(
                {
                    "photograph": name,
                    "files": [],
                    "exposures": [1.0, 4.0],
                    "exposure_ratios": [1.001],
                    "moved": 0.05,
                    "samples": 4,
                    "size": [960, 720],
                    "eye": view.eye.tolist(),
                    "reprojection": float(np.sqrt((off**2).sum(axis=1).mean())),
                    "left_out": 0,
                    "corners": np.concatenate([corners, off], axis=1).tolist(),
                }
            )
    move = {"type": "transform", "centre": [0, 0, 0], "axis": [0, 0, 1], "degrees": 30, "translate": PLACE.tolist()}
    fixed = {"quadgraph_capture": 1, "body": "ball.obj", "unit": "mm", "eta": 1.4, "deformation": [move]}
    document = fixed | {"cameras": cameras, "lights": LAMPS, "photographs": shots}
    (folder / "capture.json").write_text(json.dumps(document))
    noise = {"read_out": 0.005, "shot": 0, "stated": True}
    board = {"size": [175, 225], "printed": [149.0, 149.5]}
    whole = {"quadgraph_import": 1, "noise": noise, "lenses": [], "board": board, "photographs": told}
    (folder / "capture-import.json").write_text(json.dumps(whole))
    return folder


def check(folder: Path, *more: str) -> int:
    """The exit code."""
    return main(["capture", "check", str(folder / "capture.json"), "--json", str(folder / "check.json"), *more])


def report(folder: Path) -> dict[str, Any]:
    """What was found."""
    return json.loads((folder / "check.json").read_text())


def test_a_capture_that_is_fine_passes(fine, capsys):
    assert check(fine, "--page", str(fine / "check.html")) == 0
    said = report(fine)
    assert not said["unusable"]
    assert not said["look_at"]
    assert [each["verdict"] for each in said["photographs"]] == ["fine"] * 12
    printed = capsys.readouterr().out
    assert "can be used: quadgraph acquire" in printed
    assert "its rulers of 150 mm are 149 mm along x and 149.5 mm along y" in printed
    assert "photographs[3] (other-1.npz); 30 corners, 0.0" in printed


def test_a_lamp_that_the_board_told_is_shown(fine, tmp_path, capsys):
    folder = change(fine, tmp_path, lambda document, told, folder: told_lamp(told))
    assert check(folder, "--page", str(folder / "check.html")) == 0
    line = "260.0, 40.0, 260.0 mm, to 1.7 mm; power 9 / 8 / 7 W times gain, to 5.7%; other light 1.0% of that on the"
    assert f"lamp lamp: {line}" in capsys.readouterr().out
    assert line in (folder / "check.html").read_text()
    assert not report(folder)["look_at"]
    assert report(folder)["lamps"]["lamp"]["boards"] == 3


def test_what_is_covered_is_what_cameras_see(fine):
    """Of a ball a camera at distance d sees a cap of (1 - r / d) / 2; six see what looks at one of them."""
    stated = capture.read(fine / "capture.json")
    body = of_capture(stated)
    places, triangles = body.samples(20_000)
    camera = stated.cameras["lamp-0"]
    cosines = body.cosine_to(places, triangles, np.array(camera["eye"]))
    distance = float(np.linalg.norm(np.array(camera["eye"]) - PLACE))
    assert (cosines > 0).mean() == pytest.approx((1 - RADIUS / distance) / 2, abs=0.012)
    np.testing.assert_allclose(body.middle, PLACE, atol=1e-6)
    assert body.areas.sum() == pytest.approx(4 * np.pi * RADIUS**2, rel=5e-3)
    checked = capture_check.check(stated)
    normals = (places - PLACE) / RADIUS

    def facing(towards: np.ndarray) -> np.ndarray:
        ways = towards - places
        return np.einsum("nx,nx->n", ways, normals) / np.linalg.norm(ways, axis=1) > FLAT

    seen = np.array([facing(np.array(each["eye"])) for each in stated.cameras.values()])
    lit = {name: facing(np.array(light["position"])) for name, light in LAMPS.items()}
    used = np.array([row & lit[shot.lights[0]] for row, shot in zip(seen, stated.photographs, strict=True)])
    assert checked.seen == pytest.approx(seen.any(axis=0).mean(), abs=0.01)
    assert checked.twice == pytest.approx((seen[::2].sum(axis=0) > 0).mean(), abs=0.01)  # each camera under two lamps
    assert checked.used == pytest.approx(used.any(axis=0).mean(), abs=0.01)
    assert checked.widest == pytest.approx(100, abs=15)


def test_a_body_hides_what_lies_behind_it():
    """Two balls: the nearer one hides the farther one from a camera in line with both."""
    ball = icosphere(3, 10.0)
    both = join(ball, moved(ball, 40, 0, 0))
    body = PlacedBody(both.vertices, both.triangles)
    places, own = body.samples(4000)
    seen = body.cosine_to(places, own, np.array([400.0, 0, 0])) > 0
    near = places[:, 0] > 25
    assert seen[near].mean() > 0.4
    assert seen[~near].mean() < 0.02


def change(fine: Path, tmp_path: Path, edit: Callable[[dict[str, Any], dict[str, Any], Path], None]) -> Path:
    """A copy of the capture with something spoilt."""
    folder = tmp_path / "spoilt"
    shutil.copytree(fine, folder)
    document, told = (json.loads((folder / name).read_text()) for name in ("capture.json", "capture-import.json"))
    edit(document, told, folder)
    (folder / "capture.json").write_text(json.dumps(document))
    (folder / "capture-import.json").write_text(json.dumps(told))
    return folder


def bent(document, told, folder):
    told["photographs"][2] |= {"reprojection": 0.9}


def wrong_pose(document, told, folder):
    told["photographs"][2] |= {"reprojection": 5.0}


def bumped(document, told, folder):
    told["photographs"][4] |= {"moved": 1.2}


def hit(document, told, folder):
    told["photographs"][4] |= {"moved": 9.0}


def wrong_time(document, told, folder):
    told["photographs"][5] |= {"exposure_ratios": [2.0]}


def overexposed(document, told, folder):
    document["photographs"][1] |= {"saturation": 0.05}


def dark(document, told, folder):
    document["photographs"][1] |= {"noise": {"read_out": 5.0, "shot": 0}}


def elsewhere(document, told, folder):
    document["deformation"][0]["translate"] = [900, 0, 0]


def brighter(document, told, folder):
    document["photographs"][6] |= {"exposure": 0.4}


def one_side(document, told, folder):
    document["photographs"] = document["photographs"][:2]
    document["lights"]["lamp"]["position"] = document["cameras"]["lamp-3"]["eye"]


def told_lamp(told, **more):
    boards = [{"files": ["l.png"], "moved": 0.1, "reprojection": 0.05}] * more.pop("boards", 3)
    numbers = {"position": [260, 40, 260], "position_deviation": [1, 1, 1], "power": [9, 8, 7]}
    numbers |= {"power_deviation": [0.5, 0.4, 0.4], "share": 0.01, "off": 0.004}
    lamp = numbers | {"unlike": False, "boards": boards}
    told["lamps"] = {"lamp": lamp | more}


def few_boards(document, told, folder):
    told_lamp(told, boards=1)


def shaded_board(document, told, folder):
    told_lamp(told, off=0.07)


def another_lamp_on(document, told, folder):
    told_lamp(told, off=0.3)


def another_kind(document, told, folder):
    told_lamp(told, unlike=True)


def room_light(document, told, folder):
    told_lamp(told, share=0.4)


def bumped_board(document, told, folder):
    told_lamp(told)
    told["lamps"]["lamp"]["boards"][0]["moved"] = 5.0


SPOILT = [
    (few_boards, 0, "lights.lamp: told by 1 of the board's photographs"),
    (shaded_board, 0, "lights.lamp: the board is lit otherwise than by one small lamp, 7.0% off (RMS)"),
    (another_lamp_on, 3, "lights.lamp: the board is lit otherwise than by one small lamp, 30.0% off (RMS)"),
    (another_kind, 0, "lights.lamp: the board is lit as by the other kind of lamp"),
    (room_light, 0, "lights.lamp: 40% of the light on the board is not the lamp's"),
    (bumped_board, 3, "lights.lamp: the camera moved by 5.0 pixels in a photograph of the board"),
    (bent, 0, "photographs[2]: the board's corners are 0.90 pixels off (RMS), 0.07 in the others: it disagrees"),
    (wrong_pose, 3, "photographs[2]: the board's corners are 5.00 pixels off (RMS), 0.07 in the others: the pose is"),
    (bumped, 0, "photographs[4]: the camera moved by 1.2 pixels between its exposures"),
    (hit, 3, "photographs[4]: the camera moved by 9.0 pixels between its exposures"),
    (wrong_time, 3, "photographs[5]: two of its exposures are 2.00 times further apart than stated"),
    (overexposed, 3, "photographs[1]: 100% of the body is saturated or masked"),
    (dark, 3, "photographs[1]: the median pixel of the body is 0."),
    (elsewhere, 3, "photographs[0]: the body is not in it: check body, unit, deformation and the camera"),
    (brighter, 0, "photographs[6]: it is 2.50 times as bright as the others under the same lights"),
    (one_side, 0, "cameras: at most 0 degrees apart; photographs from more sides say more"),
]


@pytest.mark.parametrize(("edit", "status", "said"), SPOILT, ids=[edit.__name__ for edit, _, _ in SPOILT])
def test_what_is_spoilt_is_named(fine, tmp_path, capsys, edit, status, said):
    folder = change(fine, tmp_path, edit)
    if edit is overexposed:
        values = np.maximum(np.load(folder / "other-0.npz")["photograph"], 0.06)
        values[0, 0] = 0.01
        np.savez(folder / "other-0.npz", photograph=values)
    assert check(folder) == status
    assert said in capsys.readouterr().out
    found = report(folder)
    assert any(text.startswith(said) for text in found["unusable" if status else "look_at"])


def test_the_page_shows_everything_and_needs_nothing_else(fine, tmp_path, browser):
    folder = change(fine, tmp_path, wrong_pose)
    assert check(folder, "--page", str(folder / "check.html")) == 3
    text = (folder / "check.html").read_text()
    assert "://" not in text
    assert "cannot be used" in text
    browser.get((folder / "check.html").as_uri())
    sizes = browser.execute_script("return Array.from(document.images).map(each => each.naturalWidth)")
    assert sizes == [150] * 6 + [SIZE] * 12
    wide = browser.execute_script("return [document.documentElement.scrollWidth, window.innerWidth]")
    assert wide[0] <= wide[1]
    assert not browser.get_log("browser")


def test_a_capture_without_an_import_is_checked_too(fine, tmp_path, capsys):
    folder = change(fine, tmp_path, lambda document, told, folder: None)
    (folder / "capture-import.json").unlink()
    assert check(folder) == 0
    assert "scale: as the capture states it; no board tells it" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (lambda document, told, folder: told.pop("board"), "capture-import.json: board: is missing"),
        (lambda document, told, folder: told_lamp(told, power=[1, 0, 1]), "lamps.lamp: found"),
        (lambda document, told, folder: told["photographs"][0].update(moved="x"), 'photographs[0].moved: found "x"'),
        (
            lambda document, told, folder: told["photographs"][0].update(corners=[[1, 2]]),
            "photographs[0].corners: found",
        ),
        (
            lambda document, told, folder: document.update(deformation=[{"type": "twist", "degrees": 9}]),
            "deformation[0].type: found twist",
        ),
    ],
)
def test_records_and_captures_that_are_no_such_are_refused(fine, tmp_path, capsys, edit, said):
    assert check(change(fine, tmp_path, edit)) == 1
    assert said in capsys.readouterr().err


def test_the_outline_of_the_body_lies_where_it_is_seen(fine):
    stated = capture.read(fine / "capture.json")
    judged = capture_check.check(stated).judged[0]
    assert judged.view is not None
    rows, columns = np.nonzero(judged.outline)
    seen = project(judged.view.lens, judged.view.pose, PLACE[None])[0]
    distance = np.hypot(columns + 0.5 - seen[0], rows + 0.5 - seen[1])
    away = float(np.linalg.norm(judged.view.eye - PLACE))
    wanted = judged.view.lens.fy * np.tan(np.arcsin(RADIUS / away))
    np.testing.assert_allclose(distance, wanted, atol=1.6)
