"""A session as somebody would make it at home: exposures of a body on a board as 16-bit PNG, and its session.json."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import board_photographs
from quadgraph.acquisition.board.board import Board
from quadgraph.acquisition.cameras.lens import Lens, Pose
from shapes import icosphere, moved, write_obj

MIDDLE, RADIUS = np.array([87.5, 112.5, 25.0]), 25.0
NOISE = (0.0012, 1.5e-4)  # read-out and shot noise of a value, 1 full scale
KNOWN_NOISE = {"noise": {"read_out": NOISE[0], "shot": NOISE[1]}}  # of a session.json that has single exposures
EXPOSURES = (0.5, 2.0)
BLACK = 0.01
LAMP = {"type": "point", "position": [260.0, 40.0, 260.0], "power": 1000}


def cameras() -> list[Pose]:
    """Twelve places around the body, hand-held."""
    high, low = ((6, 55, 0.0), (6, 35, 20.0))
    return [
        pose for count, up, start in (high, low) for pose in board_photographs.around(MIDDLE, 330.0, count, up, start)
    ]


def write(
    folder: Path,
    poses: Sequence[Pose],
    lens: Lens = board_photographs.LENS,
    shows: Callable[[Pose], board_photographs.Body] | None = None,
    seed: int = 1,
    exposures: Sequence[float] = EXPOSURES,
    noise: tuple[float, float] = NOISE,
    **more: Any,
) -> Path:
    """Photograph a ball (or what `shows` makes) on the usual board, and write session.json; return its path."""
    generator = np.random.default_rng(seed)
    board = Board()
    ball = board_photographs.ball(MIDDLE, RADIUS)
    shots = []
    for number, pose in enumerate(poses):
        radiance = board_photographs.photograph(board, lens, pose, shows(pose) if shows else ball)
        frames = []
        for step, exposure in enumerate(exposures):
            name = f"{number}-{step}.png"
            picture = board_photographs.exposed(radiance, exposure, noise, generator, BLACK)
            board_photographs.write_png(folder / name, picture)
            frames.append({"file": name, "exposure": exposure})
        shots.append({"frames": frames, "lights": ["lamp"]})
    for number in range(3):
        dark = np.zeros((lens.height, lens.width, 3))
        board_photographs.write_png(
            folder / f"black-{number}.png", board_photographs.exposed(dark, 1.0, noise, generator, BLACK)
        )
    write_obj(moved(icosphere(4, RADIUS), 0, 0, RADIUS), folder / "ball.obj")
    document = {
        "quadgraph_session": 1,
        "board": {},
        "body": "ball.obj",
        "unit": "mm",
        "eta": 1.4,
        "polarised": True,
        "pose": {"translate": [MIDDLE[0], MIDDLE[1], 0]},
        "lights": {"lamp": LAMP},
        "black": [f"black-{number}.png" for number in range(3)],
        "size": 128,
        "photographs": shots,
    }
    (folder / "session.json").write_text(json.dumps(document | more))
    return folder / "session.json"
