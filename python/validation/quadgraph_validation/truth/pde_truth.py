"""The exitance of a scene by converged linear elements: the truth that tells a method's error from its model's.

The finest mesh of the scene's baked chain is cut in eight uniformly, and again, its shape kept; each mesh is solved by
the CPU reference in double precision, with irradiance from rays. The finest answer is the truth; how the answers
approach each other says how far it still is from the limit. Light that leaves one part of the body and enters another
is left out, as it must be in what is held against it.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from quadgraph.baking.budget import finer_levels, surface_errors
from quadgraph.base.errors import InputError
from quadgraph.base.relative_error import relative_rms
from quadgraph.core import load_core
from quadgraph_validation.base import store
from quadgraph_validation.bodies import level_chains, scene_bakes
from quadgraph_validation.bodies.scenes import StudyScene
from quadgraph_validation.truth.pde_solve import REFINEMENTS, SKY_RAYS, Ladder
from quadgraph_validation.truth.schemes import Scheme

MODELS = ("sp3", "diffusion")
SOURCES = ("buried", "diffuse")
VERTICES = 7000  # about, on the finest surface of a chain
VERSION = 1  # of how the truth is made
MESHES = REFINEMENTS + 1
# Answers that do not come closer by at least this factor do not tell a limit; none is trusted to be of higher order.
SLOWEST, FASTEST = 0.9, 0.25


@dataclass(frozen=True)
class PdeTruth:
    """What is known of a scene's exitance, per face of the chain's finest surface cut in four.

    chain: the baked file; area, q, corner, weight: as of pde_solve.Ladder; solutions: (m, n, 3) W/mm^2 from the first m
    of its meshes.
    """

    key: dict[str, Any]
    chain: Path
    area: np.ndarray
    q: np.ndarray
    corner: np.ndarray
    weight: np.ndarray
    solutions: np.ndarray

    @property
    def complete(self) -> bool:
        """Whether all meshes have been solved."""
        return len(self.solutions) == MESHES

    @property
    def exitance(self) -> np.ndarray:
        """(n, 3) W/mm^2 from the finest mesh."""
        return self.solutions[-1]

    @cached_property
    def parts(self) -> dict[str, np.ndarray]:
        """Areas (n,) by part of the surface, "whole" and, where there is enough of it, "unlit"."""
        return surface_errors.weights(self.area, self.q)

    @property
    def steps(self) -> list[dict[str, float]]:
        """By part, how far each mesh's answer is from the next one's, relative to the truth."""
        return [self._relative(difference) for difference in np.diff(self.solutions, axis=0)]

    @property
    def noise(self) -> dict[str, float]:
        """By part, how far the truth is estimated to be from the limit (Richardson), relative."""
        before, last = self.steps[-2:]
        noise = {}
        for part, step in last.items():
            ratio = float(np.clip(step / max(before[part], np.finfo(float).tiny), FASTEST, SLOWEST))
            noise[part] = step * ratio / (1 - ratio)
        return noise

    def error(self, level: int, exitance: np.ndarray) -> dict[str, float]:
        """By part, the relative RMS error of an exitance (n_f, 3) W/mm^2 on the outside faces of a level of the chain.

        The linear function whose means over the faces come closest is carried to the finest surface. Raises InputError
        for a level that is not there or values that are not of its faces.
        """
        if not 0 <= level < len(self._levels):
            raise InputError(f"{self.chain}: level {level} found, 0 to {len(self._levels) - 1} allowed")
        faces = np.asarray(self._levels[level].faces)
        if np.shape(exitance) != faces.shape:
            raise InputError(f"{self.chain}: exitance of shape {np.shape(exitance)} found, {faces.shape} allowed")
        corners = finer_levels.at_corners(faces, np.asarray(exitance, np.float64))
        carried = level_chains.to_vertices(self._levels, corners, level)
        return self._relative(np.einsum("ij,ijc->ic", self.weight, carried[self.corner]) - self.exitance)

    @cached_property
    def _levels(self) -> list:
        return load_core().load(self.chain).levels

    def _relative(self, difference: np.ndarray) -> dict[str, float]:
        return {part: relative_rms(area, difference, self.exitance) for part, area in self.parts.items()}


def chain(scene: StudyScene, meshes: Path, folder: Path) -> Path:
    """The scene's baked chain of levels in `folder`, baked if it is not there. Raises as pipeline.bake does."""
    return _baked(scene, meshes, folder).made()


def stored(scene: StudyScene, model: str, meshes: Path, folder: Path, source: str = "buried") -> PdeTruth:
    """The truth that `make` made. Raises InputError if it is absent, unfinished or stale, naming what differs."""
    path, chain_path = path_of(folder, scene, model, source), _baked(scene, meshes, folder).path
    command = f"quadgraph reference {scene.name} --kind pde --model {model} --source {source}"
    for needed in (path, chain_path):
        if not needed.exists():
            raise InputError(f"{needed}: not there; '{command}' makes it")
    found = _load(path, _key(scene, model, source, chain_path), chain_path)
    if not found.complete:
        raise InputError(f"{path}: {len(found.solutions)} of {MESHES} meshes solved; '{command}' goes on")
    return found


def make(
    scene: StudyScene, model: str, meshes: Path, folder: Path, console: Console, source: str = "buried"
) -> PdeTruth:
    """Make the truth of a scene for one model and source, or go on where it was interrupted, and keep it in `folder`.

    Saved after every mesh; KeyboardInterrupt passes through. Raises InputError if what is stored is stale, as `bake`
    does, and SolverError.
    """
    columns = SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn()
    with Progress(*columns, console=console) as progress:
        title = f"{scene.name}, {model}, {source} source"
        bar = progress.add_task(f"{title}: chain of levels", total=None)
        chain_path = chain(scene, meshes, folder)
        path, key = path_of(folder, scene, model, source), _key(scene, model, source, chain_path)
        found = _load(path, key, chain_path) if path.exists() else None
        if found is None or not found.complete:
            progress.update(bar, description=f"{title}: rays of light")
            ladder = Ladder(scene, chain_path)
            if found is None:
                nothing = np.empty((0, *ladder.q.shape))
                found = PdeTruth(key, chain_path, ladder.area, ladder.q, ladder.corner, ladder.weight, nothing)
            for number in range(len(found.solutions), MESHES):
                progress.update(bar, description=f"{title}: mesh {number + 1} of {MESHES}")
                exitance = ladder.exitance(number, Scheme("fem", source, model))
                found = replace(found, solutions=np.concatenate([found.solutions, exitance[None]]))
                store.save(path, key, {name: getattr(found, name) for name in _ARRAYS})
        progress.update(bar, description=f"{title}: done")
    return found


_ARRAYS = ("area", "q", "corner", "weight", "solutions")


def _load(path: Path, key: dict[str, Any], chain_path: Path) -> PdeTruth:
    return PdeTruth(key, chain_path, **store.load(path, key, _ARRAYS, "a PDE truth"))


def path_of(folder: Path, scene: StudyScene, model: str, source: str) -> Path:
    """The file of a truth. Raises InputError for models and sources that are none."""
    for name, found, allowed in (("model", model, MODELS), ("source", source, SOURCES)):
        if found not in allowed:
            raise InputError(f"{name} '{found}': allowed are {', '.join(allowed)}")
    return folder / f"{scene.name}-{model}-{source}.npz"


def _baked(scene: StudyScene, meshes: Path, folder: Path) -> scene_bakes.SceneBake:
    return scene_bakes.of(scene, scene_bakes.Choice(VERTICES), meshes, folder)


def _key(scene: StudyScene, model: str, source: str, chain_path: Path) -> dict[str, Any]:
    """Everything that the truth depends on, ready for JSON."""
    level = load_core().load(chain_path).levels[0]
    coefficients = hashlib.sha256()
    for values in scene.in_channels(np.asarray(level.nodes, np.float64)):
        coefficients.update(np.ascontiguousarray(values, np.float32).tobytes())
    return {
        "version": VERSION,
        "scene": scene.name,
        "chain": hashlib.sha256(chain_path.read_bytes()).hexdigest(),
        "eta": scene.eta,
        "coefficients": coefficients.hexdigest(),
        "light": scene.light,
        "model": model,
        "source": source,
        "method": "fem",
        "refinements": REFINEMENTS,
        "sky_rays": SKY_RAYS,
    }
