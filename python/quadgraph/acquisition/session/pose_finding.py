"""The pose of a session's body, found by the masks of its photographs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from quadgraph.acquisition.cameras.rigid_placement import Placement
from quadgraph.acquisition.pose import pose_search
from quadgraph.acquisition.pose.outline import OutlinedBody, Silhouette, silhouette
from quadgraph.acquisition.pose.pose_fit import BodyPose
from quadgraph.acquisition.pose.pose_search import FoundPose
from quadgraph.acquisition.session.locating import LocatedCamera
from quadgraph.acquisition.session.session_file import Session
from quadgraph.acquisition.session.shots import Shot
from quadgraph.base.errors import InputError


@dataclass(frozen=True, eq=False)
class PlacedByMasks:
    """placement: of the body on the board; found: how it was told; lowest: its lowest place over the board, mm."""

    placement: Placement
    found: FoundPose
    lowest: float

    def line(self) -> str:
        """Pose and how certain it is."""
        found, place = self.found, self.placement
        axis = ", ".join(f"{each:.4f}" for each in place.axis)
        moved = ", ".join(f"{each:.2f}" for each in place.translation)
        said = f'"axis": [{axis}], "degrees": {place.degrees:.2f}, "translate": [{moved}]'
        if found.degrees is not None:
            said += f"; turned to {found.degrees:.2g} degrees, placed to {found.mm:.2g} mm"
        said += f"; outlines of {found.photographs} photographs {found.off:.2f} pixels off (RMS)"
        if found.symmetric:
            said += "; it looks the same turned otherwise, and which way was not told"
        for path, share in found.others.items():
            said += f"; left out: {path}, whose mask shares {share:.0%} with it"
        return f"{said}; its lowest place is {self.lowest:+.2f} mm over the board"


def find(
    session: Session,
    surface: tuple[np.ndarray, np.ndarray],
    masks: Mapping[str, np.ndarray],
    cameras: Mapping[str, LocatedCamera],
    advance: Callable[[float], None],
) -> PlacedByMasks:
    """Where the body lies. surface: vertices and triangles of the mesh; masks: (h, w) by the paths of photographs.

    Raises InputError where masks do not tell it.
    """
    silhouettes = [_silhouette(session, shot, masks, cameras) for shot in session.shots if shot.path in masks]
    body = OutlinedBody(*surface)
    try:
        if session.pose_near:
            place = session.placement
            found = pose_search.refined(body, silhouettes, BodyPose(place.rotation, place.translation))
        else:
            found = pose_search.searched(body, silhouettes, advance)
    except pose_search.PoseError as error:
        raise InputError(f"{session.path}: pose.fit: {error}") from None
    turn = Rotation.from_matrix(found.pose.rotation).as_rotvec()
    degrees = float(np.degrees(np.linalg.norm(turn)))
    x, y, z = (float(each) for each in turn / np.linalg.norm(turn)) if degrees else (0.0, 0.0, 1.0)
    placement = Placement(1.0, (x, y, z), degrees, found.pose.translation)
    lowest = float(found.pose.places(surface[0])[:, 2].min())
    return PlacedByMasks(placement, found, lowest)


def _silhouette(
    session: Session, shot: Shot, masks: Mapping[str, np.ndarray], cameras: Mapping[str, LocatedCamera]
) -> Silhouette:
    camera = cameras[shot.path]
    made = silhouette(shot.path, masks[shot.path], camera.lens, camera.pose)
    if made is None:
        raise InputError(f"{session.path}: {shot.path}.mask: keeps nothing; let the body be white and all else black")
    return made


def placed(session: Session, found: PlacedByMasks | None) -> Session:
    """The session with its body where it was found, if it was looked for."""
    return session if found is None else replace(session, placement=found.placement)
