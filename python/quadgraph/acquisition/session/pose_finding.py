"""The pose of a session's body, found by the masks of its photographs."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from quadgraph.acquisition.cameras.rigid_placement import Placement
from quadgraph.acquisition.pose import pose_search
from quadgraph.acquisition.pose.outline import OutlinedBody, Silhouette
from quadgraph.acquisition.pose.pose_fit import BodyPose
from quadgraph.acquisition.pose.pose_search import FoundPose
from quadgraph.acquisition.session.session_file import Session
from quadgraph.base.errors import InputError


def find(
    session: Session,
    surface: tuple[np.ndarray, np.ndarray],
    silhouettes: Sequence[Silhouette],
    advance: Callable[[float], None],
) -> FoundPose:
    """Where the body lies. surface: vertices and triangles of the mesh. Raises InputError where that is not told."""
    body = OutlinedBody(*surface)
    try:
        if session.pose_near:
            place = session.placement
            return pose_search.refined(body, silhouettes, BodyPose(place.rotation, place.translation))
        return pose_search.searched(body, silhouettes, advance)
    except pose_search.PoseError as error:
        raise InputError(f"{session.path}: pose.fit: {error}") from None


def placement_of(pose: BodyPose) -> Placement:
    """The pose as a session states it."""
    turn = Rotation.from_matrix(pose.rotation).as_rotvec()
    degrees = float(np.degrees(np.linalg.norm(turn)))
    x, y, z = (float(each) for each in turn / np.linalg.norm(turn)) if degrees else (0.0, 0.0, 1.0)
    return Placement(1.0, (x, y, z), degrees, pose.translation)


def lines(place: Placement, found: FoundPose) -> list[str]:
    """Pose as a session states it, how certain it is, and masks that were left out."""
    axis = ", ".join(f"{each:.4f}" for each in place.axis)
    moved = ", ".join(f"{each:.2f}" for each in place.translation)
    stated = f'"axis": [{axis}], "degrees": {place.degrees:.2f}, "translate": [{moved}]'
    left = (f"{path}: its mask shares {share:.0%} with it: left out" for path, share in found.told.others.items())
    return [f"pose of the body: {stated}; {found.told.line()}", *left]
