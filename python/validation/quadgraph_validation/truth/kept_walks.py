"""Random walks through a body, kept on disk under a key of everything that enters them, and gone on with."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from quadgraph.api.lights import Light
from quadgraph.mesh.patches import patches_of
from quadgraph.mesh.surface import Surface
from quadgraph_validation.base import extra_module, store
from quadgraph_validation.bodies.smooth_sky import SmoothSky
from quadgraph_validation.bodies.unseen_cases import UnseenMedium

if TYPE_CHECKING:
    from quadgraph_validation.truth.mesh_walk import WalkBatch

BATCH = 50_000  # walks that meet the body
_VERSION = 1  # of the walks: another one makes truths anew
_ROUND = 10  # batches between two writes
_ARRAYS = ("batches", "entered", "scattered", "squares", "again", "rest")


@dataclass(frozen=True, eq=False)
class WalkTask:
    """Walks of one channel. stem: of their file; told: what enters them besides the rest; seed: of all chance;
    inter_reflection: whether light that left may enter again.
    """

    stem: str
    told: dict[str, Any]
    surface: Surface
    medium: UnseenMedium
    light: Light | SmoothSky
    seed: int
    inter_reflection: bool = True


@dataclass
class KeptWalks:
    """Batches added up. By patch (n,), W: entered, scattered and its squares, again, as WalkBatch has them; rest (4,):
    absorbed, gone, unscattered, and walks lost. patch (m,): of each triangle; area (n,): mm^2.
    """

    key: dict[str, Any]
    patch: np.ndarray
    area: np.ndarray
    batches: int
    entered: np.ndarray
    scattered: np.ndarray
    squares: np.ndarray
    again: np.ndarray
    rest: np.ndarray

    @property
    def exitance(self) -> np.ndarray:
        """(n,) W/mm^2 of light that has scattered."""
        return self.scattered / self.batches / self.area

    @property
    def error(self) -> np.ndarray:
        """(n,) standard error of the exitance, from the scatter of the batches; wants two of them."""
        mean = self.scattered / self.batches
        spread = np.maximum(self.squares / self.batches - mean**2, 0)
        return np.sqrt(spread / (self.batches - 1)) / self.area

    @property
    def irradiance(self) -> np.ndarray:
        """(n,) q, W/mm^2, of light that enters for the first time."""
        return self.entered / self.batches / self.area

    @property
    def balance(self) -> float:
        """What is missing of the light that entered, as a share of it: noise alone."""
        return float(1 - self.rest[:2].sum() / self.entered.sum())

    def add(self, batch: WalkBatch) -> None:
        """Take in one more batch."""
        self.batches += 1
        self.entered += batch.entered
        self.scattered += batch.scattered
        self.squares += batch.scattered**2
        self.again += batch.again
        self.rest += (batch.absorbed, batch.gone, batch.unscattered.sum(), batch.lost)


def make(task: WalkTask, walks: int, folder: Path, tell: Callable[[int], None]) -> KeptWalks:
    """Bring a task's walks to `walks` and keep them in `folder`; an interruption loses one batch.

    tell: is given the number of walks that are done. Raises InputError if what is stored cannot be read, and without
    Numba where some are to be walked.
    """
    folder.mkdir(parents=True, exist_ok=True)
    found, goal = stored(task, folder), -(-walks // BATCH)
    tell(found.batches * BATCH)
    if found.batches >= goal:
        return found
    extra_module.load("numba", "walks")
    from quadgraph_validation.truth.mesh_walk import MeshWalker

    walker = MeshWalker(task.surface, task.medium, task.light, found.patch, task.inter_reflection)
    try:
        while found.batches < goal:
            found.add(walker.batch(BATCH, found.batches, task.seed))
            tell(found.batches * BATCH)
            if found.batches % _ROUND == 0:
                _save(folder, task, found)
    finally:
        _save(folder, task, found)
    return found


def stored(task: WalkTask, folder: Path) -> KeptWalks:
    """The walks that there are. Raises InputError if they cannot be read."""
    patch = patches_of(task.surface)
    area = np.bincount(patch, np.linalg.norm(task.surface.doubled_normals, axis=1) / 2)
    key = _key(task, patch)
    path = _path(folder, task, key)
    if not path.exists():
        entered, scattered, squares, again = np.zeros((4, len(area)))
        return KeptWalks(key, patch, area, 0, entered, scattered, squares, again, np.zeros(4))
    arrays = store.load(path, key, _ARRAYS, "random walks")
    return KeptWalks(key, patch, area, int(arrays.pop("batches")), **arrays)


def _key(task: WalkTask, patch: np.ndarray) -> dict[str, Any]:
    medium = task.medium
    key = task.told | {
        "surface": _sha(task.surface.vertices, task.surface.triangles, patch),
        "medium": _sha(medium.sigma_s_prime, medium.sigma_a),
        "grid": [*medium.first, medium.spacing],
        "eta": medium.eta,
        "walks": {"batch": BATCH, "seed": task.seed, "version": _VERSION},
    }
    return key if task.inter_reflection else key | {"inter_reflection": False}


def _sha(*arrays: np.ndarray) -> str:
    found = hashlib.sha256()
    for array in arrays:
        found.update(str(array.shape).encode() + np.ascontiguousarray(array).tobytes())
    return found.hexdigest()


def _path(folder: Path, task: WalkTask, key: dict[str, Any]) -> Path:
    return folder / f"{task.stem}-{store.digest(key)[:12]}.npz"


def _save(folder: Path, task: WalkTask, found: KeptWalks) -> None:
    arrays = {name: np.asarray(getattr(found, name)) for name in _ARRAYS}
    store.save(_path(folder, task, found.key), found.key, arrays)
