"""From a session to a capture: exposures merged, cameras found, pictures without distortion, and what was done."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph.acquisition.cameras.placed_body import PlacedBody, surface
from quadgraph.acquisition.capture import capture
from quadgraph.acquisition.session import capture_writing, light_finding, locating, pose_finding
from quadgraph.acquisition.session.exposures import Exposures
from quadgraph.acquisition.session.masks import Masks
from quadgraph.acquisition.session.session_file import Session
from quadgraph.base import atomic_file


def import_session(
    session: Session, output: Path, tell: Callable[[str], None], advance: Callable[[float], None]
) -> dict[str, Any]:
    """Write a capture, its pictures beside it, and the record of what was found, which is returned.

    Photographs are read twice, and a third time where their masks tell the pose, so that no more than one is in memory.
    Raises InputError; then no capture is written,
    though pictures may be.
    """
    mesh = surface(session.path, session.body, session.unit, None)
    exposures = Exposures(session)
    noise = exposures.noise
    tell(f"noise of a value v, where 1 is full scale: variance {noise.read_out:.3g}^2 + {noise.shot:.3g} v")
    found = {}
    for number, shot in enumerate(session.all_shots()):
        found[shot.path] = exposures.content(shot)
        advance(0.6 * (number + 1) / len(session.all_shots()))
    seen = {path: each.corners for path, each in found.items()}
    cameras = locating.locate(session, {path: each.size for path, each in found.items()}, seen)
    lamps = light_finding.find(session, exposures, cameras)
    session = replace(session, lights=light_finding.lights(session, lamps, output))
    masks = Masks(session, exposures)
    place = None
    if session.pose_fit:
        silhouettes = masks.silhouettes(cameras, lambda share: advance(0.6 + 0.1 * share))
        place = pose_finding.find(session, mesh, silhouettes, lambda share: advance(0.7 + 0.1 * share))
        session = replace(session, placement=pose_finding.placement_of(place.pose))
        for line in pose_finding.lines(session.placement, place):
            tell(line)
    body = body_of(session, mesh)
    views, entries = {}, []
    for number, shot in enumerate(session.shots):
        name = capture_writing.name_of(number)
        camera = cameras[shot.path]
        views[name] = capture_writing.view_of(session, shot, camera, body)
        radiance = exposures.merged(shot)
        kept = masks.of(shot, radiance)
        picture = capture_writing.picture_of(session, shot, radiance, kept, camera, views[name], body)
        entries.append(capture_writing.write_photograph(shot, picture, output, name))
        advance(0.8 + 0.2 * (number + 1) / len(session.shots))
    atomic_file.write_json(output, capture_writing.document(session, output, views, entries))
    capture.read(output)
    record = capture_writing.record(session, noise, found, cameras, views, lamps, place)
    atomic_file.write_json(capture_writing.record_of(output), record)
    return record


def body_of(session: Session, mesh: tuple[np.ndarray, np.ndarray]) -> PlacedBody:
    """The body, by vertices and triangles of its mesh, where it lies on the board. Raises InputError."""
    vertices, triangles = mesh
    return PlacedBody(vertices @ session.placement.rotation.T + session.placement.translation, triangles)
