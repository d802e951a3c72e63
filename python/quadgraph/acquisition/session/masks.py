"""What the masks of a session keep of its photographs, made once each."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from quadgraph import core
from quadgraph.acquisition.capture.radiance import Radiance
from quadgraph.acquisition.pose.outline import Silhouette, silhouette
from quadgraph.acquisition.session import background_masks
from quadgraph.acquisition.session.exposures import Exposures
from quadgraph.acquisition.session.locating import LocatedCamera
from quadgraph.acquisition.session.session_file import Session
from quadgraph.acquisition.session.shots import Shot
from quadgraph.base.errors import InputError


class Masks:
    """Of all shots, eight pixels a byte once they were made."""

    def __init__(self, session: Session, exposures: Exposures) -> None:
        """None is made yet."""
        self._session, self._exposures = session, exposures
        self._packed: dict[str, tuple[np.ndarray, tuple[int, ...]]] = {}

    def silhouettes(self, cameras: Mapping[str, LocatedCamera], advance: Callable[[float], None]) -> list[Silhouette]:
        """Of all shots that have a mask. Raises InputError, also for one that keeps nothing."""
        found = []
        for number, shot in enumerate(self._session.shots):
            advance(number / len(self._session.shots))
            if not (shot.mask or shot.background):
                continue
            kept, camera = self.of(shot, self._exposures.merged(shot)), cameras[shot.path]
            made = None if kept is None else silhouette(shot.path, kept, camera.lens, camera.pose)
            if made is None:
                raise InputError(
                    f"{self._session.path}: {shot.path}.mask: keeps nothing; let the body be white and all else black"
                )
            found.append(made)
        return found

    def of(self, shot: Shot, radiance: Radiance) -> np.ndarray | None:
        """(h, w) what is kept of a shot's photograph, None without a mask. Raises InputError."""
        if shot.path in self._packed:
            packed, shape = self._packed[shot.path]
            return np.unpackbits(packed, count=shape[0] * shape[1]).reshape(shape).astype(bool)
        if shot.background:
            empty = self._exposures.merged(shot.emptied())
            kept = background_masks.kept_of(self._session, shot, radiance, empty)
        elif shot.mask:
            kept = _read(self._session, shot, radiance)
        else:
            return None
        self._packed[shot.path] = (np.packbits(kept), kept.shape)
        return kept


def _read(session: Session, shot: Shot, radiance: Radiance) -> np.ndarray:
    assert shot.mask is not None
    kept = np.asarray(core.read_image(shot.mask)).min(axis=2) > 0.5
    if kept.shape != radiance.values.shape[:2]:
        size, allowed = (" x ".join(map(str, each[1::-1])) for each in (kept.shape, radiance.values.shape))
        raise InputError(f"{session.path}: {shot.path}.mask: {shot.mask.name} has {size} pixels, allowed are {allowed}")
    return kept
