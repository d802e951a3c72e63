"""The lamps of a session that its photographs of the board alone tell, as lights of a capture."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from quadgraph.acquisition.lighting import board_whites, point_lamp
from quadgraph.acquisition.lighting.point_lamp import PointLamp
from quadgraph.acquisition.session.exposures import Exposures
from quadgraph.acquisition.session.locating import LocatedCamera
from quadgraph.acquisition.session.session_file import Session

_DIGITS = 6  # significant ones of what is written


def find(session: Session, exposures: Exposures, cameras: Mapping[str, LocatedCamera]) -> dict[str, PointLamp]:
    """The lamps by their names. Raises InputError naming the lamp, or the photograph of the board."""
    lamps = {}
    for name, stated in session.lamps.items():
        assert session.board is not None
        whites = []
        for shot in stated.shots:
            where = f"{session.path}: {shot.path}: {shot.frames[0].file.name}"
            camera = cameras[shot.path]
            radiance = exposures.merged(shot)
            whites.append(board_whites.sample(where, session.board, radiance, camera.lens, camera.pose))
        where = f"{session.path}: {stated.path}"
        lamps[name] = point_lamp.fit(where, whites, stated.reflectance, stated.deviation)
    return lamps


def lights(session: Session, lamps: Mapping[str, PointLamp]) -> dict[str, dict[str, Any]]:
    """All lights of a session as captures have them."""
    found = {
        name: {
            "type": "point",
            "position": [float(f"{each:.{_DIGITS}g}") for each in lamp.position],
            "power": [float(f"{each:.{_DIGITS}g}") for each in lamp.power],
        }
        for name, lamp in lamps.items()
    }
    return {**session.lights, **found}
