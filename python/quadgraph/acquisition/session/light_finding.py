"""Lights of a capture that a session does not state as they are.

They are lamps that its photographs of the board alone tell, and projectors that were calibrated.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph import core
from quadgraph.acquisition.lighting import board_whites, near_lamp, projected_picture, projector_file
from quadgraph.acquisition.lighting.near_lamp import NearLamp
from quadgraph.acquisition.session import exr_writer
from quadgraph.acquisition.session.exposures import Exposures
from quadgraph.acquisition.session.light_statements import ProjectorStatement
from quadgraph.acquisition.session.locating import LocatedCamera
from quadgraph.acquisition.session.session_file import Session
from quadgraph.base.errors import InputError

_DIGITS = 6  # significant ones of what is written


def find(session: Session, exposures: Exposures, cameras: Mapping[str, LocatedCamera]) -> dict[str, NearLamp]:
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
        lamps[name] = near_lamp.fit(where, whites, stated.reflectance, stated.deviation, stated.side is not None)
    return lamps


def lights(session: Session, lamps: Mapping[str, NearLamp], output: Path) -> dict[str, dict[str, Any]]:
    """All lights of a session as captures have them; what projectors show is written beside `output`.

    Raises InputError.
    """
    found = {name: _found(lamp, session.lamps[name].side) for name, lamp in lamps.items()}
    pictures = pictures_of(session, output)
    for (name, projector), picture in zip(session.projectors.items(), pictures, strict=True):
        found[name] = _projected(session, projector, picture)
    return {**session.lights, **found}


def _found(lamp: NearLamp, side: float | None) -> dict[str, Any]:
    """The light that a lamp is: a point, or a square of a side that looks along its axis."""
    power = _rounded(lamp.power)
    if lamp.aim is None or side is None:
        return {"type": "point", "position": _rounded(lamp.position), "power": power}
    axis = np.append(lamp.aim, 0.0) - lamp.position
    u = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
    v = np.cross(axis, u)  # u x v looks along the axis
    edges = {name: _rounded(side * edge / np.linalg.norm(edge)) for name, edge in (("u", u), ("v", v))}
    return {"type": "rectangle", "centre": _rounded(lamp.position), **edges, "power": power}


def _rounded(values: np.ndarray) -> list[float]:
    return [float(f"{each:.{_DIGITS}g}") for each in values]


def pictures_of(session: Session, output: Path) -> list[Path]:
    """Where the pictures of projectors lie beside a capture."""
    return [output.with_name(f"{output.stem}-projector-{number + 1}.exr") for number in range(len(session.projectors))]


def _projected(session: Session, stated: ProjectorStatement, picture: Path) -> dict[str, Any]:
    lens, pose = projector_file.read(stated.calibrated)
    where = f"{session.path}: {stated.path}.shown: {stated.shown.name}"
    try:
        shown = np.asarray(core.read_image(stated.shown), np.float32)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
    if shown.shape[1::-1] != (lens.width, lens.height):
        size = " x ".join(map(str, shown.shape[1::-1]))
        raise InputError(f"{where} has {size} pixels, allowed are the projector's, {lens.width} x {lens.height}")
    values, members = projected_picture.light(lens, pose, shown, stated.power)
    exr_writer.write(picture, values)
    return members | {"file": str(picture)}
