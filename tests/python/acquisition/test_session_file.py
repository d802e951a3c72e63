"""Sessions are read strictly: what is wrong is named by its path, with what was found and what is allowed."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_capture import put

from quadgraph.acquisition.session import session_file
from quadgraph.base.errors import InputError
from shapes import icosphere, write_obj

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")


def stated() -> dict[str, Any]:
    """A session that is fine."""
    return {
        "quadgraph_session": 1,
        "board": {"squares": [9, 7], "square": 20, "marker": 14, "hollow": [3, 3], "printed": [149.5, 150.2]},
        "body": "ball.obj",
        "unit": "mm",
        "eta": 1.4,
        "pose": {"axis": [1, 0, 0], "degrees": 90, "translate": [87, 110, 0]},
        "lights": {"lamp": {"type": "point", "position": [200, 0, 300], "power": 1}},
        "noise": {"read_out": 0.001, "shot": 0.0001},
        "black": ["black.png"],
        "photographs": [
            {"frames": [{"file": "a.png", "exposure": 0.1}, {"file": "b.png", "exposure": 0.4}], "lights": ["lamp"]},
            {"frames": ["c.dng"], "lights": ["lamp"], "mask": "mask.png", "gain": 2.5},
        ],
    }


@pytest.fixture
def folder(tmp_path) -> Path:
    """A folder with the files of the session."""
    write_obj(icosphere(1), tmp_path / "ball.obj")
    for name in ("a.png", "b.png", "c.dng", "mask.png", "black.png"):
        (tmp_path / name).write_bytes(b"")
    return tmp_path


def read(folder: Path, document: dict[str, Any]) -> session_file.Session:
    """Write and read."""
    (folder / "session.json").write_text(json.dumps(document))
    return session_file.read(folder)


def test_a_session_is_read_as_it_stands(folder):
    found = read(folder, stated())
    assert found.board is not None
    assert (found.board.columns, found.board.rows, found.board.hollow) == (9, 7, (3, 3))
    assert found.board.printed == (149.5, 150.2)
    assert [frame.exposure for shot in found.shots for frame in shot.frames] == [0.1, 0.4, None]
    assert [shot.gain for shot in found.shots] == ["lamp", 2.5]
    np.testing.assert_allclose(found.placement.rotation @ [0, 1, 0], [0, 0, 1], atol=1e-12)
    assert {path.name for path in found.files()} == {
        *("session.json", "ball.obj", "black.png", "a.png", "b.png", "c.dng", "mask.png")
    }


WRONG = [
    ("board", None, "board: is missing, and cameras too"),
    ("board.squares", [9, 7, 5], "board.squares: found 3 items, allowed is a list of 1 to 2"),
    ("board.squares", [2, 7], "board.squares[0]: found 2, allowed is a whole number from 3 to 40"),
    ("board.marker", 25, "board, marker: found 25, allowed are 8 to 19 mm"),
    ("board.dictionary", "5x5", 'board.dictionary: found "5x5", allowed are 4x4_50'),
    ("board.printed", [150], "board.printed: found [150], allowed are two numbers"),
    ("board.hollow", [4, 3], "board, hollow: found 4 columns of 9"),
    ("cameras", "sparse", 'cameras: found "sparse", allowed is what is there beside the session'),
    ("world", {}, "world: found {}, allowed is it beside cameras"),
    ("body", "mesh.obj", 'body: found "mesh.obj", allowed is the name of a file that is there'),
    ("pose.axis", [0, 0, 0], "pose.axis: found [0, 0, 0], allowed is any direction but zero"),
    ("pose.scale", 2, "pose.scale: found 2, allowed is nothing of this name"),
    ("pose.translate", [1, 2], "pose.translate: found [1, 2], allowed are three numbers"),
    ("lights.lamp.power", -1, "lights.lamp: light"),
    ("noise.shot", -1, "noise.shot: found -1"),
    ("size", 5000, "size: found 5000, allowed is a whole number from 8 to 4096"),
    ("photographs.0.lights", ["lmap"], 'photographs[0].lights[0]: found "lmap", allowed are lamp (did you mean'),
    ("photographs.0.frames", [], "photographs[0].frames: found 0 items, allowed is a list of 1 to 16"),
    ("photographs.0.frames.1.exposure", 0, "photographs[0].frames[1].exposure: found 0, allowed is a number above 0"),
    ("photographs.1.frames", ["d.dng"], 'photographs[1].frames[0]: found "d.dng", allowed is the name of a file'),
    ("photographs.1.masks", "m.png", 'photographs[1].masks: found "m.png", allowed is nothing of this name (did you'),
]


@pytest.mark.parametrize(("path", "value", "said"), WRONG)
def test_what_is_wrong_in_a_session_is_named_by_its_path(folder, path, value, said):
    session = stated()
    put(session, path, value)
    with pytest.raises(InputError, match="^" + re.escape(f"{folder / 'session.json'}: {said}")):
        read(folder, session)


def test_the_example_of_the_page_is_taken(tmp_path):
    page = (Path(__file__).resolve().parents[3] / "docs" / "capture.md").read_text()
    document = json.loads(page.split("```json\n")[1].split("```")[0])
    frames = [each for shot in document["photographs"] for each in shot["frames"]]
    files = [each if isinstance(each, str) else each["file"] for each in frames]
    files += [
        document["body"],
        *document["black"],
        *(shot["mask"] for shot in document["photographs"] if "mask" in shot),
    ]
    for name in files:
        (tmp_path / name).write_bytes(b"")
    assert len(read(tmp_path, document).shots) == 2


def test_a_folder_without_a_session_is_told_where_one_is_shown(tmp_path):
    with pytest.raises(InputError, match=r"session\.json: cannot be read .*docs/capture\.md shows one"):
        session_file.read(tmp_path)
