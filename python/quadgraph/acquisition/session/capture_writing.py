"""A session's photographs as pictures of a capture, the capture itself, and the record of what was found."""

from __future__ import annotations

import os
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from scipy import ndimage

from quadgraph.acquisition.board.board import RULER_MM
from quadgraph.acquisition.cameras.lens import Lens, PinholeView, view_towards
from quadgraph.acquisition.cameras.placed_body import PlacedBody
from quadgraph.acquisition.capture.capture import NoiseModel
from quadgraph.acquisition.capture.radiance import Radiance
from quadgraph.acquisition.lighting.near_lamp import NearLamp
from quadgraph.acquisition.pose.pose_search import FoundPose
from quadgraph.acquisition.session import exr_writer, light_finding, resampling
from quadgraph.acquisition.session.exposures import ShotContent
from quadgraph.acquisition.session.locating import LocatedCamera
from quadgraph.acquisition.session.session_file import Session
from quadgraph.acquisition.session.shots import Shot
from quadgraph.base import image_file
from quadgraph.base.errors import InputError

_MARGIN = 1.1  # of the ball around the body, which the pictures show
RECORD = "-import.json"  # the end of the record's name, beside the capture
_NEAR = np.ones((3, 3))  # pixels around those of the body that count without a mask
_ENDS = {"file": ".exr", "variance": "-variance.exr", "mask": "-mask.png"}


def name_of(number: int) -> str:
    """What the camera and the photograph of a shot are called in the capture."""
    return f"photograph-{number + 1}"


def record_of(path: Path) -> Path:
    """Where the record of a capture is."""
    return path.with_name(path.stem + RECORD)


def outputs(session: Session, output: Path) -> list[Path]:
    """All files that an import writes."""
    names = [f"{output.stem}-{name_of(number)}" for number in range(len(session.shots))]
    pictures = light_finding.pictures_of(session, output)
    pictures += [output.with_name(name + end) for name in names for end in _ENDS.values()]
    return [output, record_of(output), *pictures]


def view_of(session: Session, shot: Shot, camera: LocatedCamera, body: PlacedBody) -> PinholeView:
    """The view of a shot that the body fits. Raises InputError where it is behind or around the camera."""
    distance = float(np.linalg.norm(camera.pose.eye - body.middle))
    if distance <= _MARGIN * body.radius:
        raise InputError(
            f"{session.path}: {shot.path}: the camera is {distance:.4g} mm from the middle of the body, whose radius "
            f"is {body.radius:.4g} mm: within it; check unit, pose and world"
        )
    if camera.pose.seen(body.middle[None])[0, 2] <= 0:
        raise InputError(f"{session.path}: {shot.path}: the body is behind the camera; check pose and world")
    return view_towards(camera.pose.eye, body.middle, _MARGIN * body.radius, session.size)


def picture_of(
    session: Session,
    shot: Shot,
    radiance: Radiance,
    kept: np.ndarray | None,
    camera: LocatedCamera,
    view: PinholeView,
    body: PlacedBody,
) -> Radiance:
    """What a view shows of a shot. Without a mask what lies further beside the body than its outline is uncertain does
    not count: the board is lit, too. Raises InputError if nothing counts.
    """
    picture = resampling.resampled(radiance, kept, camera.lens, camera.pose, view)
    if kept is None:
        middles = np.stack(np.meshgrid(np.arange(view.width) + 0.5, np.arange(view.height) + 0.5), axis=-1)
        shows = body.seen_by(view, middles.reshape(-1, 2)).reshape(view.height, view.width) >= 0
        near = ndimage.binary_dilation(shows, _NEAR)
        picture = Radiance(picture.values, picture.variances, picture.usable & near[..., None])
    if not picture.usable.any():
        raise InputError(
            f"{session.path}: {shot.path}: found no pixel around the body that is neither saturated, masked nor beside "
            "the photograph; expose for less, or check pose and mask"
        )
    return picture


def write_photograph(shot: Shot, picture: Radiance, output: Path, name: str) -> dict[str, Any]:
    """Write a picture with its variances and mask; the photograph as captures have it."""
    stem = f"{output.stem}-{name}"
    files = {kind: output.with_name(f"{stem}{end}") for kind, end in _ENDS.items()}
    exr_writer.write(files["file"], np.maximum(picture.values, 0))
    exr_writer.write(files["variance"], picture.variances)
    image_file.write(files["mask"], np.where(picture.usable, 255, 0).astype(np.uint8))
    entry = {"camera": name, "lights": list(shot.lights), "gain": shot.gain}
    return entry | {kind: path.name for kind, path in files.items()}


def document(
    session: Session, output: Path, views: dict[str, PinholeView], entries: list[dict[str, Any]]
) -> dict[str, Any]:
    """The capture."""
    place = session.placement
    lights = {}
    for name, light in session.lights.items():
        lights[name] = light | ({"file": _beside(output, Path(light["file"]))} if "file" in light else {})
    document: dict[str, Any] = {"quadgraph_capture": 1, "body": _beside(output, session.body), "eta": session.eta}
    if session.unit:
        document["unit"] = session.unit
    if place.degrees or place.translation.any():
        pose = {"axis": list(place.axis), "degrees": place.degrees, "translate": place.translation.tolist()}
        document["deformation"] = [{"type": "transform", "centre": [0, 0, 0], **pose}]
    cameras = {name: view.members() for name, view in views.items()}
    return document | {
        "polarised": session.polarised,
        "cameras": cameras,
        "lights": lights,
        "photographs": entries,
    }


def _beside(output: Path, path: Path) -> str:
    return os.path.relpath(path.absolute(), output.parent.absolute())


def record(
    session: Session,
    noise: NoiseModel,
    found: dict[str, ShotContent],
    cameras: dict[str, LocatedCamera],
    views: dict[str, PinholeView],
    lamps: dict[str, NearLamp],
    place: FoundPose | None,
) -> dict[str, Any]:
    """What was found, for `capture check` and whoever reads it; lengths mm, places pixels of the photograph."""
    photographs = []
    for (name, view), shot in zip(views.items(), session.shots, strict=True):
        each, camera = found[shot.path], cameras[shot.path]
        seen = camera.board
        entry: dict[str, Any] = {
            "photograph": name,
            "files": [frame.file.name for frame in shot.frames],
            "exposures": each.exposures,
            "exposure_ratios": each.ratios,
            "moved": each.moved,
            "samples": resampling.samples_of(camera.lens, view),
            "size": list(each.size),
            "eye": camera.pose.eye.tolist(),
        }
        if seen is not None:
            entry |= {"reprojection": seen.rms, "left_out": seen.left_out}
            entry["corners"] = np.concatenate([seen.corners.places, seen.off], axis=1).round(4).tolist()
        photographs.append(entry)
    lenses = {camera.lens: None for camera in cameras.values()}
    board = session.board
    return {
        "quadgraph_import": 1,
        "noise": {"read_out": noise.read_out, "shot": noise.shot, "stated": session.noise is not None},
        "lenses": [_lens(lens) for lens in lenses],
        "board": None
        if board is None
        else {"size": (board.size * np.array(board.printed) / RULER_MM).tolist(), "printed": list(board.printed)},
        "lamps": {name: _lamp(session, name, lamp, found, cameras) for name, lamp in lamps.items()},
        "photographs": photographs,
        **({} if place is None else {"pose": asdict(place.told)}),
    }


def _lamp(
    session: Session,
    name: str,
    lamp: NearLamp,
    found: dict[str, ShotContent],
    cameras: dict[str, LocatedCamera],
) -> dict[str, Any]:
    """A lamp with standard deviations, and the photographs of the board that told it."""
    stated = session.lamps[name]
    boards = []
    for shot in stated.shots:
        seen = cameras[shot.path].board
        entry = {"files": [frame.file.name for frame in shot.frames], "moved": found[shot.path].moved}
        boards.append(entry | {"reprojection": seen.rms if seen else None})
    numbers = ("position", "position_deviation", "power", "power_deviation", "ambient")
    return {
        **{each: np.asarray(getattr(lamp, each)).tolist() for each in numbers},
        **{each: getattr(lamp, each) for each in ("share", "falloff", "off", "samples", "unlike")},
        **({} if lamp.aim is None else {"aim": lamp.aim.tolist()}),
        "reflectance": stated.reflectance,
        "reflectance_deviation": stated.deviation,
        "boards": boards,
    }


def _lens(lens: Lens) -> dict[str, Any]:
    names = ("width", "height", "fx", "fy", "cx", "cy", "radial", "tangential")
    return {name: getattr(lens, name) for name in names}
