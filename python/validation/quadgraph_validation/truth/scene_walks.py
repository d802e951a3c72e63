"""What leaves the patches of a scene's surface, by random walks through its triangles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from quadgraph.api.lights import as_light
from quadgraph.baking.budget.surface_errors import unlit_part
from quadgraph.mesh.surface import Surface
from quadgraph_validation.bodies.scenes import StudyScene
from quadgraph_validation.bodies.unseen_cases import UnseenMedium
from quadgraph_validation.truth import kept_walks

WALKS = 1_000_000  # that meet the body, in each channel
_SEED = 29
_CELLS = 128  # along the height, of coefficients that differ from place to place
_FEW = 5  # patches: a part with fewer is not judged


@dataclass(frozen=True, eq=False)
class SceneWalks:
    """patch (m,) and face_area (m,), mm^2: of each triangle. By patch, (n, c) W/mm^2, c 1 of a grey scene: entered,
    irradiance that came in for the first time; exitance, of light that has scattered; error, its standard error.
    """

    patch: np.ndarray
    face_area: np.ndarray
    entered: np.ndarray
    exitance: np.ndarray
    error: np.ndarray

    @property
    def area(self) -> np.ndarray:
        """(n,) mm^2 of each patch."""
        return np.bincount(self.patch, self.face_area)

    @property
    def noise(self) -> dict[str, float]:
        """Standard error by part, relative RMS over its patches."""
        return {part: float(np.sqrt(noise / power)) for part, (noise, power) in self._sums().items()}

    def errors(self, exitance: np.ndarray) -> dict[str, float]:
        """Relative RMS by part of an exitance (m, 3) of the triangles, as means over patches, the noise of the walks
        taken away in quadrature; 0 where that is all there is.
        """
        channels = range(self.exitance.shape[1])
        power = np.stack([np.bincount(self.patch, self.face_area * exitance[:, c]) for c in channels], axis=1)
        off = ((power / self.area[:, None] - self.exitance) ** 2).sum(axis=1)
        found = {}
        for part, (noise, scale) in self._sums().items():
            square = (self.area * off)[self._parts[part]].sum()
            found[part] = float(np.sqrt(max(square - noise, 0.0) / scale))
        return found

    def _sums(self) -> dict[str, tuple[float, float]]:
        """By part: sums over its patches of area times squares, of the error and of the exitance without it."""
        noise = self.area * (self.error**2).sum(axis=1)
        square = self.area * (self.exitance**2).sum(axis=1)
        return {
            part: (float(noise[chosen].sum()), float((square - noise)[chosen].sum()))
            for part, chosen in self._parts.items()
        }

    @property
    def _parts(self) -> dict[str, np.ndarray]:
        unlit = unlit_part(self.area, self.entered)
        whole = {"whole": np.ones(len(self.area), bool)}
        return whole | ({"unlit": unlit} if unlit.sum() >= _FEW else {})


def made(
    scene: StudyScene, surface: Surface, folder: Path, tell: Callable[[str], None], walks: int = WALKS
) -> SceneWalks:
    """Those of a scene on a surface that stands for its body, so many in each channel; those that are not in `folder`
    are walked. Raises InputError as `kept_walks.make` does.
    """
    found = []
    for channel, medium in enumerate(media_of(scene, surface), 1):

        def walked(done: int, channel: int = channel) -> None:
            tell(f"{scene.name}: random walks, channel {channel}, {done:,} of {walks:,}")

        told = {"scene": scene.name, "light": scene.light}
        task = kept_walks.WalkTask(
            f"{scene.name}-walks-{channel}", told, surface, medium, as_light(scene.light), _SEED + channel - 1
        )
        found.append(kept_walks.make(task, walks, folder, walked))
    face_area = np.linalg.norm(surface.doubled_normals, axis=1) / 2
    by_channel = ([getattr(each, name) for each in found] for name in ("irradiance", "exitance", "error"))
    return SceneWalks(found[0].patch, face_area, *(np.stack(each, axis=-1) for each in by_channel))


def media_of(scene: StudyScene, surface: Surface) -> list[UnseenMedium]:
    """What fills a scene's body in each channel: one cell where it is the same everywhere, else a fine grid."""
    low, high = surface.vertices.min(axis=0), surface.vertices.max(axis=0)
    spacing = scene.height / _CELLS
    counts = np.ceil((high - low) / spacing).astype(int) + 1
    axes = [low[k] + spacing * np.arange(counts[k]) for k in (2, 1, 0)]
    z, y, x = np.meshgrid(*axes, indexing="ij")
    first = (float(low[0]), float(low[1]), float(low[2]))
    values = scene.coefficients(np.stack([x, y, z], axis=-1))
    media = []
    for channel in range(3) if scene.coloured else (slice(None),):
        scattering, absorption = (np.asarray(v[..., channel], np.float32) for v in values)
        if all((grid == grid.flat[0]).all() for grid in (scattering, absorption)):
            scattering, absorption = scattering[:1, :1, :1], absorption[:1, :1, :1]
        media.append(UnseenMedium("scene", scene.eta, scattering, absorption, first, spacing))
    return media
