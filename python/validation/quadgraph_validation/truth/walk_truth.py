"""Random walks through the round body of the scene `sphere`: exitance by angle and what eyes around it receive.

Nothing is shared with path tracing but the physics: no mesh, no camera, another program.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import Progress

from quadgraph.base.errors import InputError
from quadgraph_validation.base import store
from quadgraph_validation.bodies import scenes
from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.bodies.scenes import FOV, PIXELS, StudyScene
from quadgraph_validation.truth import monte_carlo
from quadgraph_validation.truth.monte_carlo import Estimate
from quadgraph_validation.truth.stored_truth import StoredTruth

ZONES = 20  # of equal cos(theta), theta from the way to the light
BATCH = 50_000  # walks
SEED = 11
EYE_BAND = 0.03  # of cos(theta), to either side of an eye
_ROUND = 4  # batches between two writes
_ARRAYS = ("batches", "zones", "eyes", "absorbed")


@dataclass
class WalkTruth:
    """Walks that entered, added up: zones (ZONES,) of where they left, from the dark pole on; eyes (views,) how many
    passed the band around each of the scene's views; absorbed: how many never left. All but the last have scattered.
    """

    key: dict[str, Any]
    scene: StudyScene
    batches: int
    zones: np.ndarray
    eyes: np.ndarray
    absorbed: int

    @property
    def walks(self) -> int:
        """How many entered."""
        return self.batches * BATCH

    @property
    def exitance(self) -> Estimate:
        """(ZONES,) W/mm^2 of scattered light."""
        return self._per_area(self.zones, 4 * np.pi * radius_of(self.scene) ** 2 / ZONES)

    @property
    def at_eyes(self) -> Estimate:
        """(views,) W/mm^2 of scattered light on a plane that faces the body, by view."""
        distances = np.array([view.distance for view in self.scene.views.values()])
        return self._per_area(self.eyes, 4 * np.pi * distances**2 * EYE_BAND)

    def _per_area(self, counts: np.ndarray, area: float | np.ndarray) -> Estimate:
        power = monte_carlo.entering_sphere(radius_of(self.scene), self.scene.eta)
        share = counts / self.walks
        error = np.sqrt(share * (1 - share) / self.walks)
        return Estimate(share * power / area, error * power / area)

    def add(self) -> None:
        """Walk one more batch, with numbers of its own."""
        radius, scene = radius_of(self.scene), self.scene
        generator = np.random.default_rng([SEED, self.batches])
        exits = monte_carlo.through_sphere(medium_of(scene), radius, scene.eta, BATCH, generator)
        position, way = exits.position[exits.scattered], exits.direction[exits.scattered]
        along = np.einsum("ij,ij->i", position, way)
        for k, view in enumerate(scene.views.values()):
            far = np.sqrt(along**2 + view.distance**2 - radius**2) - along
            cosine = (position[:, 2] + far * way[:, 2]) / view.distance
            self.eyes[k] += (np.abs(cosine - scenes.camera_axes(view)[2][2]) < EYE_BAND).sum()
        self.zones += np.histogram(position[:, 2] / radius, np.linspace(-1, 1, ZONES + 1))[0]
        self.absorbed += exits.absorbed
        self.batches += 1


def radius_of(scene: StudyScene) -> float:
    """mm."""
    return scene.height / 2


def medium_of(scene: StudyScene) -> Medium:
    """What fills the scene's body, the same everywhere."""
    return Medium(*(float(value[0]) for value in scene.coefficients(np.zeros((1, 3)))))


def make(scene: StudyScene, walks: int, folder: Path, console: Console) -> WalkTruth:
    """Bring the walks through a round scene to `walks`, and keep them in `folder`; an interruption loses one batch.

    scene: even and grey, lit along -z. Raises InputError if what is stored is stale.
    """
    folder.mkdir(parents=True, exist_ok=True)
    found, goal = stored(scene, folder), batches_of(walks)
    with Progress(console=console) as progress:
        bar = progress.add_task(f"{scene.name}, random walks", total=max(goal, found.batches), completed=found.batches)
        try:
            while found.batches < goal:
                found.add()
                progress.update(bar, completed=found.batches)
                if found.batches % _ROUND == 0:
                    _save(folder, found)
        finally:
            _save(folder, found)
    return found


def batches_of(walks: int) -> int:
    """How many batches so many walks are."""
    return -(-walks // BATCH)


def counts(scene: StudyScene, first: int, count: int) -> dict[str, Any]:
    """So many batches from a first one on, without a key, ready for JSON."""
    part = _none(scene, {}, first)
    for _ in range(count):
        part.add()
    arrays = {"zones": part.zones.tolist(), "eyes": part.eyes.tolist()}
    return {"first": first, "batches": part.batches, "absorbed": int(part.absorbed)} | arrays


def extend(scene: StudyScene, folder: Path, parts: Sequence[Mapping[str, Any]]) -> None:
    """Add what `counts` found of the batches that follow the stored ones to these.

    Raises InputError if what is stored is stale, or others have walked on since.
    """
    folder.mkdir(parents=True, exist_ok=True)
    found = stored(scene, folder)
    for part in parts:
        if part["first"] != found.batches:
            why = f"{found.batches} batches found, {part['first']} expected: others have walked on meanwhile"
            raise InputError(f"{_path(scene, folder)}: {why}; the same command goes on from there")
        found.zones += np.array(part["zones"])
        found.eyes += np.array(part["eyes"])
        found.absorbed += part["absorbed"]
        found.batches = part["batches"]
    _save(folder, found)


def stored(scene: StudyScene, folder: Path) -> WalkTruth:
    """The walks that there are. Raises InputError if they were made for anything else."""
    medium, path = medium_of(scene), _path(scene, folder)
    key = {
        "scene": scene.name,
        "radius_mm": radius_of(scene),
        "medium": [medium.sigma_s_prime, medium.sigma_a],
        "eta": scene.eta,
        "light": scene.light,
        "eyes": {name: [view.text, EYE_BAND] for name, view in scene.views.items()},
        "walks": {"batch": BATCH, "seed": SEED, "zones": ZONES},
    }
    if not path.exists():
        return _none(scene, key)
    arrays = store.load(path, key, _ARRAYS, "random walks")
    return WalkTruth(key, scene, int(arrays["batches"]), arrays["zones"], arrays["eyes"], int(arrays["absorbed"]))


def _none(scene: StudyScene, key: dict[str, Any], batches: int = 0) -> WalkTruth:
    """No walks. batches: that are left out."""
    return WalkTruth(key, scene, batches, np.zeros(ZONES, np.int64), np.zeros(len(scene.views), np.int64), 0)


def seen(image: StoredTruth) -> Estimate:
    """W/mm^2 that a path-traced picture says arrive at its eye, on the plane that faces the body."""
    if image.batches < 2:
        raise InputError(f"{image.key['scene']} {image.key['view']}: no path-traced picture to compare with")
    size = 2 * np.tan(np.radians(FOV) / 2) / PIXELS
    at = (np.arange(PIXELS) + 0.5 - PIXELS / 2) * size
    weight = size**2 / (1 + at[:, None] ** 2 + at**2) ** 2  # steradians times the cosine at the eye
    return Estimate((image.mean * weight).sum(), np.sqrt(((image.error * weight) ** 2).sum()))


def _path(scene: StudyScene, folder: Path) -> Path:
    return folder / f"{scene.name}-walks.npz"


def _save(folder: Path, found: WalkTruth) -> None:
    arrays = {name: np.asarray(getattr(found, name)) for name in _ARRAYS}
    store.save(_path(found.scene, folder), found.key, arrays)
