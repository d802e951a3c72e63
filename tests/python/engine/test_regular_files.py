"""What stands where a file is to be read and is none: each reader says which, and waits for nobody."""

import os
from pathlib import Path

import pytest

import tiny
from quadgraph import core
from quadgraph.base.errors import InputError

KINDS = {"gone": "No such file", "folder": "no regular file", "pipe": "no regular file", "loop": "symbolic links"}


def put(path: Path, kind: str) -> None:
    """Make a path that is no regular file; nothing for `gone`."""
    if kind == "folder":
        path.mkdir()
    elif kind == "pipe":
        os.mkfifo(path)
    elif kind == "loop":
        path.symlink_to(path.name)


def body(path: Path) -> None:
    """Read it as a body."""
    core.Engine(path, device="cpu")


def scene(path: Path) -> None:
    """Read it as a scene."""
    core.SceneFile(path)


def picture(path: Path) -> None:
    """Read it as what a projector shows."""
    core.Engine(tiny.PATH, device="cpu").set_lights([f"projector:0,0,30:0,0,-1:20:{path}:1"])


def volume(path: Path) -> None:
    """Read it as the coefficients of a material."""
    core.Engine(tiny.PATH, device="cpu").set_material(str(path))


def shapes(path: Path) -> None:
    """Read it as the frames of an animation."""
    core.Engine(tiny.PATH, device="cpu").set_deformation([{"type": "displaced", "shapes": str(path), "frame": 0}])


READERS = {
    "b.qgraph": body,
    "s.json": scene,
    "i.png": picture,
    "i.exr": picture,
    "i.hdr": picture,
    "v.npz": volume,
    "f.qshapes": shapes,
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", READERS)
def test_what_is_no_regular_file_is_named(tmp_path, name, kind):
    put(tmp_path / name, kind)
    with pytest.raises(InputError, match=KINDS[kind]) as refusal:
        READERS[name](tmp_path / name)
    assert name in str(refusal.value)
